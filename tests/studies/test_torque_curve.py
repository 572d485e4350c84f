"""Torque over speed of an emulated axis: what slips tell, and that nothing of the axis is other afterwards."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.calc.motor_torque import StepperMotor
from app.calc.motors.pull_out import pull_out
from app.emulators.tmc5xxx.options import AxisChange, Tmc5xxxPatch
from app.studies.kinds import KINDS
from app.studies.report import html_of
from tests.bench.studies.torque_curve import advanced, braked
from tests.studies.harness import START, Studied, studied

FULL = replace(START, irun=31, ihold=31)
MOTOR = {"rotor_teeth": 50, "detent_torque_nm": 0.0, "viscous_nms": 1e-3, "friction_nm": 0.005}
INERTIA = 1e-3
LOAD = {"inertia_kgm2": INERTIA - 58e-7, "friction_nm": 0.02}
ROOM = {"left_at_fullsteps": -1e6, "right_at_fullsteps": 1e6}
PLANT: dict[str, Any] = {"motor": MOTOR, "load": LOAD, "stage": ROOM, "full_scale_a": 1.5, "supply_v": 36}
QUICK: dict[str, Any] = {
    "kind": "torque_curve",
    "velocity_max_rps": 9.0,
    "travel_turns": 200.0,
    "speeds": 2,
    "repeats": 2,
    "inertia_kgm2": INERTIA,
    "inertia_share": 0.02,
}
NAMES = ("VMAX", "AMAX", "DMAX", "V1")


async def test_slips_tell_the_torque_and_the_axis_is_as_before(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document(QUICK)), 300)
        found = record.torque
        assert (record.state, record.left, record.improved) == ("done", [], None), record.message
        assert found is not None
        assert [point.slips for point in found.points] == [2, 2]
        for point in found.points:
            # The driver holds its current at these speeds; friction takes its part.
            motor = StepperMotor(supply_v=36.0)
            speed_pps = point.speed_rps * 51_200
            friction = 0.025 + 1e-3 * point.speed_rps * 2 * np.pi
            expected = float(motor.available_nm(speed_pps)) - friction
            assert point.torque_nm == pytest.approx(expected, rel=0.05)
            assert point.interval_nm is not None
            assert point.interval_nm.low < expected < point.interval_nm.high
        assert found.margin is not None
        assert found.margin.times == pytest.approx(
            found.points[0].acceleration_radps2 / (200_000 / 51_200 * 2 * np.pi), rel=0.1
        )
        assert await s.settings(*NAMES) == before
        assert abs((await s.b.state()).position) <= 1
        assert "Torque over speed" in html_of(record)
        assert html_of(record).count("<svg") == 1


async def gently(s: Studied) -> None:
    """The ramp by which a judge comes up to a speed."""
    await s.device.registers.write("AMAX", 0, 5000)


async def test_where_the_supply_limits_the_current_a_brake_agrees(tmp_path: Path) -> None:
    """A rotor that is thrown out of step there has less torque than one that falls: its currents do not follow."""
    async with studied(tmp_path, FULL, **{**PLANT, "supply_v": 30.0}) as s:
        study = {**QUICK, "velocity_max_rps": 20.0, "travel_turns": 400.0}
        record = await s.finish(s.begin(s.document(study)), 600)
        assert record.torque is not None
        point = record.torque.points[-1]
        assert point.speed_rps > 14
        assert point.torque_nm is not None
        assert point.interval_nm is not None
        await s.passing(gently(s))
        truth_nm = await advanced(s, braked(s, point.speed_rps, point.torque_nm))
        assert point.torque_nm == pytest.approx(truth_nm, rel=0.035)
        assert point.interval_nm.low < truth_nm < point.interval_nm.high


async def test_a_load_that_does_not_follow_the_way_back_is_mended(tmp_path: Path) -> None:
    """It still swung as it set off: the axis stood 40 turns from where it was told."""
    async with studied(tmp_path, FULL, **PLANT) as s:
        run = s.begin(s.document(QUICK))
        while run.record.torque is None or len(run.record.torque.points) < 2:
            await s.clock.advance(0.02)
        s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, blocked=True)]))
        await s.clock.advance(2.0)
        s.b.patch(Tmc5xxxPatch(axes=[AxisChange(axis=0, blocked=False)]))
        record = await s.finish(run, 300)
        assert record.state == "done", record.message
        state = await s.b.state()
        assert state.encoder_position == pytest.approx(state.position, abs=256)


async def test_an_axis_too_light_to_lose_steps_is_told_what_it_has_at_least(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **{**PLANT, "load": {"inertia_kgm2": 5e-5}}) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(s.document({**QUICK, "inertia_kgm2": None})), 300)
        assert record.state == "done", record.message
        assert "no step is lost at the greatest acceleration" in record.verdict
        assert record.torque is not None
        assert record.torque.at_least_radps2 == pytest.approx(934, rel=0.01)
        assert await s.settings(*NAMES) == before


async def test_a_stop_while_a_rotor_is_out_of_step_puts_the_ramp_back(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        before, run = await s.settings(*NAMES), s.begin(s.document(QUICK))
        while run.record.torque is None or not run.record.torque.points:
            await s.clock.advance(0.2)
            assert run.running, run.record.message
        await s.clock.advance(1.0)
        await s.device.stop_axes([0], "ramp")
        record = await s.finish(run, 60)
        assert (record.state, record.left) == ("aborted", [])
        assert await s.settings(*NAMES) == before


async def test_it_goes_on_with_the_speeds_that_are_left(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        run = s.begin(s.document({**QUICK, "speeds": 3}))
        await s.until(run, lambda record: record.torque is not None and len(record.torque.points) == 1)
        await s.clock.advance(1.0)
        cut = await s.killed(run)
        assert cut.torque is not None
        runs, points, speeds = cut.runs, list(cut.torque.points), list(cut.torque.speeds_rps)
        assert (len(points), len(speeds)) == (1, 3)
        record = await s.finish(s.begin(cut.document, cut), 300)
        found = record.torque
        assert (record.state, record.left) == ("done", []), record.message
        assert found is not None
        assert found.points[0] == points[0]
        assert [point.asked_rps for point in found.points] == found.speeds_rps == speeds
        assert abs((await s.b.state()).position) <= 1
        assert 4 <= record.runs - runs <= 8, "two slips at each of the two that were left, and no look at the range"
        assert found.margin is not None


async def test_a_motor_that_a_dead_link_has_left_turning_is_told(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        run = s.begin(s.document(QUICK))
        while abs((await s.device.monitor.axis_state(0)).velocity_pps) < 51_200:
            await s.clock.advance(0.05)
            assert run.running, run.record.message
        s.b.fault(unplugged=True)
        record = await s.finish(run, 120)
        assert record.state == "failed", record.message
        assert any("may still turn: stop it" in line for line in record.left), record.left


async def test_the_plan_tells_of_room_and_of_an_inertia_that_is_not_known(tmp_path: Path) -> None:
    async with studied(tmp_path, FULL, **PLANT) as s:
        document = s.document({"kind": "torque_curve"})
        plan = await KINDS["torque_curve"].plan(s.device, 0, document)
        assert plan.missing == []
        assert plan.position_to == 60 * 51_200
        assert any("inertia is not told" in line for line in plan.warnings)
        slow = s.document({"kind": "torque_curve", "velocity_max_rps": 3.0})
        assert any(
            "its speed is limited" in line for line in (await KINDS["torque_curve"].plan(s.device, 0, slow)).missing
        )


def test_a_slip_tells_the_amplitude_of_the_torque_and_a_rotor_in_step_nothing() -> None:
    """A pendulum: the field turns with a constant acceleration beyond what the rotor can follow."""
    step, field, rotor, speed, hard = 1e-4, 0.0, 0.0, 20.0, 330.0
    rows = []
    for index in range(6000):
        time = index * step
        field = 20.0 * time + hard * time**2 / 2
        speed += (300.0 * np.sin(50 * (field - rotor)) - 20.0) * step
        rotor += speed * step
        rows.append((time, field, rotor))
    time_s, field_rad, rotor_rad = np.array(rows[::10]).T
    found = pull_out(time_s, field_rad, rotor_rad, 50)
    assert found is not None
    assert found.acceleration == pytest.approx(280.0, rel=0.01)
    assert pull_out(time_s, rotor_rad + 0.01, rotor_rad, 50) is None
