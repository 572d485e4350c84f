"""A chopper setting on an emulated axis whose SpreadCycle bends its currents: found, proved, put back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from app.devices.core.axis_limits import AxisLimits
from app.devices.manager import DeviceChange
from app.emulators.tmc5xxx import Tmc5xxxOptions
from app.studies.chopper.plan import look
from app.studies.document import CalmChopper
from app.studies.kinds import KINDS
from app.studies.record import StudyRecord
from app.studies.report import html_of
from app.studies.run import StudyRun
from tests.bench.studies.chopper import SPEEDS, shaken
from tests.plants.choppers import drawn
from tests.studies.harness import START, Studied, studied

FULL = replace(START, vmax=51_200, amax=256_000, irun=31, ihold=31)
PLANT: dict[str, Any] = {
    "motor": {"rotor_teeth": 50, "detent_torque_nm": 0.005},
    "ripple": True,
    "supply_v": 36.0,
    "full_scale_a": 2.1,
}
STUDY: dict[str, Any] = {
    "kind": "chopper",
    "resistance_ohm": 2.3,
    "inductance_h": 4.4e-3,
    "run_current_a": 1.485,
    "supply_v": 36.0,
    "speeds_rps": [0.5, 1.0],
}
NAMES = ("CHOPCONF", "GCONF", "VMAX", "AMAX")


async def with_hysteresis(s: Studied, hysteresis: int, off: int = 3, blank: int = 2) -> None:
    start = min(8, hysteresis + 3)
    (chopconf,) = await s.settings("CHOPCONF")
    chopconf = chopconf & ~0x1FFFF | off | (start - 1) << 4 | (hysteresis - start + 3) << 7 | blank << 15
    await s.passing(_write(s, chopconf))


async def _write(s: Studied, chopconf: int) -> None:
    await s.device.registers.write("CHOPCONF", 0, chopconf)


async def test_a_calmer_setting_is_found_and_proved_and_the_axis_is_as_before(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        await with_hysteresis(s, -2)
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document(STUDY, budget={"trials": 8})), 600)
        found = record.chopper
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert "resonance map" in record.next
        assert found is not None
        assert found.before is not None
        assert found.chosen is not None
        assert found.calculated is not None
        assert found.effect is not None
        assert len(found.tried) == 8
        assert found.before.hysteresis == -2
        assert found.calculated.hysteresis >= 4
        assert found.chosen.ripple_fullsteps < 0.8 * found.before.ripple_fullsteps
        assert found.effect.interval_fullsteps.high < 0
        assert all(20e3 <= one.chopper_hz <= 60e3 for one in found.tried)
        best = record.trial(record.best)
        assert best is not None
        assert {each.name: each.value for each in best.registers}["CHOPCONF"] & 15 == found.chosen.off
        assert await s.settings(*NAMES) == before
        assert (await s.b.state()).position == 0
        assert html_of(record).count("<svg") == 2


async def test_a_search_that_asks_for_the_same_again_goes_on_to_its_last_trial(tmp_path: Path) -> None:
    """Of the 30 settings that it might try here it tried 12, and was over."""
    study = {**STUDY, "speeds_rps": [1.0], "lowest_hz": 47e3}
    async with studied(tmp_path, FULL, **PLANT) as s:
        ground = (await look(s.device, 0, CalmChopper.model_validate(study))).required()
        record = await s.finish(s.begin(s.document(study, budget={"trials": 40})), 2000)
        assert record.state == "done", record.message
        assert record.chopper is not None
        tried = [(one.off, one.blank, one.hysteresis) for one in record.chopper.tried]
        assert sorted(tried) == sorted((each.off, each.blank, each.hysteresis) for each in ground.allowed)


@pytest.mark.parametrize(("seed", "off", "blank", "hysteresis"), [(27, 6, 3, -1), (27, 10, 2, -1), (40, 10, 0, 2)])
async def test_what_counts_of_a_run_is_the_shaft_when_its_resonance_has_built_up(
    tmp_path: Path, seed: int, off: int, blank: int, hysteresis: int
) -> None:
    """It was looked at as soon as it had come to its speed, and some settings were still calm by luck."""
    plant = drawn(seed)
    start = replace(FULL, irun=plant.irun, ihold=plant.irun, counts_per_rev=4 * plant.options["encoder"]["lines"])
    async with studied(tmp_path, start, **plant.options) as s:
        await with_hysteresis(s, hysteresis, off, blank)
        chopconf, current, scaler = await s.settings("CHOPCONF", "IHOLD_IRUN", "GLOBAL_SCALER")
        study = {"kind": "chopper", "speeds_rps": list(SPEEDS), **plant.told}
        record = await s.finish(s.begin(s.document(study, budget={"trials": 2})), 600)
        assert record.chopper is not None, record.message
        assert record.chopper.before is not None
        registers = {"CHOPCONF": chopconf, "IHOLD_IRUN": current, "GLOBALSCALER": scaler}
        settled = shaken(Tmc5xxxOptions.model_validate(plant.options), registers)
        assert record.chopper.before.ripple_fullsteps == pytest.approx(settled, rel=0.05)


async def test_where_nothing_is_calmer_nothing_is_claimed(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        await with_hysteresis(s, 9)
        record = await s.finish(s.begin(s.document(STUDY, budget={"trials": 3})), 600)
        assert (record.state, record.improved, record.best) == ("done", False, None), record.message
        assert "stays" in record.verdict
        assert record.next


async def test_what_is_kept_is_the_new_setting_and_nothing_else(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        await with_hysteresis(s, -2)
        chopconf, *rest = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document({**STUDY, "keep": True}, budget={"trials": 3})), 600)
        assert record.improved, record.verdict
        now, *others = await s.settings(*NAMES)
        assert others == rest
        assert now != chopconf
        assert now & ~0x187FF == chopconf & ~0x187FF


async def test_a_stop_in_the_search_puts_the_chopper_back(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        before, run = await s.settings(*NAMES), s.begin(s.document(STUDY))
        while run.record.phase != "search" or len(run.record.trials) < 2:
            await s.clock.advance(0.2)
            assert run.running, run.record.message
        await s.device.stop_axes([0])
        record = await s.finish(run, 60)
        assert (record.state, record.left) == ("aborted", [])
        assert await s.settings(*NAMES) == before


async def cut_off(s: Studied, run: StudyRun, *, by_kill: bool) -> StudyRecord:
    if by_kill:
        return await s.killed(run)
    await s.passing(run.abort("stopped"))
    return run.record


@pytest.mark.parametrize("by_kill", [False, True])
async def test_it_goes_on_with_the_trials_that_it_had(tmp_path: Path, by_kill: bool) -> None:
    """They were dropped from the record, and the next one was called the calculated setting."""
    async with studied(tmp_path, FULL, **PLANT) as s:
        await with_hysteresis(s, -2)
        run = s.begin(s.document(STUDY, budget={"trials": 6}))
        await s.until(run, lambda record: len(record.trials) == 3)
        await s.clock.advance(1.0)
        cut = await cut_off(s, run, by_kill=by_kill)
        assert cut.chopper is not None
        trials, tried, calculated = list(cut.trials), list(cut.chopper.tried), cut.chopper.calculated
        assert (len(trials), len(tried)) == (3, 3)
        record = await s.finish(s.begin(cut.document, cut), 600)
        found = record.chopper
        assert (record.state, record.left) == ("done", []), record.message
        assert found is not None
        assert record.trials[:3] == trials
        assert found.tried[:3] == tried
        assert found.calculated == calculated
        assert [one.why for one in found.tried] == ["calculated", *[""] * 5]
        settings = [(one.off, one.blank, one.hysteresis) for one in found.tried]
        assert len({*settings}) == len(settings) == 6, "the budget has six trials, and none is made twice"
        assert len({trial.number for trial in record.trials}) == 6
        assert (await s.b.state()).position == 0, "it went back to where it began"
        assert record.improved, record.verdict


async def test_it_goes_on_with_the_pairs_of_its_proof(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        await with_hysteresis(s, -2)
        run = s.begin(s.document(STUDY, budget={"trials": 3}))
        await s.until(run, lambda record: record.chopper is not None and len(record.chopper.pairs) == 2)
        runs = run.record.runs
        cut = await s.killed(run)
        assert cut.chopper is not None
        assert cut.chopper.chosen is not None
        pairs, chosen = list(cut.chopper.pairs), cut.chopper.chosen
        record = await s.finish(s.begin(cut.document, cut), 600)
        assert (record.state, record.improved) == ("done", True), record.message
        assert record.chopper is not None
        assert record.chopper.pairs[: len(pairs)] == pairs
        assert (len(record.chopper.pairs), record.chopper.chosen) == (10, chosen)
        # Nothing but the pairs that were not made yet, and one way there and back to fall into step.
        assert record.runs <= runs + 4 * 2 * (10 - len(pairs)) + 2


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"lowest_hz": 50_000.0, "supply_v": 4.0}, "no setting chops"),
        ({"speeds_rps": [1.0, 50.0]}, "soft limit of velocity"),
    ],
)
async def test_the_plan_says_what_cannot_be(tmp_path: Path, change: dict[str, Any], words: str) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        limited = replace(s.device.axes[0].settings, limits=AxisLimits(velocity_max_pps=1e6))
        await s.b.manager.edit(s.device.id, DeviceChange(axes=(limited,)))
        plan = await KINDS["chopper"].plan(s.device, 0, s.document({**STUDY, **change}))
        assert any(words in line for line in plan.missing)


async def test_the_plan_tells_of_runs_and_registers(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        plan = await KINDS["chopper"].plan(s.device, 0, s.document(STUDY, budget={"trials": 5}))
        assert plan.missing == []
        assert plan.moves_max == 4 * (2 + 5 + 6 + 20)
        assert any("CHOPCONF" in name for name in plan.registers)
        assert any("calculated from the coil: TOFF" in line for line in plan.steps)
