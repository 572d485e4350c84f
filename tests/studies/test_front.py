"""Two objectives of a fastest move: the front, the setting that is proposed and proved, and any other one of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from app.studies.document import FastestMove, Sampler, StudyDocument
from app.studies.fastest_move import ranges
from app.studies.fastest_move.effects import effects_told
from app.studies.fastest_move.front import front_of, knee, proposed
from app.studies.kinds import KINDS
from app.studies.parts import Interval
from app.studies.record import DeviationEvidence, Evidence, Figures, StudyRecord, Trial
from app.studies.report import html_of
from app.studies.search import Dimension, Searcher, Space
from tests.studies.harness import START, studied

MOVE: dict[str, Any] = {"kind": "fastest_move", "distance": 12_800, "repeats": 1}
QUIET = {**MOVE, "quiet": True}
HEAVY = {"inertia_kgm2": 5e-4, "friction_nm": 0.1}
NAMES = ("VMAX", "AMAX", "DMAX", "V1")
BEFORE = Figures(time_s=1.0, deviation_fullsteps=0.5)


def trial(number: int, time_s: float | None, deviation: float, state: Any = "feasible") -> Trial:
    figures = Figures(time_s=time_s, deviation_fullsteps=deviation)
    return Trial(number=number, setting={}, registers=[], state=state, figures=figures)


def numbers(trials: list[Trial]) -> list[int]:
    return [each.number for each in trials]


def test_no_setting_of_a_front_is_beaten_and_all_others_are() -> None:
    held = [trial(0, 0.5, 0.5), trial(1, 0.4, 0.6), trial(2, 0.4, 0.7), trial(3, 0.9, 0.1), trial(4, 0.95, 0.2)]
    others = [trial(5, None, 9.0, "infeasible"), trial(6, 0.1, 0.1, "infeasible"), trial(7, 0.5, 0.5)]
    assert numbers(front_of(held + others)) == [0, 1, 3, 7]


def test_the_knee_is_nearest_to_the_best_of_both_each_over_its_range() -> None:
    # shares of the ranges: (0, 1), (0.25, 0.25), (0.5, 0.1), (1, 0)
    front = [trial(0, 0.2, 3.0), trial(1, 0.3, 1.5), trial(2, 0.4, 1.2), trial(3, 0.6, 1.0)]
    found = knee(front)
    assert found is not None
    assert found.number == 1
    assert knee([]) is None
    assert knee(front[3:]) is front[3]


@pytest.mark.parametrize(
    ("front", "most", "expected"),
    [
        # the slow ones move no range of those that are faster than before
        ([trial(0, 0.5, 0.9), trial(1, 0.6, 0.6), trial(2, 0.9, 0.5), trial(3, 9.0, 0.01)], None, 1),
        # nothing is faster: what deviates less
        ([trial(0, 1.0, 0.4), trial(1, 1.5, 0.3)], None, 0),
        ([trial(0, 0.995, 0.5)], None, None),
        # a bound: the fastest that keeps it
        ([trial(0, 0.5, 0.9), trial(1, 0.6, 0.6), trial(2, 0.9, 0.5)], 0.6, 1),
        ([trial(0, 0.5, 0.9), trial(1, 1.2, 0.4)], 0.6, None),
        # what was before is beyond the bound: then a slower one keeps it too
        ([trial(0, 0.5, 0.9), trial(1, 1.2, 0.4)], 0.45, 1),
    ],
    ids=["knee of the faster", "calmer", "nothing", "bound", "bound and slower", "bound that was not kept"],
)
def test_which_setting_of_a_front_is_proposed(front: list[Trial], most: float | None, expected: int | None) -> None:
    found = proposed(front, BEFORE, 0.01, most)
    assert (None if found is None else found.number) == expected


def evidence(share: float, significant: bool, deviation: float, calmer: bool, p: float = 0.004) -> Evidence:
    def around(mean: float) -> Interval:
        return Interval(low=mean - 0.02, high=mean + 0.02)

    other = DeviationEvidence(
        baseline_fullsteps=1.0,
        winner_fullsteps=1 + deviation,
        difference_fullsteps=deviation,
        interval_fullsteps=around(deviation),
        share=deviation,
        p=p,
        significant=calmer,
    )
    return Evidence(
        pairs=10,
        baseline_s=1.0,
        winner_s=1 + share,
        difference_s=share,
        interval_s=around(share),
        share=share,
        p=0.004,
        test="",
        significant=significant,
        runs=20,
        loss_rate_max=0.14,
        deviation=other,
    )


@pytest.mark.parametrize(
    ("of", "told"),
    [
        (
            evidence(-0.3, True, -0.2, True),
            "30 % faster (1 s to 0.7 s; 95 %: 280 to 320 ms less) and 20 % less deviation",
        ),
        (
            evidence(-0.3, True, 0.2, False),
            "ms less), for 20 % more deviation (1 to 1.2 full steps; 95 %: 0.18 to 0.22 more)",
        ),
        (evidence(-0.3, True, 0.01, False, 0.5), "ms less), perhaps 1 % more deviation"),
        (
            evidence(0.1, False, -0.2, True),
            "0.18 to 0.22 less), for 10 % more time (1 s to 1.1 s; 95 %: 80 to 120 ms more)",
        ),
    ],
    ids=["both", "faster for more deviation", "faster alone", "calmer for more time"],
)
def test_a_verdict_tells_both_and_what_is_given_up(of: Evidence, told: str) -> None:
    assert told in effects_told(of, 0.01)


@pytest.mark.parametrize("sampler", ["cmaes", "nsga2"])
async def test_a_sampler_comes_to_the_edge_and_not_beyond_it(sampler: Sampler) -> None:
    """The more the better, up to 0.5: beyond it steps are lost, and a figure there is better than any that held."""
    space = Space((Dimension("speed", 0.1, 1.0), Dimension("ramp", 0.1, 1.0)), 1, sampler)
    searcher = Searcher(None, space, 3, aside=False)
    await searcher.open()
    beyond = []
    for _ in range(100):
        asked = await searcher.ask()
        assert all(0.1 <= value <= 1.0 for value in asked.values.values())
        fastest = max(asked.values.values())
        beyond.append(fastest - 0.5)
        await searcher.tell(asked, [sum(1 / value for value in asked.values.values())], max(beyond[-1], -1e-9))
    searcher.close()
    assert sum(abs(by) < 0.1 for by in beyond[-20:]) >= 12, beyond[-20:]  # one in four is, where nothing was learned


@pytest.mark.parametrize("sampler", ["cmaes", "nsga2"])
async def test_a_faster_ramp_is_found_by_each_sampler(tmp_path: Path, sampler: str) -> None:
    async with studied(tmp_path, load=HEAVY) as s:
        run = s.begin(s.document({**MOVE, "sampler": sampler}, budget={"trials": 10}))
        record = await s.finish(run)
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert len(record.trials) > 8, "it was asked beyond its first settings"
        assert record.front == []
        assert record.evidence is not None
        assert record.evidence.deviation is None
        assert "deviation" not in record.verdict


def shown(record: StudyRecord, number: int) -> tuple[float, float]:
    found = record.trial(number)
    assert found is not None
    assert found.figures.time_s is not None
    assert found.figures.deviation_fullsteps is not None
    return found.figures.time_s, found.figures.deviation_fullsteps


async def test_of_two_objectives_the_knee_is_proved_by_both_and_another_setting_of_the_front_after_it(
    tmp_path: Path,
) -> None:
    async with studied(tmp_path, load=HEAVY) as s:
        before = await s.settings(*NAMES)
        document = s.document(QUIET, budget={"trials": 12})
        plan = await KINDS["fastest_move"].plan(s.device, 0, document)
        assert any("nearest to the least time and the least deviation" in step for step in plan.steps)
        record = await s.finish(s.begin(document))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert await s.settings(*NAMES) == before
        front = {number: shown(record, number) for number in record.front}
        held = [each for each in record.trials if each.state == "feasible"]
        assert 2 <= len(front) < len(held)
        for here in front.values():
            assert not any(
                time_s <= here[0] and off <= here[1] and (time_s, off) != here for time_s, off in front.values()
            )
        for each in held:
            if each.number not in front:
                time_s, off = shown(record, each.number)
                assert any(there[0] <= time_s and there[1] <= off for there in front.values())
        best = record.trial(record.best)
        assert best is not None
        assert best.number in front
        assert shown(record, best.number)[0] > min(time_s for time_s, _ in front.values()), "not the fastest"
        evidence = record.evidence
        assert evidence is not None
        deviation = evidence.deviation
        assert deviation is not None
        assert deviation.interval_fullsteps.low <= deviation.difference_fullsteps <= deviation.interval_fullsteps.high
        told = [pair.winner_deviation_fullsteps for pair in record.pairs]
        assert len(told) == 10
        assert deviation.winner_fullsteps == pytest.approx(sum(off for off in told if off is not None) / 10)
        assert evidence.p == pytest.approx(2 * 2 / 2**10), "two figures: each p counts twice"
        assert "% faster" in record.verdict
        assert "deviation" in record.verdict
        assert {move.which for move in record.moves} == {"before", "best", "present"}
        report = html_of(record)
        assert "Time and deviation" in report
        assert report.count("<svg") == 5

        other = next(number for number in front if number != best.number and front[number][0] < 0.45)
        setting = record.trial(other)
        assert setting is not None
        again = await s.finish(s.begin(s.document({**QUIET, "candidate": setting.setting})))
        assert (again.state, again.left) == ("done", []), again.message
        assert [(each.number, each.setting, each.registers) for each in again.trials] == [
            (1, setting.setting, setting.registers)
        ]
        assert again.best == 1
        assert len(again.pairs) == 10
        assert again.improved
        assert await s.settings(*NAMES) == before


async def test_the_fastest_that_keeps_to_a_deviation_is_proposed(tmp_path: Path) -> None:
    async with studied(tmp_path, load=HEAVY) as s:
        document = s.document({**QUIET, "deviation_max_fullsteps": 0.95}, budget={"trials": 10})
        plan = await KINDS["fastest_move"].plan(s.device, 0, document)
        assert any("never deviates by more than 0.95 full steps" in step for step in plan.steps)
        record = await s.finish(s.begin(document))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert record.best is not None
        assert all((pair.winner_deviation_fullsteps or 9) <= 0.95 for pair in record.pairs)
        assert "no move of 10 deviated by more than 0.95 full steps" in record.verdict
        best = shown(record, record.best)
        faster = [number for number in record.front if shown(record, number)[0] < best[0]]
        assert faster
        assert all(shown(record, number)[1] > 0.95 for number in faster)


async def test_a_setting_that_deviates_by_more_than_asked_in_the_proof_is_followed_by_another(tmp_path: Path) -> None:
    async with studied(tmp_path, load=HEAVY) as s:
        record = await s.finish(s.begin(s.document({**QUIET, "deviation_max_fullsteps": 0.7}, budget={"trials": 6})))
        assert record.state == "done", record.message
        refuted = [each for each in record.trials if each.why == "it deviated by more than asked in the proof"]
        assert refuted
        assert all(each.state == "feasible" for each in refuted), "no step was lost"
        assert all((each.figures.deviation_fullsteps or 0) > 0.7 for each in refuted)
        assert record.best not in [each.number for each in refuted]
        assert record.improved or "deviates by 0.7 full steps at most" in record.verdict


@pytest.mark.parametrize(
    ("candidate", "said"),
    [
        ({"speed": 60_000.0}, "a setting of this axis acceleration, speed"),
        ({"speed": 1e9, "acceleration": 3e5}, "the candidate's speed is"),
    ],
)
async def test_a_candidate_that_the_axis_cannot_have_is_told_before_it_moves(
    tmp_path: Path, candidate: dict[str, float], said: str
) -> None:
    async with studied(tmp_path) as s:
        plan = await ranges.plan(s.device, 0, s.document({**MOVE, "candidate": candidate}))
        assert len(plan.missing) == 1
        assert said in plan.missing[0]


async def test_the_plan_of_a_candidate_tells_its_speed_and_searches_nothing(tmp_path: Path) -> None:
    async with studied(tmp_path) as s:
        document = s.document({**MOVE, "candidate": {"speed": 60_000.0, "acceleration": 300_000.0}})
        plan = await ranges.plan(s.device, 0, document)
        assert plan.missing == []
        assert plan.velocity_max_pps == pytest.approx(66_000)
        assert plan.acceleration_max_pps2 == pytest.approx(330_000)
        assert any("the setting 60000 pps, 300000 pps^2: once there and back" in step for step in plan.steps)
        assert plan.moves_max < (await ranges.plan(s.device, 0, s.document(MOVE))).moves_max


async def test_a_candidate_with_a_shape_is_the_setting_itself_and_not_shares_of_it(tmp_path: Path) -> None:
    async with studied(tmp_path, replace(START, v1=20_000, a1=400_000, d1=400_000)) as s:
        six = {**MOVE, "shape": "six points"}
        found = (await ranges.look(s.device, 0, FastestMove.model_validate(six))).required()
        candidate = {name: 1.2 * value for name, value in found.space.now().items()}
        run = s.begin(s.document({**six, "candidate": candidate}))
        record = await s.finish(run, 600)
        assert record.state == "done", record.message
        (tried,) = record.trials
        assert tried.setting == pytest.approx(candidate, rel=1e-3)
        del candidate["speed"]
        plan = await ranges.plan(s.device, 0, s.document({**six, "candidate": candidate}))
        assert "a setting of this axis " in plan.missing[0]


@pytest.mark.parametrize(
    ("study", "said"),
    [
        ({"quiet": True, "sampler": "cmaes"}, "CMA-ES knows one objective"),
        ({"deviation_max_fullsteps": 1.0}, "set quiet too"),
        ({"candidate": {"speed": 1.0}, "twin": {}}, "leave the twin out"),
        ({"candidate": {"speed": -1.0}}, "greater than 0"),
    ],
)
def test_a_wish_that_cannot_be_is_refused(study: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        StudyDocument.model_validate({"device": "slide", "study": {**MOVE, **study}})
