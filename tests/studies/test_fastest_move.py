"""The fastest move on an emulated axis with a motor: found, proved, put back, and told where there is none."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from app.emulators.tmc5xxx.options import AxisChange, Tmc5xxxPatch
from app.studies.document import FastestMove
from app.studies.fastest_move import ranges
from app.studies.fastest_move.trials import figures_of
from app.studies.kinds import KINDS
from app.studies.moves import MoveFigures
from app.studies.ramp_settings import least_time_s
from app.studies.report import html_of
from app.studies.run import MAY_TURN
from tests.studies.harness import Studied, studied

MOVE: dict[str, Any] = {"kind": "fastest_move", "distance": 12_800, "repeats": 1}
HEAVY = {"inertia_kgm2": 5e-4, "friction_nm": 0.1}
NAMES = ("VMAX", "AMAX", "DMAX", "V1")


def plant(s: Studied) -> Any:
    """The ground truth, which no study sees."""
    return s.b.wire.state().axes[0].truth


async def test_a_faster_ramp_is_found_and_proved_and_the_axis_is_as_before(tmp_path: Path) -> None:
    async with studied(tmp_path, load=HEAVY) as s:
        before = await s.settings(*NAMES)
        run = s.begin(s.document(MOVE, budget={"trials": 8}))
        record = await s.finish(run)
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert await s.settings(*NAMES) == before
        assert (await s.b.state()).position == 0
        best, evidence = record.trial(record.best), record.evidence
        assert best is not None
        assert evidence is not None
        assert best.figures.time_s is not None
        assert evidence.winner_s < evidence.baseline_s
        assert evidence.interval_s.high < 0
        assert evidence.pairs == 10
        assert evidence.loss_rate_max == pytest.approx(1 - 0.05 ** (1 / evidence.runs))
        assert any(trial.state == "infeasible" for trial in record.trials), "its edge was found"
        assert record.next.startswith("more trials: after 8 trials about "), record.next
        assert "a loss rate asked for" in record.next
        assert plant(s).lost_fullsteps != 0, "steps were lost on the way there"
        moves = {move.which: move for move in record.moves}
        assert moves.keys() == {"before", "best", "present"}
        assert moves["best"].time_s[-1] < moves["before"].time_s[-1]
        assert moves["best"].fullsteps[-1] == pytest.approx(MOVE["distance"] / 256, abs=1)
        assert all(len(move.time_s) == len(move.fullsteps) <= 120 for move in record.moves)
        assert record == s.store.get(record.id)
        report = html_of(record)
        assert record.verdict.split(" (")[0] in report
        assert report.count("<svg") == 3
        assert "<script" not in report


async def test_several_distances_are_moved_by_in_each_run_and_their_times_added_up(tmp_path: Path) -> None:
    async with studied(tmp_path, load=HEAVY) as s:
        document = s.document({**MOVE, "distance": 3_200, "distances": [12_800, 6_400]}, budget={"trials": 5})
        plan, alone = [
            await KINDS["fastest_move"].plan(s.device, 0, each)
            for each in (document, s.document(MOVE, budget={"trials": 5}))
        ]
        assert (plan.position_from, plan.position_to) == (alone.position_from, alone.position_to) == (0, 12_800 + 1024)
        assert plan.moves_max == 3 * alone.moves_max
        assert any("3200, 12800, 6400 microsteps" in step for step in plan.steps)
        record = await s.finish(s.begin(document))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        best, before = record.trial(record.best), record.baseline_figures
        assert best is not None
        assert before is not None
        for figures in (best.figures, before):
            short, far, middle = figures.by_distance_s
            assert short < middle < far
            assert figures.time_s == pytest.approx(short + middle + far)
        assert "all 3 distances together" in record.verdict
        ends = {move.which: move.fullsteps[-1] for move in record.moves}
        assert ends["best"] == pytest.approx(12_800 / 256, abs=1), "the longest one is drawn"
        assert best.expected_s == pytest.approx(
            sum(
                least_time_s(each, best.setting["speed"], best.setting["acceleration"]) for each in (3200, 12_800, 6400)
            )
        )
        assert "by 12800 microsteps [s]" in html_of(record)
        assert (await s.b.state()).position == 0


def test_a_run_that_lost_steps_has_no_time_and_one_distance_has_no_parts() -> None:
    held, gone = MoveFigures(0.5, 1.0, 0.0), MoveFigures(None, 2.0, 4.0)
    one = figures_of([(held, held), (held, MoveFigures(0.7, 3.0, 0.0))])
    assert one.time_s == pytest.approx(0.55)
    assert (one.by_distance_s, one.deviation_fullsteps) == ([], 3.0)
    assert one.spread_s == pytest.approx(0.1)
    lost = figures_of([(held, held, held, held), (held, held, gone)])
    assert (lost.time_s, lost.spread_s, lost.by_distance_s) == (None, None, [])
    assert lost.lost_fullsteps == 4.0


@pytest.mark.parametrize("distance", [0, -6_400])
def test_a_further_distance_goes_to_the_same_side(distance: int) -> None:
    with pytest.raises(ValueError, match=rf"distances has {distance}: all of them go to the same side"):
        FastestMove(distance=12_800, distances=[distance])


async def test_an_asked_loss_rate_is_shown_by_moves_of_the_new_setting_alone(tmp_path: Path) -> None:
    async with studied(tmp_path, load=HEAVY) as s:
        study = {**MOVE, "loss_rate_max": 0.05}
        for time_s, warned in ((60.0, True), (3600.0, False)):
            document = s.document(study, budget={"trials": 8, "time_s": time_s})
            plan = await KINDS["fastest_move"].plan(s.device, 0, document)
            assert any("49 more with the best setting alone" in step for step in plan.steps)
            assert any("may not be shown within 60 s" in said for said in plan.warnings) == warned
        record = await s.finish(s.begin(document), 3600)
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        evidence = record.evidence
        assert evidence is not None
        # 59 of the setting itself, and ten with its margin.
        assert (evidence.pairs, evidence.runs) == (10, 69)
        assert evidence.loss_rate_max == pytest.approx(1 - 0.05 ** (1 / 69))
        assert "no step lost in 69 runs: fewer than 4.2 % lose some" in record.verdict
        assert record.next.endswith("a warmer motor, a lower supply and another load need one")


async def test_a_loss_rate_that_the_budget_leaves_open_is_not_claimed(tmp_path: Path) -> None:
    async with studied(tmp_path, load=HEAVY) as s:
        run = s.begin(s.document({**MOVE, "loss_rate_max": 0.001}, budget={"trials": 8, "time_s": 120.0}))
        record = await s.finish(run, 300)
        assert (record.state, record.improved, record.left) == ("done", None, []), record.message
        assert "the budget ended before fewer than 0.1 % were shown" in record.verdict
        assert record.evidence is not None
        assert record.evidence.runs > 20, "moves of the new setting alone had begun"


async def test_a_step_that_is_lost_in_the_moves_alone_refutes_a_setting(tmp_path: Path) -> None:
    async with studied(tmp_path, load=HEAVY) as s:
        run = s.begin(s.document({**MOVE, "loss_rate_max": 0.01}, budget={"trials": 8, "time_s": 3600.0}))
        while not run.record.message.startswith("the new setting alone, move 5 "):
            await s.clock.advance(0.05)
        number = run.record.best
        s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, load_torque_nm=0.6)]))
        await s.clock.advance(1.0)
        s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, load_torque_nm=0.0)]))
        record = await s.finish(run, 3600)
        refuted = record.trial(number)
        assert refuted is not None
        assert (refuted.state, refuted.why) == ("infeasible", "it lost steps, or did not settle, in the proof")
        assert record.best != number
        assert record.evidence is None or record.evidence.runs >= 299 or not record.improved


async def test_a_setting_that_cannot_be_beaten_stays(tmp_path: Path) -> None:
    async with studied(tmp_path) as s:
        close = {"velocity_max_pps": 50_001.0 * 1.1, "acceleration_max_pps2": 200_002.0 * 1.1}
        record = await s.finish(s.begin(s.document({**MOVE, **close}, budget={"trials": 4})))
        assert (record.state, record.improved) == ("done", False), record.message
        assert "stays as it is" in record.verdict
        assert record.evidence is None or not record.evidence.significant
        assert record.next
        assert "trials" not in record.next, "none of so small a space is worth one yet"


@pytest.mark.parametrize("at_s", [0.3, 4.0, 9.7, 16.1])
async def test_a_stop_at_any_moment_leaves_the_axis_as_before(tmp_path: Path, at_s: float) -> None:
    async with studied(tmp_path) as s:
        before = await s.settings(*NAMES)
        run = s.begin(s.document(MOVE, budget={"trials": 8}))
        await s.clock.advance(at_s)
        assert run.running
        await s.device.stop_axes([0])
        await s.finish(run, 20)
        assert (run.record.state, run.record.left) == ("aborted", []), run.record.message
        assert await s.settings(*NAMES) == before
        assert not (await s.b.state()).moving


async def test_a_dead_link_is_told_with_what_may_be_left(tmp_path: Path) -> None:
    async with studied(tmp_path) as s:
        run = s.begin(s.document(MOVE, budget={"trials": 8}))
        await s.clock.advance(5)
        s.b.fault(unplugged=True)
        record = await s.finish(run, 60)
        assert record.state == "failed"
        assert any("VMAX" in line and str(record.baseline[0].value) in line for line in record.left)


@pytest.mark.parametrize("taken_over", [False, True])
async def test_what_a_study_had_begun_is_stopped_when_the_device_is_back_unless_somebody_has_sent_it_elsewhere(
    tmp_path: Path, taken_over: bool
) -> None:
    async with studied(tmp_path) as s:
        run = s.begin(s.document({**MOVE, "distance": 2_000_000}))
        await s.clock.advance(3)
        assert (await s.b.state()).moving
        s.b.fault(unplugged=True)
        record = await s.finish(run, 60)
        assert (record.state, MAY_TURN in record.left) == ("failed", True), record.left
        s.b.fault(unplugged=False)
        if taken_over:
            await s.device.motion.move(0, 3_000_000)
        await s.clock.advance(10)
        state = await s.b.state()
        assert state.moving == taken_over
        assert (MAY_TURN in record.left) == taken_over
        assert ("was stopped" in record.message) != taken_over
        assert abs(state.position) < 2_900_000


async def test_it_goes_on_where_it_was_cut_off(tmp_path: Path) -> None:
    async with studied(tmp_path) as s:
        run = s.begin(s.document(MOVE, budget={"trials": 6}))
        while sum(trial.state != "pruned" for trial in run.record.trials) < 3:
            await s.clock.advance(0.2)
        await s.passing(run.abort("cut off"))
        tried = [trial.number for trial in run.record.trials]
        again = s.begin(run.record.document, run.record)
        record = await s.finish(again)
        assert record.state == "done", record.message
        numbers = [trial.number for trial in record.trials]
        assert numbers[: len(tried)] == tried
        assert len(set(numbers)) == len(numbers) > len(tried)


async def test_an_axis_that_loses_steps_as_it_is_set_is_called_by_its_name(tmp_path: Path) -> None:
    async with studied(tmp_path, load={"torque_nm": 0.0}) as s:
        s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, blocked=True)]))
        record = await s.finish(s.begin(s.document(MOVE)), 60)
        assert record.state == "failed"
        assert "part by" in record.message
        assert record.improved is None


async def test_the_plan_says_what_will_move_and_what_is_missing(tmp_path: Path) -> None:
    async with studied(tmp_path) as s:
        document = s.document(MOVE)
        plan = await ranges.plan(s.device, 0, document)
        assert plan.missing == []
        assert (plan.position_from, plan.position_to) == (0, 12_800 + 4 * 256)
        assert plan.acceleration_max_pps2 == pytest.approx(2e6, rel=1e-3)
        assert plan.velocity_max_pps == pytest.approx(500_000, rel=1e-4)
        await s.device.motion.rotate(0, 1000)
        await s.clock.advance(0.1)
        assert any("moves" in line for line in (await ranges.plan(s.device, 0, document)).missing)


@pytest.mark.parametrize(("speed", "seconds"), [(100.0, 11.0), (1e9, 2 * (1000 / 100) ** 0.5)])
def test_the_least_time_is_that_of_a_trapezoid_or_a_triangle(speed: float, seconds: float) -> None:
    assert least_time_s(-1000, speed, 100) == pytest.approx(seconds)
