"""StealthChop on an emulated axis: amplitudes and a switch-over speed, found, proved, put back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from app.devices.core.axis_limits import AxisLimits
from app.devices.manager import DeviceChange
from app.studies.document import StudyDocument
from app.studies.kinds import KINDS
from app.studies.pieces import FILE
from app.studies.proof import pair_order
from app.studies.record import StudyRecord
from app.studies.report import html_of
from app.studies.stealthchop.decision import Reach, decide
from app.studies.stealthchop.found import StealthFound, StealthPair
from app.studies.stealthchop.plan import LEAST_RPS, PARTS, PLACES, TIMES, between_of
from tests.devices.tmc5xxx.harness import bench
from tests.plants.choppers import drawn
from tests.studies.harness import START, Studied, studied

FULL = replace(START, vmax=51_200, amax=256_000, irun=25, ihold=25)
PLANT: dict[str, Any] = {
    "motor": {"rotor_teeth": 50, "detent_torque_nm": 0.005},
    "load": {"inertia_kgm2": 5e-6},
    "encoder": {"lines": 10_000},
    "supply_v": 36.0,
    "full_scale_a": 2.1,
}
STUDY: dict[str, Any] = {
    "kind": "stealthchop",
    "resistance_ohm": 2.3,
    "inductance_h": 4.4e-3,
    "run_current_a": 1.5 * 26 / 32,
    "supply_v": 36.0,
    "holding_torque_nm": 0.45,
    "rated_current_a": 1.5,
    "velocity_max_rps": 2.0,
}
NAMES = ("CHOPCONF", "GCONF", "PWMCONF", "TPWMTHRS", "TCOOLTHRS", "VMAX", "AMAX", "IHOLD_IRUN")
TUNES = 0b11 << 18
OFFSET, GRADIENT = 36, 12
"""Of that motor by the formulas of the sheet: 374 R I / V at full scale, and its back-EMF."""


def conf(offset: int, gradient: int) -> int:
    return offset | gradient << 8 | TUNES | 8 << 24 | 12 << 28


async def with_stealthchop(s: Studied, *, pwmconf: int, switch_rps: float | None, on: bool = True) -> None:
    threshold = 0 if switch_rps is None else round(16e6 / (switch_rps * 51_200))
    for name, value in (("PWMCONF", pwmconf & ~TUNES), ("PWMCONF", pwmconf), ("TPWMTHRS", threshold)):
        await s.passing(_write(s, name, value))
    (gconf,) = await s.settings("GCONF")
    await s.passing(_write(s, "GCONF", gconf & ~4 | on << 2))


async def _write(s: Studied, name: str, value: int) -> None:
    await s.device.registers.write(name, 0, value)


async def test_a_switch_over_that_jolts_is_made_slower_and_amplitudes_fit(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        await with_stealthchop(s, pwmconf=conf(90, 0), switch_rps=1.5)
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document(STUDY)), 900)
        found = record.stealthchop
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert found is not None
        assert found.before is not None
        assert found.calculated is not None
        assert found.chosen is not None
        assert (found.calculated.offset, found.calculated.gradient) == (OFFSET, GRADIENT)
        assert found.offset_auto == pytest.approx(OFFSET, abs=1)
        assert found.gradient_auto is not None
        assert found.gradient_auto > GRADIENT / 2
        assert found.chosen.offset == pytest.approx(OFFSET, abs=4)
        assert found.before.switch_rps == pytest.approx(1.5, rel=0.01)
        assert found.before.jolt_fullsteps > 0.5 >= found.chosen.jolt_fullsteps
        assert found.chosen.switch_rps is not None
        assert 0.1 < found.chosen.switch_rps < 1.0
        jolt, added = found.effects
        assert jolt.significant
        assert added.significant
        assert added.winner < 0.1 < 0.3 < added.baseline
        best = record.trial(record.best)
        assert best is not None
        written = {each.name: each.value for each in best.registers}
        assert written["PWMCONF"] & 0xFF == found.chosen.offset
        assert written["PWMCONF"] >> 8 & 0xFF == found.chosen.gradient
        assert await s.settings(*NAMES) == before
        assert (await s.b.state()).position == 0
        assert html_of(record).count("<svg") == 2


async def test_what_it_found_is_kept_and_a_second_study_claims_nothing(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        await with_stealthchop(s, pwmconf=conf(10, 40), switch_rps=0.2)
        first = await s.finish(s.begin(s.document({**STUDY, "keep": True})), 900)
        assert first.improved, first.verdict
        found = first.stealthchop
        assert found is not None
        assert found.chosen is not None
        (pwmconf,) = await s.settings("PWMCONF")
        assert (pwmconf & 0xFF, pwmconf >> 8 & 0xFF) == (found.chosen.offset, found.chosen.gradient)
        second = await s.finish(s.begin(s.document(STUDY)), 900)
        assert (second.state, second.improved, second.best) == ("done", False, None), second.verdict
        assert "stays" in second.verdict


@pytest.mark.parametrize(("trials", "pairs"), [(2, 0), (0, 2)])
async def test_it_goes_on_with_its_tuning_its_trials_and_its_pairs(tmp_path: Path, trials: int, pairs: int) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        await with_stealthchop(s, pwmconf=conf(90, 0), switch_rps=1.5)
        run = s.begin(s.document(STUDY))
        await s.until(
            run,
            lambda record: len(record.trials) >= max(trials, 1) and len(found_of(record).pairs) >= pairs,
        )
        await s.clock.advance(1.0)
        cut = await s.killed(run)
        runs, made = cut.runs, found_of(cut).model_copy(deep=True)
        before, had = made.tried, list(cut.trials)
        record = await s.finish(s.begin(cut.document, cut), 900)
        found = found_of(record)
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert (found.offset_auto, found.gradient_auto) == (made.offset_auto, made.gradient_auto)
        assert found.tried[: len(before)] == before
        assert record.trials[: len(had)] == had
        assert found.pairs[: len(made.pairs)] == made.pairs
        settings = [tuple(sorted(trial.setting.items())) for trial in record.trials]
        assert len({*settings}) == len(settings), "none is tried twice"
        # Each setting from so many places there and back, with it and without in turn in the proof; nothing is tuned.
        baseline = 0 if pairs else 2 * PLACES
        tried, paired = len(found.tried) - len(before), len(found.pairs) - len(made.pairs)
        assert record.runs - runs == baseline + 2 * PLACES * tried + 4 * paired
        assert not (s.store.folder(record.id) / FILE).exists()


def found_of(record: StudyRecord) -> StealthFound:
    assert record.stealthchop is not None
    return record.stealthchop


async def test_an_axis_without_stealthchop_gets_it_up_to_where_it_jolts(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        await with_stealthchop(s, pwmconf=conf(OFFSET, GRADIENT), switch_rps=1.5, on=False)
        record = await s.finish(s.begin(s.document(STUDY)), 900)
        assert record.improved, record.verdict
        assert record.verdict.endswith("one click takes it")
        assert "instead of SpreadCycle at every speed" in record.verdict


async def test_where_every_switch_over_jolts_nothing_is_claimed(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        await with_stealthchop(s, pwmconf=conf(OFFSET, GRADIENT), switch_rps=1.0)
        record = await s.finish(s.begin(s.document({**STUDY, "jolt_max_fullsteps": 0.03})), 900)
        assert (record.state, record.improved, record.best) == ("done", False, None), record.message
        assert "stays" in record.verdict


async def test_lost_steps_are_mended_and_do_not_end_it(tmp_path: Path) -> None:
    """A heavy load slips where the voltage of a slow supply ends; the study finds a slower switch-over all the same."""
    heavy = {**PLANT, "load": {"inertia_kgm2": 1.2e-4}}
    async with studied(tmp_path, FULL, **heavy) as s:
        await with_stealthchop(s, pwmconf=conf(255, 0), switch_rps=1.7)
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document(STUDY)), 1200)
        assert record.state == "done", record.message
        assert await s.settings(*NAMES) == before
        state = await s.b.state()
        assert abs(state.encoder_position - state.position) < 256 * 2


async def test_a_stop_in_the_search_puts_stealthchop_back(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        await with_stealthchop(s, pwmconf=conf(90, 0), switch_rps=1.5)
        before, run = await s.settings(*NAMES), s.begin(s.document(STUDY))
        while len(run.record.trials) < 2:
            await s.clock.advance(0.2)
            assert run.running, run.record.message
        await s.device.stop_axes([0])
        record = await s.finish(run, 60)
        assert (record.state, record.left) == ("aborted", [])
        assert await s.settings(*NAMES) == before


@pytest.mark.parametrize(
    ("model", "words"),
    [("tmc5072", "no StealthChop with a switch-over"), ("tmc5062", "no StealthChop"), ("tmc5130", "")],
)
async def test_a_chip_is_asked_for_what_it_has(tmp_path: Path, model: str, words: str) -> None:
    async with bench(model, start=START, motor={"rotor_teeth": 50}) as b:
        plan = await KINDS["stealthchop"].plan(b.device, 0, _document(b.device.id))
        assert any(words in line for line in plan.missing) if words else plan.missing == []


def _document(device: str) -> StudyDocument:
    return StudyDocument.model_validate({"device": device, "study": STUDY})


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        (AxisLimits(velocity_max_pps=50_000), "soft limit of velocity"),
        (AxisLimits(position_min=-1000, position_max=1000), "soft limits end before"),
    ],
)
async def test_the_plan_says_what_cannot_be(tmp_path: Path, limits: AxisLimits, words: str) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        limited = replace(s.device.axes[0].settings, limits=limits)
        await s.b.manager.edit(s.device.id, DeviceChange(axes=(limited,)))
        plan = await KINDS["stealthchop"].plan(s.device, 0, s.document(STUDY))
        assert any(words in line for line in plan.missing)


async def test_an_amplitude_whose_error_the_chip_tunes_away_is_not_kept(tmp_path: Path) -> None:
    """A slow switch-over: velocity adds next to nothing up to there, and PWM_OFS is tuned whenever the motor rests."""
    async with studied(tmp_path, FULL, **PLANT) as s:
        await with_stealthchop(s, pwmconf=conf(3 * OFFSET, 0), switch_rps=1.0)
        study = {**STUDY, "jolt_max_fullsteps": 0.3}
        found = (await s.finish(s.begin(s.document(study)), 900)).stealthchop
        assert found is not None
        assert found.chosen is not None
        assert found.chosen.switch_rps is not None
        assert found.chosen.switch_rps < 0.5
        assert found.chosen.offset == pytest.approx(OFFSET, abs=2)


async def test_a_current_too_small_to_be_regulated_takes_what_is_calculated(tmp_path: Path) -> None:
    low = {"supply_v": 48.0, "motor": {**PLANT["motor"], "resistance_ohm": 1.0}}
    told = {"supply_v": 48.0, "resistance_ohm": 1.0}
    async with studied(tmp_path, FULL, **{**PLANT, **low}) as s:
        await with_stealthchop(s, pwmconf=conf(90, 0), switch_rps=1.5)
        plan = await KINDS["stealthchop"].plan(s.device, 0, s.document({**STUDY, **told}))
        assert any("too small to be regulated" in line for line in plan.warnings)
        record = await s.finish(s.begin(s.document({**STUDY, **told})), 900)
        found = record.stealthchop
        assert record.improved, record.verdict
        assert found is not None
        assert found.calculated is not None
        assert found.chosen is not None
        assert (found.chosen.offset, found.chosen.gradient) == (found.calculated.offset, found.calculated.gradient)
        assert [each.name for each in found.effects] == ["jolt"]


async def test_a_current_too_small_to_be_regulated_is_tuned_with_a_shorter_blank_time(tmp_path: Path) -> None:
    """The sheet's resistance is 8 % too high: calculated amplitudes would be as far off, what the chip tunes is not."""
    at = {"supply_v": 48.0, "motor": {**PLANT["motor"], "resistance_ohm": 1.6}}
    told = {"supply_v": 48.0, "resistance_ohm": 1.6 * 1.08}
    async with studied(tmp_path, FULL, **{**PLANT, **at}) as s:
        await with_stealthchop(s, pwmconf=conf(90, 0), switch_rps=1.5)
        (chopconf,) = await s.settings("CHOPCONF")
        plan = await KINDS["stealthchop"].plan(s.device, 0, s.document({**STUDY, **told}))
        assert any("tuned with a shorter" in line for line in plan.warnings)
        record = await s.finish(s.begin(s.document({**STUDY, **told})), 900)
        found = record.stealthchop
        assert record.improved, record.verdict
        assert found is not None
        assert found.calculated is not None
        assert found.chosen is not None
        assert found.calculated.offset is not None
        assert found.calculated.gradient is not None
        exact = 374 * 1.6 * 1.5 / 48
        assert found.offset_auto == found.chosen.offset == round(exact)
        assert found.calculated.offset == round(1.08 * exact)
        # Slowly and without a load the back-EMF is at right angles to the current.
        assert found.chosen.gradient is not None
        assert 0 < found.chosen.gradient < 0.8 * found.calculated.gradient
        best = record.trial(record.best)
        assert best is not None
        assert {each.name: each.value for each in best.registers}["CHOPCONF"] == chopconf
        assert await s.settings("CHOPCONF") == [chopconf]


@pytest.mark.parametrize(("unseen", "names"), [(0, ["jolt", "added"]), (3, ["jolt", "added"]), (4, ["jolt"])])
def test_runs_in_which_no_amplitude_was_seen_do_not_hide_the_others(unseen: int, names: list[str]) -> None:
    def pair(index: int) -> StealthPair:
        before = None if index < unseen else 0.7 + 0.01 * index
        return StealthPair(
            baseline_jolt_fullsteps=0.1,
            winner_jolt_fullsteps=0.1,
            baseline_added_share=before,
            winner_added_share=0.04,
            order=pair_order(index),
        )

    shown = decide([pair(index) for index in range(10)], Reach(1.0, 1.0), 0.5, 0.05, 1)
    assert [each.name for each in shown.effects] == names
    assert shown.improved == ("added" in names)
    assert [each.pairs for each in shown.effects] == [10, 10 - unseen][: len(names)]


def test_the_same_switch_over_speeds_are_tried_wherever_a_study_begins() -> None:
    grid = [LEAST_RPS * TIMES ** (index / PARTS) for index in range(4 * PARTS + 1)]
    assert between_of(grid[4], grid[8]) == pytest.approx(grid[6])
    assert between_of(1.02 * grid[4], grid[8]) == pytest.approx(grid[6])
    assert between_of(grid[6], grid[7]) is None
    held, above = grid[0], grid[4]
    while (between := between_of(held, above)) is not None:
        held = between
    assert held == pytest.approx(grid[3])


def test_a_reach_may_shrink_where_nothing_regulated_a_wrong_current() -> None:
    pairs = [
        StealthPair(
            baseline_jolt_fullsteps=0.4,
            winner_jolt_fullsteps=0.4,
            baseline_added_share=1.5 + 0.001 * index,
            winner_added_share=0.01,
            order=pair_order(index),
        )
        for index in range(10)
    ]
    slower = Reach(before=0.6, now=0.4)
    assert decide(pairs, slower, 0.5, 0.05, 1, regulated=False).improved
    assert not decide(pairs, slower, 0.5, 0.05, 1, regulated=True).improved


async def test_a_switch_over_is_tried_all_over_a_full_step(tmp_path: Path) -> None:
    """Of this plant it jolts by 0.41 to 0.51 full steps, by where in a full step it falls."""
    plant = drawn(25)
    motor, lines = plant.options["motor"], plant.options["encoder"]["lines"]
    start = replace(FULL, irun=plant.irun, ihold=plant.irun, counts_per_rev=4 * lines)
    sheet = {"holding_torque_nm": motor["holding_torque_nm"], "rated_current_a": motor["rated_current_a"]}
    async with studied(tmp_path, start, **plant.options) as s:
        await with_stealthchop(s, pwmconf=3 | TUNES | 1 << 16 | 4 << 24 | 12 << 28, switch_rps=0.3215)
        study = {"kind": "stealthchop", "velocity_max_rps": 2.5, "jolt_max_fullsteps": 0.5, **plant.told, **sheet}
        record = await s.finish(s.begin(s.document(study, seed=25)), 900)
        found = record.stealthchop
        assert record.improved, record.verdict
        assert found is not None
        assert found.chosen is not None
        jolts = [each.winner_jolt_fullsteps for each in found.pairs]
        assert max(jolts) > 1.1 * min(jolts)
        assert max(jolts) <= found.chosen.jolt_fullsteps + 0.02 < 0.5


async def test_a_jolt_that_too_few_samples_show_is_not_taken_for_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.studies.stealthchop.study.RATE_HZ", 100.0)
    async with studied(tmp_path, FULL, **PLANT) as s:
        await with_stealthchop(s, pwmconf=conf(90, 0), switch_rps=1.5)
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document(STUDY)), 900)
        assert (record.state, record.improved) == ("failed", None)
        assert "samples came around each moment" in record.message
        assert await s.settings(*NAMES) == before


async def test_the_plan_tells_of_runs_and_registers(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        plan = await KINDS["stealthchop"].plan(s.device, 0, s.document(STUDY))
        assert plan.missing == []
        assert plan.velocity_max_pps == pytest.approx(2.0 * 51_200)
        for name in ("PWMCONF", "TPWMTHRS", "GCONF"):
            assert any(name in each for each in plan.registers)
        assert any("PWM_GRAD_AUTO" in line for line in plan.steps)
