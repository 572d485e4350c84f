"""The least current of a load cycle on an emulated axis: found, proved, put back, and left where there is none."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import takewhile
from pathlib import Path
from typing import Any

import pytest

from app.devices.core.axis_limits import AxisLimits
from app.devices.manager import DeviceChange
from app.studies.document import LeastCurrent
from app.studies.kinds import KINDS
from app.studies.least_current.cycle import Cycle, faster
from app.studies.least_current.found import CurrentTried, LeastCurrentFound
from app.studies.least_current.plan import BASELINE_CYCLES, look
from app.studies.ramp_settings import ACCELERATION, SPEED
from app.studies.record import StudyRecord
from app.studies.report import html_of
from tests.studies.harness import START, Studied, studied

FULL = replace(START, vmax=256_000, amax=1_000_000, irun=31, ihold=20)
CYCLE: dict[str, Any] = {
    "kind": "least_current",
    "distance": 25_600,
    "margin": 0.25,
    "loss_rate_max": 0.2,
    "resistance_ohm": 2.3,
    "run_current_a": 1.06,
    "coolstep": False,
}
COOL: dict[str, Any] = {**CYCLE, "distance": 102_400, "coolstep": True}
# It accelerates hard and moves on with little: what CoolStep is for.
UNEVEN: dict[str, Any] = {
    "motor": {"viscous_nms": 0.002, "holding_torque_nm": 0.45},
    "load": {"inertia_kgm2": 3e-4, "friction_nm": 0.02},
    "full_scale_a": 1.5,
}
COOL_NAMES = ("IHOLD_IRUN", "VMAX", "AMAX", "COOLCONF", "TCOOLTHRS")
TELLS = replace(FULL, vmax=160_000, amax=2_500_000)
PLANT: dict[str, Any] = {"load": {"inertia_kgm2": 5e-4, "friction_nm": 0.05}, "full_scale_a": 1.5}
NAMES = ("IHOLD_IRUN", "VMAX", "AMAX")


async def test_a_lower_current_is_found_and_proved_and_the_axis_is_as_before(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document(CYCLE)), 300)
        found = record.least_current
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert record.next.startswith("take it, then StallGuard")
        assert found is not None
        assert found.edge is not None
        assert found.chosen is not None
        assert found.proved is not None
        assert found.edge <= found.proved < found.chosen < 31
        assert (found.proved + 1) / (found.chosen + 1) <= 0.75
        assert any(one.scale == found.edge - 1 and not one.held for one in found.tried)
        proved = [one for one in found.tried if one.scale == found.proved and one.cycles == found.cycles]
        assert [one.speed_times for one in proved] == [pytest.approx(1.25, rel=0.01), 1.0]
        assert not found.limited_by_supply
        assert found.speed_times == pytest.approx(1.25, rel=0.01)
        assert found.cycles == 14
        assert found.loss_rate_max == pytest.approx(1 - 0.05 ** (1 / 14))
        share = ((found.chosen + 1) / 32) ** 2
        assert found.saving is not None
        assert found.saving.saved_w == pytest.approx(2 * 1.06**2 * 2.3 * (1 - share))
        assert await s.settings(*NAMES) == before
        state = await s.b.state()
        assert (state.position, abs(state.encoder_position or 0) < 256) == (0, True)
        best = record.trial(record.best)
        assert best is not None
        assert best.registers[0].value >> 8 & 31 == found.chosen
        assert best.registers[0].value & 31 == min(found.chosen, 20)
        report = html_of(record)
        assert "Heat of the coils, calculated" in report
        assert report.count("<svg") == 1


async def test_a_current_that_is_no_more_than_needed_stays(tmp_path: Path) -> None:
    low = replace(FULL, irun=19, ihold=8)
    async with studied(tmp_path, low, **PLANT) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document({**CYCLE, "margin": 0.5})), 300)
        assert (record.state, record.improved, record.best) == ("done", False, None), record.message
        assert "stays as it is" in record.verdict
        assert record.next.startswith("a smaller margin")
        assert await s.settings(*NAMES) == before


async def test_a_stop_in_the_proof_puts_the_current_back(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        before, run = await s.settings(*NAMES), s.begin(s.document(CYCLE))
        while run.record.phase != "proof":
            await s.clock.advance(0.2)
            assert run.running, run.record.message
        await s.clock.advance(1.0)
        assert (await s.settings("IHOLD_IRUN")) != before[:1]
        await s.device.stop_axes([0])
        record = await s.finish(run, 60)
        assert (record.state, record.left) == ("aborted", [])
        assert await s.settings(*NAMES) == before


@pytest.mark.parametrize("phase", ["search", "proof"])
async def test_it_goes_on_with_the_currents_that_are_left(tmp_path: Path, phase: str) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        run = s.begin(s.document(CYCLE))
        await s.until(run, lambda record: record.phase == phase and len(found_of(record).tried) >= 3)
        await s.clock.advance(1.0)
        cut = await s.killed(run)
        runs, tried = cut.runs, list(found_of(cut).tried)
        record = await s.finish(s.begin(cut.document, cut), 300)
        found = found_of(record)
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert found.tried[: len(tried)] == tried
        keys = [(one.scale, one.speed_times, one.cycles) for one in found.tried]
        assert len({*keys}) == len(keys)
        assert record.runs - runs == BASELINE_CYCLES + sum(one.cycles for one in found.tried[len(tried) :])


def found_of(record: StudyRecord) -> LeastCurrentFound:
    assert record.least_current is not None
    return record.least_current


async def test_the_plan_tells_of_cycles_and_of_what_watts_need(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        document = s.document({"kind": "least_current", "distance": -25_600, "coolstep": False})
        plan = await KINDS["least_current"].plan(s.device, 0, document)
        assert plan.missing == []
        # 160,000 microsteps/s are reached on the way; 1.25 times as much with the same acceleration need 40,000.
        assert plan.position_to == 0
        assert plan.position_from == pytest.approx(-1024 - 25_600 * 1.25**2, rel=0.001)
        assert plan.velocity_max_pps == pytest.approx(1.25 * 160_000, rel=0.001)
        assert plan.moves_max == 2 * (3 + 10 * 3 + 2 * 59)
        assert any("not in watts" in line for line in plan.warnings)
        more = await KINDS["least_current"].plan(
            s.device, 0, s.document({"kind": "least_current", "distance": -25_600})
        )
        assert more.moves_max > plan.moves_max
        assert {"COOLCONF", "TCOOLTHRS"} <= {*more.registers} - {*plan.registers}
        assert any(line.startswith("CoolStep at the run current") for line in more.steps)


async def test_where_the_supply_limits_less_current_is_no_margin(tmp_path: Path) -> None:
    fast = replace(FULL, vmax=500_000, amax=1_000_000)
    async with studied(tmp_path, fast, **PLANT, supply_v=14.0) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document({**CYCLE, "distance": 256_000})), 300)
        found = record.least_current
        assert (record.state, record.improved, record.best) == ("done", False, None), record.message
        assert found is not None
        assert found.limited_by_supply
        assert found.speed_times_held is not None
        assert 1.0 <= found.speed_times_held < 1.25
        assert "by the supply voltage, not by the current" in record.verdict
        assert await s.settings(*NAMES) == before


async def test_coolstep_takes_current_from_the_steady_part_and_loses_no_step(tmp_path: Path) -> None:
    async with studied(tmp_path, TELLS, **UNEVEN) as s:
        before = await s.settings(*COOL_NAMES)
        record = await s.finish(s.begin(s.document(COOL)), 900)
        found = record.least_current
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert found is not None
        cool = found.coolstep
        assert cool is not None
        assert cool.why == ""
        assert cool.setting is not None
        assert cool.setting.semin >= 2
        assert cool.steady is not None
        assert cool.cycles == 14
        assert len(cool.pairs) == 10
        assert all(pair.with_it < pair.without for pair in cool.pairs)
        assert [pair.without for pair in cool.pairs] == pytest.approx([1.0] * 10, abs=0.05)
        assert cool.saved_share is not None
        assert cool.interval_share is not None
        assert 0.1 < cool.interval_share.low <= cool.saved_share <= cool.interval_share.high < 0.94
        assert cool.saving is not None
        assert found.saving is not None
        assert cool.saving.before_w == pytest.approx(found.saving.after_w)
        assert cool.saving.saved_w == pytest.approx(cool.saving.before_w * cool.saved_share)
        assert await s.settings(*COOL_NAMES) == before
        best = record.trial(record.best)
        assert best is not None
        held = {each.name: each.value for each in best.registers}
        assert held["COOLCONF"] & 15 == cool.setting.semin
        assert held["COOLCONF"] >> 5 & 3 == cool.setting.seup
        assert held["TCOOLTHRS"] > 0
        assert "CoolStep" in html_of(record)
        # the page's table of before and best has all that taking the best sets
        assert set(record.units) == set(best.setting) == set(record.baseline_setting)
        assert (record.baseline_setting["SEMIN"], best.setting["SEMIN"]) == (0, cool.setting.semin)


async def test_a_chip_that_is_set_to_stealthchop_has_no_coolstep_and_the_plan_says_why(tmp_path: Path) -> None:
    async with studied(tmp_path, TELLS, **PLANT) as s:
        await s.device.registers.write("GCONF", None, None, {"en_pwm_mode": 1})
        plan = await KINDS["least_current"].plan(s.device, 0, s.document(COOL))
        assert plan.missing == []
        assert any("StealthChop is on" in line for line in plan.warnings)
        assert not any("COOLCONF" in name for name in plan.registers)


async def test_a_cycle_without_a_steady_part_leaves_nothing_to_coolstep(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        record = await s.finish(s.begin(s.document({**CYCLE, "coolstep": True})), 400)
        found = record.least_current
        assert found is not None
        assert found.coolstep is not None
        assert "steady speed" in found.coolstep.why
        assert (record.improved, record.best) == (True, 1)


async def test_where_a_stall_stops_the_motor_level_and_speed_of_coolstep_are_not_its_own(tmp_path: Path) -> None:
    async with studied(tmp_path, replace(TELLS, amax=1_000_000), **PLANT) as s:
        await s.device.registers.write("SW_MODE", 0, None, {"sg_stop": 1})
        plan = await KINDS["least_current"].plan(s.device, 0, s.document(COOL))
        assert any("a stall stops the motor from a speed on" in line for line in plan.warnings)
        await s.device.registers.write("TCOOLTHRS", 0, 160)  # of 16 MHz
        await s.device.registers.write("COOLCONF", 0, None, {"sgt": -10})
        await s.device.registers.write("SW_MODE", 0, None, {"sg_stop": 0})
        space = (await look(s.device, 0, LeastCurrent.model_validate(COOL))).required().cool
        assert space is not None
        assert space.from_pps == pytest.approx(100_000, rel=0.01)
        assert space.level == -10


async def test_a_load_cycle_in_which_lower_current_loses_steps_gets_no_coolstep(tmp_path: Path) -> None:
    """The rotor rings for long after each change of speed: load that comes back faster than the current does."""
    ringing = replace(TELLS, amax=1_000_000)
    async with studied(tmp_path, ringing, **PLANT) as s:
        before = await s.settings(*COOL_NAMES)
        record = await s.finish(s.begin(s.document(COOL)), 900)
        found = record.least_current
        assert found is not None
        assert found.coolstep is not None
        assert found.coolstep.why
        assert found.coolstep.setting is None
        assert (record.best, record.improved, record.left) == (1, True, [])
        assert await s.settings(*COOL_NAMES) == before


def test_more_speed_takes_more_way_or_where_there_is_none_a_harder_ramp() -> None:
    most = {SPEED: 1e6, ACCELERATION: 1e7}
    short, long = (Cycle(distance, {SPEED: 200.0, ACCELERATION: 100.0}) for distance in (-100, -1000))
    further = faster(short, 1.2, most, 1000)
    assert further is not None
    assert (further.distance, further.ramp[ACCELERATION]) == (-144, 100.0)
    assert further.peak == pytest.approx(120)
    harder = faster(short, 1.2, most, 120)
    assert harder is not None
    assert harder.distance == -100
    assert harder.ramp[ACCELERATION] == pytest.approx(144)
    straight = faster(long, 1.2, most, 1000)
    assert straight is not None
    assert straight.distance == -1000
    assert straight.ramp[SPEED] == pytest.approx(240)
    assert faster(long, 1.2, {SPEED: 201.0, ACCELERATION: 100.0}, 1000) is None
    bounded = faster(short, 1.2, {SPEED: 1e6, ACCELERATION: 121.0}, 120)
    assert bounded is not None
    assert bounded.times == pytest.approx(1.1)


TWIN: dict[str, Any] = {"motor": {"load_inertia_kgm2": 5e-4, "load_friction_nm": 0.05, "supply_v": 24.0}}
SCALED = AxisLimits(current_full_scale_a=1.5 / math.sqrt(2))
RESISTOR = AxisLimits(sense_resistor_ohm=0.325 / 1.5)
"""The same full scale (DS-TMC5160 9)."""


async def searched(s: Studied, study: dict[str, Any]) -> tuple[StudyRecord, list[CurrentTried]]:
    """The study's record, and the currents that it tried on the axis before it proved one."""
    record = await s.finish(s.begin(s.document(study)), 300)
    assert (record.state, record.left) == ("done", []), record.message
    found = record.least_current
    assert found is not None
    return record, list(takewhile(lambda one: one.cycles <= 3, found.tried[1:]))


async def test_a_twin_tells_where_the_edge_is_and_a_wrong_one_costs_trials_alone(tmp_path: Path) -> None:
    async with studied(tmp_path / "alone", FULL, **PLANT) as s:
        alone, by_halves = await searched(s, CYCLE)
    assert alone.least_current is not None
    edge = alone.least_current.edge
    right = await after_a_twin(tmp_path / "right", edge, RESISTOR, {})
    assert len(right) <= 3
    assert sum(not one.held for one in right) < sum(not one.held for one in by_halves)
    wrong = await after_a_twin(tmp_path / "wrong", edge, SCALED, {"load_inertia_kgm2": 2e-4, "load_friction_nm": 0.0})
    assert len(wrong) <= 9


async def after_a_twin(
    tmp_path: Path, edge: int | None, limits: AxisLimits, motor: dict[str, float]
) -> list[CurrentTried]:
    """The currents that a study tries on the axis after a twin with this motor, until it has found that edge."""
    async with studied(tmp_path, FULL, **PLANT) as s:
        scaled = replace(s.device.axes[0].settings, limits=limits)
        await s.b.manager.edit(s.device.id, DeviceChange(axes=(scaled,)))
        before = await s.settings(*NAMES)
        study = {**CYCLE, "twin": {"motor": {**TWIN["motor"], **motor}}}
        plan = await KINDS["least_current"].plan(s.device, 0, s.document(study))
        assert "32 currents on an emulated twin: the motor rests meanwhile" in plan.steps
        record, near = await searched(s, study)
        assert await s.settings(*NAMES) == before
    assert record.twin
    (told,) = (one for one in record.findings if one.name == "twin")
    assert "of 32 settings held" in told.text
    assert record.least_current is not None
    assert record.least_current.edge == edge
    assert near[0].scale == record.twin[0].setting["run current scale"]
    return near


async def test_without_a_full_scale_in_amperes_no_current_is_tried_on_a_twin(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        record, _ = await searched(s, {**CYCLE, "twin": TWIN})
        (told,) = (one for one in record.findings if one.name == "twin")
        assert told.sure == "missing"
        assert "how many amperes a full scale is" in told.text
        assert told.text.endswith("set sense_resistor_ohm or current_full_scale_a in its limits")
        assert record.twin == []
        assert record.improved


async def test_its_proof_tells_how_long_it_takes_yet(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        run, told = s.begin(s.document(CYCLE)), list[tuple[float, float, float]]()
        while run.running:
            await s.clock.advance(0.5)
            if run.record.phase == "proof" and run.record.left_s is not None:
                told.append((s.clock.now(), run.record.left_s, run.record.progress))
        # The last proof, which held: an earlier one may have ended with a lost step.
        at_s, left_s, progress = told[-30]
        assert 0.4 < progress < told[-1][2] <= 0.95
        assert left_s == pytest.approx(s.clock.now() - at_s, rel=0.4)
