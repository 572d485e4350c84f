"""StallGuard's threshold on an emulated axis with a hard stop: found, proved on other runs, and none where there is
none."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

from app.devices.tmc5xxx.start_up import Start
from app.procedures.procedure import Failed
from app.studies.document import Budget
from app.studies.pieces import FILE
from app.studies.plan import StudyPlan
from app.studies.ramp_settings import held_of
from app.studies.record import StudyRecord
from app.studies.report import html_of
from app.studies.stallguard import plan as stallguard
from app.studies.stallguard.choice import Choice, Measured, Run, alone, choices, may_do, roc
from app.studies.stallguard.found import Rate, StallFound, StallSpeed
from app.studies.stallguard.runs import StallRuns
from app.studies.stallguard.scale import Scale
from app.studies.stallguard.setting import StallSetting
from app.studies.stallguard.study import StallGuardStudy
from app.studies.store import StudyStore
from tests.bench.studies.stallguard import Referee
from tests.devices.tmc5xxx.harness import bench
from tests.plants.stalls import APART_PUSH_FULLSTEPS, APART_RPS, apart
from tests.studies.harness import START, Kept, Studied, studied

STAGE = {"left_at_fullsteps": -5000, "right_at_fullsteps": 5000, "left_end_fullsteps": -300.0}
FAST = replace(START, stops=False, vmax=102_400, amax=400_000)
SHORT: dict[str, Any] = {
    "kind": "stallguard",
    "within_fullsteps": 400.0,
    "stop_confirmed": True,
    "speeds_rps": [2.0],
    "free_runs": 20,
    "stops": 10,
}
APART: dict[str, Any] = {**SHORT, "speeds_rps": APART_RPS, "push_fullsteps": APART_PUSH_FULLSTEPS}
PLENTY = {"time_s": 10_000.0}
NAMES = ("VMAX", "AMAX", "DMAX", "COOLCONF", "SW_MODE", "TCOOLTHRS", "THIGH")


@asynccontextmanager
async def axis(tmp_path: Path, start: Start = FAST, **told: float) -> AsyncIterator[Studied]:
    """An axis with a hard stop 300 full steps to the left, and the load value of a motor as it is told."""
    async with studied(tmp_path, start, stage=STAGE, motor={"load_value": told}) as s:
        yield s


async def test_a_threshold_is_found_and_proved_and_the_axis_is_as_before(tmp_path: Path) -> None:
    async with axis(tmp_path) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document(SHORT)))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert await s.settings(*NAMES) == before
        assert (await s.b.state()).position == 0
        assert s.b.wire.state().axes[0].truth.rotor_fullsteps == pytest.approx(0, abs=0.2)
        found, best = record.stallguard, record.trial(record.best)
        assert found is not None
        assert best is not None
        assert found.level is not None
        assert found.stop_at == pytest.approx(-300 * 256, abs=256)
        assert found.slope == pytest.approx(8, abs=0.1)
        (speed,) = found.speeds
        assert max(speed.stops) < found.level < min(speed.free)
        assert speed.alone is not None
        assert (speed.alone.threshold, speed.alone.may_do) == (best.setting["threshold"], True)
        assert (speed.alone.false, speed.alone.free_runs) == (0, len(speed.free))
        assert (speed.alone.missed, speed.alone.stops) == (0, len(speed.stops))
        assert speed.false is not None
        assert speed.missed is not None
        assert (speed.false.wrong, speed.missed.wrong, speed.missed.runs) == (0, 0, 10)
        assert speed.missed.most == pytest.approx(1 - 0.05 ** (1 / 10))
        assert best.setting["armed from"] == pytest.approx(0.9 * 102_400, rel=0.01)
        assert "tells a stall at 2 turns/s: " in record.verdict
        assert "TCOOLTHRS was 0" in record.verdict
        report = html_of(record)
        assert report.count("<svg") == 2
        assert "<script" not in report


async def test_a_motor_whose_noise_is_above_its_load_has_no_threshold_and_is_told_so(tmp_path: Path) -> None:
    async with axis(tmp_path, noise=200.0, noise_with_speed=1000.0) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document(SHORT)))
        assert (record.state, record.improved, record.best) == ("done", False, None), record.message
        assert "no threshold does it here: 2 turns/s" in record.verdict
        assert record.stallguard is not None
        (speed,) = record.stallguard.speeds
        assert speed.alone is not None
        assert not speed.alone.may_do
        assert speed.alone.false + speed.alone.missed > 0
        assert await s.settings(*NAMES) == before


async def test_what_was_set_before_and_does_it_stays(tmp_path: Path) -> None:
    async with axis(tmp_path) as s:
        await s.device.registers.write("COOLCONF", 0, None, {"sgt": -8})
        await s.device.registers.write("TCOOLTHRS", 0, 174)
        record = await s.finish(s.begin(s.document(SHORT)))
        assert (record.state, record.improved) == ("done", False), record.message
        assert "stays as it is" in record.verdict


@pytest.mark.parametrize("at_s", [2.0, 20.0, 70.0])
async def test_a_stop_at_any_moment_leaves_the_axis_as_before(tmp_path: Path, at_s: float) -> None:
    async with axis(tmp_path) as s:
        before = await s.settings(*NAMES)
        run = s.begin(s.document(SHORT))
        await s.clock.advance(at_s)
        assert run.running
        await s.device.stop_axes([0])
        await s.finish(run, 20)
        assert (run.record.state, run.record.left) == ("aborted", []), run.record.message
        assert await s.settings(*NAMES) == before


def found_of(record: StudyRecord) -> StallFound:
    assert record.stallguard is not None
    return record.stallguard


async def test_it_goes_on_with_the_speeds_that_are_left(tmp_path: Path) -> None:
    """Cut off as it measures, then as it proves."""
    async with axis(tmp_path) as s:
        run = s.begin(s.document({**SHORT, "speeds_rps": [1.0, 2.0]}))
        await s.until(run, lambda record: record.stallguard is not None and bool(found_of(record).speeds[0].roc))
        await s.clock.advance(1.0)
        cut = await s.killed(run)
        first = found_of(cut).speeds[0].model_copy(deep=True)
        assert first.free
        run = s.begin(cut.document, cut)
        await s.until(run, lambda record: record.phase == "proof")
        assert isinstance(run.keeper, Kept)
        assert "free runs at 2 turns/s" in run.keeper.marks
        assert "free runs at 1 turns/s" not in run.keeper.marks
        began = run.record.runs
        await s.until(run, lambda record: found_of(record).speeds[0].missed is not None)
        proof = run.record.runs - began
        await s.clock.advance(1.0)
        cut = await s.killed(run)
        assert found_of(cut).speeds[0].free == first.free
        runs, proved = cut.runs, found_of(cut).speeds[0].model_copy(deep=True)
        run = s.begin(cut.document, cut)
        record = await s.finish(run)
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert isinstance(run.keeper, Kept)
        assert not any(mark.startswith("free runs") for mark in run.keeper.marks)
        assert found_of(record).speeds[0] == proved
        assert (await s.b.state()).position == 0
        assert (found_of(record).from_rps, found_of(record).to_rps) == (1, 2)
        # The stop is looked for anew, and the one speed that was left is proved.
        assert record.runs - runs < 1.5 * proof + 8
        assert not (s.store.folder(record.id) / FILE).exists()


async def test_the_plan_tells_what_thresholds_of_single_speeds_cost_more(tmp_path: Path) -> None:
    async with axis(tmp_path) as s:
        speeds = {"speeds_rps": [0.5, 1.0, 2.0]}
        with_own, without = await planned(s, **speeds), await planned(s, **speeds, each_speed=False)
        moves, seconds = with_own.moves_max - without.moves_max, with_own.time_s - without.time_s
        assert moves == 2 * (20 + 3 * 10)
        (told,) = [line for line in with_own.steps if "each_speed" in line]
        assert f"at most {moves} moves and {seconds:.0f} s more" in told
        assert with_own.way_fullsteps > without.way_fullsteps
        assert not any("each_speed" in line for line in [*without.steps, *(await planned(s)).steps])


@pytest.mark.parametrize("seed", [1, 2, 3])
async def test_a_speed_that_needs_another_threshold_gets_one_that_holds_there(tmp_path: Path, seed: int) -> None:
    """The referee counts on a plant of its own: both thresholds hold at their speed, and either fails at the other."""
    options = apart(seed)
    async with studied(tmp_path, FAST, **options) as s:
        before = await s.settings(*NAMES)
        words = {key[1]: word for key, word in (await held_of(s.device)).words.items() if word is not None}
        document = s.document(APART, budget=PLENTY, seed=seed)
        plan = await stallguard.plan(s.device, 0, document)
        record = await s.finish(s.begin(document))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert await s.settings(*NAMES) == before
        assert (await s.b.state()).position == 0
    assert 0.5 * plan.moves_max < record.runs < plan.moves_max
    assert 0.5 * plan.time_s < record.ran_s < 1.1 * plan.time_s
    found = found_of(record)
    assert found.from_rps == found.to_rps
    (chosen,) = [one for one in found.speeds if not one.why]
    (other,) = [one for one in found.speeds if one.why]
    assert (chosen.own, other.why) == (None, "not with a threshold that does it at the others")
    assert other.own is not None
    own, best = record.trial(other.own.trial), record.trial(record.best)
    assert own is not None
    assert best is not None
    assert (own.state, own.setting["threshold"]) == ("feasible", other.own.threshold)
    assert own.setting["armed from"] == other.own.from_pps == pytest.approx(0.9 * other.speed_pps, rel=0.01)
    for rate, runs in ((other.false, 20), (other.missed, 10)):
        assert rate is not None
        assert (rate.wrong, rate.runs) == (0, runs)
        assert rate.most == pytest.approx(1 - 0.05 ** (1 / runs))
    told = f"at {other.speed_rps:g} turns/s threshold {other.own.threshold}: 0 of 20 free runs stopped"
    assert told in record.verdict
    assert f"<td>{other.own.threshold}, its own</td>" in html_of(record)
    for trial, here, there in ((best, chosen, other), (own, other, chosen)):
        referee = Referee(options, words, seed, APART_PUSH_FULLSTEPS)
        referee.set(trial.registers)
        assert referee.holds([here.speed_pps], 60) == ""
        assert referee.holds([there.speed_pps], 60) != ""


def own_begun(record: StudyRecord) -> bool:
    """Whether a threshold of one speed alone is proved now."""
    return record.best is not None and len(record.trials) == 2


async def test_stopped_as_it_proves_a_threshold_of_one_speed_it_is_as_before_and_goes_on_with_that(
    tmp_path: Path,
) -> None:
    async with studied(tmp_path, FAST, **apart(1)) as s:
        before = await s.settings(*NAMES)
        run = s.begin(s.document(APART, budget=PLENTY))
        await s.until(run, own_begun)
        runs = run.record.runs
        await s.clock.advance(3.0)
        await s.device.stop_axes([0])
        record = await s.finish(run, 20)
        assert (record.state, record.left) == ("aborted", []), record.message
        assert await s.settings(*NAMES) == before
        assert [trial.state for trial in record.trials] == ["feasible", "failed"]
        chosen = next(one for one in found_of(record).speeds if not one.why).model_copy(deep=True)
        run = s.begin(record.document, record)
        record = await s.finish(run)
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert isinstance(run.keeper, Kept)
        assert not any(mark.startswith(("free runs", "into the stop")) for mark in run.keeper.marks)
        assert chosen in found_of(record).speeds
        assert [one.own is None for one in found_of(record).speeds].count(False) == 1
        # The stop is looked for anew; of 30 held-out runs of one speed each takes three moves at the most.
        assert record.runs - runs < 20 + 3 * 30
        assert await s.settings(*NAMES) == before


async def test_a_budget_that_ends_as_a_speed_has_its_threshold_proved_leaves_what_is_proved(tmp_path: Path) -> None:
    async with studied(tmp_path, FAST, **apart(1)) as s:
        before = await s.settings(*NAMES)
        run = s.begin(s.document(APART, budget=PLENTY))
        await s.until(run, own_begun)
        budget = Budget(time_s=run.since_s + 3.0)
        run.record.document = run.record.document.model_copy(update={"budget": budget})
        record = await s.finish(run, 30)
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert await s.settings(*NAMES) == before
        assert (await s.b.state()).position == 0
        (other,) = [one for one in found_of(record).speeds if one.why]
        assert other.own is None
        assert "the budget ended before one of its own was proved" in other.why
        assert other.why in record.verdict
        assert record.trials[1].state == "failed"


async def test_speeds_without_a_threshold_of_their_own_and_one_that_is_not_reached_are_told(tmp_path: Path) -> None:
    """A speed that no free run came up to once ended the study with a figure that no record can hold."""
    study = {**APART, "speeds_rps": [*APART_RPS, 4.0], "each_speed": False}
    async with studied(tmp_path, FAST, **apart(1)) as s:
        record = await s.finish(s.begin(s.document(study, budget=PLENTY)))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        speeds = found_of(record).speeds
        assert "does not get up to this speed" in speeds[2].why
        assert sorted(one.why for one in speeds[:2]) == ["", "not with a threshold that does it at the others"]
        assert [one.own for one in speeds] == [None, None, None]
        assert len(record.trials) == 1


async def test_a_speed_at_which_stalls_are_like_free_runs_has_no_threshold_of_its_own(tmp_path: Path) -> None:
    """So few full steps into the stop, and so noisy, that stalls are like free runs; the referee finds none either."""
    options = apart(1)
    options["motor"]["load_value"]["noise_with_speed"] = 1000.0
    async with studied(tmp_path, FAST, **options) as s:
        words = {key[1]: word for key, word in (await held_of(s.device)).words.items() if word is not None}
        record = await s.finish(s.begin(s.document({**APART, "push_fullsteps": 4.0}, budget=PLENTY)))
    assert (record.state, record.improved) == ("done", True), record.message
    slow, fast = found_of(record).speeds
    assert (slow.why, fast.own) == ("", None)
    assert fast.why.startswith("no threshold does it here: load values of 40 free runs and of ")
    assert f"at 3 turns/s: {fast.why}" in record.verdict
    best = record.trial(record.best)
    assert best is not None
    assert Referee(options, words, 1, 4.0).finds([fast.speed_pps], best.registers) == ""


async def test_what_is_tried_at_a_speed_is_tried_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A threshold that is armed from the lower speed on is always wrong at the upper one: made again until it passes,
    a proof would prove nothing."""
    tried: list[tuple[float, StallSetting]] = []

    async def held_out(
        _: StallGuardStudy, one: StallSpeed, setting: StallSetting
    ) -> tuple[Rate, Rate, Literal["", "false"]]:
        tried.append((one.speed_rps, setting))
        wrong = one.speed_rps == 2.0 and setting.armed_pps < 51_200
        false = Rate(wrong=int(wrong), runs=20, most=0.2)
        return Rate(wrong=0, runs=10, most=0.3), false, "false" if wrong else ""

    monkeypatch.setattr(StallGuardStudy, "_run_held_out", held_out)
    async with axis(tmp_path) as s:
        record = await s.finish(s.begin(s.document({**SHORT, "speeds_rps": [1.0, 2.0]})))
    assert (record.state, record.improved) == ("done", True), record.message
    slow, fast = found_of(record).speeds
    assert len(tried) == len(set(tried)) > 4
    # Both speeds have what is proved there: one is the choice, the other what a refuted span had proved, or its own.
    assert [one.own is None for one in (slow, fast)].count(True) == 1
    for one in (slow, fast):
        assert one.false is not None
        assert one.false.wrong == 0
    assert sum(trial.state == "feasible" for trial in record.trials) == 2


async def test_an_encoder_that_tells_nothing_is_not_one_that_tells_zero() -> None:
    async with bench(start=replace(FAST, counts_per_rev=0)) as b:
        runs = StallRuns(b.device, 0, b.clock, full_step=256, way=-1)
        with pytest.raises(Failed, match="the encoder tells nothing"):
            await runs.begin()


async def test_no_stop_within_what_was_said_is_told(tmp_path: Path) -> None:
    async with axis(tmp_path) as s:
        record = await s.finish(s.begin(s.document({**SHORT, "within_fullsteps": 100.0})))
        assert record.state == "failed"
        assert "nothing held the motor as far as -25600" in record.message


async def test_stallguard4_is_found_with_stealthchop(tmp_path: Path) -> None:
    start = replace(FAST, vmax=25_600, amax=100_000)
    async with bench("tmc5240", start=start, stage=STAGE, motor={"rotor_teeth": 50}) as b:
        s = Studied(b, StudyStore(tmp_path, aside=False))
        wish = {**SHORT, "speeds_rps": [0.5], "generation": 4, "run_fullsteps": 50.0}
        record = await s.finish(s.begin(s.document(wish)))
        assert (record.state, record.improved) == ("done", True), record.message or record.verdict
        assert record.stallguard is not None
        assert record.stallguard.generation == 4
        best = record.trial(record.best)
        assert best is not None
        assert {"SG4_THRS", "TCOOLTHRS", "GCONF"} <= {each.name for each in best.registers}


async def planned(s: Studied, **study: Any) -> StudyPlan:
    return await stallguard.plan(s.device, 0, s.document({**SHORT, **study}))


async def test_the_plan_says_what_it_runs_into_and_what_is_missing(tmp_path: Path) -> None:
    async with axis(tmp_path) as s:
        plan = await planned(s)
        assert plan.missing == []
        assert (plan.position_from, plan.position_to) == (-400 * 256, 0)
        assert any("into the stop" in line for line in plan.steps)
        assert any("stop_confirmed" in line for line in (await planned(s, stop_confirmed=False)).missing)
        assert any("StallGuard4" in line for line in (await planned(s, generation=4)).missing)


# --- the choice alone -----------------------------------------------------------------------------


def runs(rng: np.random.Generator, mean: float, noise: float, count: int, values: int = 40) -> list[Run]:
    return [Run(rng.uniform(mean - noise, mean + noise, values), np.full(values, 100.0)) for _ in range(count)]


SGT = Scale(2, -64, 63, 8.0)


def test_the_levels_of_a_roc_are_counted() -> None:
    free, stops = np.array([3.0, 5.0]), np.array([1.0, 3.0])
    assert roc(free, stops) == [(1, 0, 0.5), (3, 0.5, 0), (5, 1, 0)]


def first_choice(*measured: Measured) -> Choice:
    return next(choices(measured, SGT, 0.9, 0.01))


def test_the_filter_is_taken_where_single_values_overlap_and_not_before() -> None:
    rng = np.random.default_rng(1)
    clear = Measured(1.0, 100.0, runs(rng, 300, 20, 40), runs(rng, -100, 20, 12, 8))
    assert not first_choice(clear).filtered
    # A run into the stop has few values, a free one many: one of them is low.
    wild = Measured(1.0, 100.0, runs(rng, 300, 500, 40), runs(rng, -190, 10, 12, 8))
    assert first_choice(wild).filtered


def test_a_filtered_value_is_0_where_all_of_its_four_are() -> None:
    run = Run(np.array([9.0, 5.0, 1.0, 2.0, 3.0, 30.0, 1.0, 1.0, 0.0]), np.full(9, 100.0))
    assert (run.least(0.0, filtered=False), run.least(0.0, filtered=True)) == (0.0, 9.0)


def test_the_most_speeds_come_first_and_a_speed_that_cannot_is_left_out() -> None:
    rng = np.random.default_rng(2)
    slow = Measured(
        0.1, 10.0, [Run(one.values, one.speeds_pps / 10) for one in runs(rng, -100, 20, 40)], runs(rng, -100, 20, 12)
    )
    good = [Measured(v, v * 100, runs(rng, 300, 20, 40), runs(rng, -100, 20, 12, 8)) for v in (0.5, 1.0)]
    first = first_choice(slow, *good)
    assert (first.first, first.last) == (1, 2)
    assert -100 < SGT.level(first.threshold) < 280


def test_a_speed_alone_has_its_own_threshold_where_the_span_leaves_it_out_or_takes_another() -> None:
    rng = np.random.default_rng(4)
    slow = Measured(0.5, 50.0, runs(rng, 60, 10, 40), runs(rng, -300, 10, 20, 8))
    fast = Measured(1.0, 100.0, runs(rng, 500, 10, 40), runs(rng, 150, 10, 20, 8))
    slow = Measured(0.5, 50.0, [Run(one.values, one.speeds_pps / 2) for one in slow.free], slow.stops)
    own = [alone(one, SGT, 0.9, 0.01) for one in (slow, fast)]
    assert own[0] is not None
    assert own[1] is not None
    assert -300 < SGT.level(own[0].threshold) < 60 < 150 < SGT.level(own[1].threshold) < 500
    for one in own:
        assert one is not None
        assert (one.false, one.free_runs, one.missed, one.stops, one.may_do) == (0, 40, 0, 20, True)
    assert first_choice(slow, fast).first == first_choice(slow, fast).last


def test_where_nothing_does_it_a_speed_is_told_what_gets_least_wrong() -> None:
    rng = np.random.default_rng(5)
    one = alone(Measured(1.0, 100.0, runs(rng, 50, 60, 40, 1), runs(rng, 20, 60, 20, 1)), SGT, 0.9, 0.01)
    assert one is not None
    assert not one.may_do
    assert 0 < one.false + one.missed < 40
    assert alone(Measured(1.0, 100.0, [], []), SGT, 0.9, 0.01) is None


def test_one_stall_of_twenty_that_is_like_a_free_run_leaves_it_open_and_two_do_not() -> None:
    free = np.full(40, 200.0)
    stops = np.array([-100.0] * 19 + [300.0])
    assert may_do(free, stops, 50.0, 0.01)
    assert not may_do(free, np.append(stops[1:], 300.0), 50.0, 0.01)


def test_a_wide_gap_is_halved_and_a_narrow_one_split_by_how_far_either_spreads() -> None:
    rng = np.random.default_rng(3)
    wide = first_choice(Measured(1.0, 100.0, runs(rng, 400, 3, 40), runs(rng, -100, 3, 20)))
    assert SGT.level(wide.threshold) == pytest.approx(150, abs=20)
    narrow = first_choice(Measured(1.0, 100.0, runs(rng, 100, 30, 40, 1), runs(rng, -20, 10, 20, 1)))
    assert -10 < SGT.level(narrow.threshold) < 40


def test_what_is_wrong_rules_out_half_of_the_thresholds_that_are_left() -> None:
    choice = Choice(0, 0, False, (9, 8, 7, 6, 5, 4, 3), 6, 0.0)
    lower, higher = choice.without(false=True), choice.without(false=False)
    assert lower is not None
    assert higher is not None
    assert (lower.thresholds, lower.threshold) == ((9, 8, 7), 8)
    assert (higher.thresholds, higher.threshold) == ((5, 4, 3), 4)
    assert Choice(0, 0, False, (9, 8), 9, 0.0).without(false=True) is None
