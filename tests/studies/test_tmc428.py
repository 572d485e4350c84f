"""Studies of a TMC428 without any encoder: what v_max, a_max and the pair that fits may be, seen by a switch alone."""

from __future__ import annotations

import math
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import pytest

from app.calc.motor_torque import StepperMotor
from app.devices.core.device import Device
from app.devices.tmc428.start_up import AxisStart, start_up
from app.emulators.tmc428.device import EmulatedDevice
from app.links.emulator import EmulatorPort
from app.profiles.capture import read_held
from app.studies.families import ramp_of
from app.studies.kinds import KINDS
from app.studies.ramp_settings import RampSpace, held_of
from app.studies.store import StudyStore
from tests.devices.harness import START as STARTED
from tests.devices.harness import bench as controller
from tests.devices.test_cover import Bench, bench
from tests.studies.harness import Studied

MICROSTEPS = 64
MOVE: dict[str, Any] = {"kind": "fastest_move", "distance": 50 * MICROSTEPS, "repeats": 1, "seen_by": "left switch"}
TORQUE: dict[str, Any] = {
    "kind": "torque_curve",
    "seen_by": "left switch",
    "travel_turns": 200.0,
    "speeds": 2,
    "repeats": 2,
    "inertia_share": 0.0,
}
START = AxisStart(v_max=200, a_max=60, pulse_div=3, ramp_div=6, stops=True)
DRIVERS: tuple[dict[str, Any], ...] = (
    {"driver": "tmc2660", "load": {"inertia_kgm2": 1e-3, "friction_nm": 0.05}},
    *[{"driver": "tmc236"}] * 2,
)
STAGE = {"left_at_fullsteps": 0.0, "right_at_fullsteps": 700.0, "start_fullsteps": 20.4}


@dataclass
class Controlled:
    """The controller of a bench as the device that is studied."""

    b: Bench

    @property
    def device(self) -> Device:
        return self.b.controller

    @property
    def clock(self) -> Any:
        return self.b.clock

    @property
    def rotor_fullsteps(self) -> float:
        """The ground truth, which no study sees."""
        wire = cast("EmulatedDevice", cast("EmulatorPort", self.device.session.port).wire)
        return wire.state().axes[0].position_fullsteps


@asynccontextmanager
async def studied(
    folder: Path,
    first: dict[str, Any] = DRIVERS[0],
    stage: dict[str, float] = STAGE,
    start: AxisStart = START,
) -> AsyncIterator[tuple[Studied, Controlled]]:
    drivers = (first, *DRIVERS[1:])
    async with bench(drivers, stages=[stage]) as b:
        driver = await b.driver(0)
        await b.set_up(driver)
        await b.during(driver.registers.write("SGCSCONF", None, fields={"CS": 15}))
        await b.during(start_up(b.controller, [start] * 3, [each["driver"] for each in drivers]))
        made = Controlled(b)
        s = Studied(made, StudyStore(folder, aside=False))
        try:
            yield s, made
        finally:
            await s.passing(s.procedures.close())


async def test_a_faster_ramp_with_its_pair_is_found_by_the_switch(tmp_path: Path) -> None:
    async with studied(tmp_path) as (s, made):
        before = dict((await read_held(s.device)).words)
        start = made.rotor_fullsteps
        plan = await KINDS["fastest_move"].plan(s.device, 0, s.document(MOVE))
        assert plan.missing == []
        assert "pmul_pdiv of axis 0" in plan.registers
        record = await s.finish(s.begin(s.document(MOVE, budget={"trials": 5})))
        assert (record.state, record.improved, record.left) == ("done", True, []), record.message
        assert dict((await read_held(s.device)).words) == before
        assert any(trial.state == "infeasible" and trial.figures.lost_fullsteps for trial in record.trials)
        # less than a period off: a rotor that stood beside its field fell into step with the first move
        assert made.rotor_fullsteps == pytest.approx(start, abs=2.0)


async def test_ramps_tell_the_torque_by_the_switch_of_a_controller_that_reads_no_encoder(tmp_path: Path) -> None:
    inertia = 1e-3
    driver = {"driver": "tmc2660", "supply_v": 36.0, "load": {"inertia_kgm2": inertia, "friction_nm": 0.02}}
    stage = {**STAGE, "right_at_fullsteps": 1e6, "ref_from_fullsteps": 9e5, "ref_to_fullsteps": 9.1e5}
    async with studied(tmp_path, driver, stage, replace(START, v_max=100, a_max=15, pulse_div=2, ramp_div=5)) as (
        s,
        made,
    ):
        study = {**TORQUE, "inertia_kgm2": inertia}
        assert (await KINDS["torque_curve"].plan(s.device, 0, s.document(study))).missing == []
        record = await s.finish(s.begin(s.document(study, budget={"time_s": 7200.0})), 7200)
        assert (record.state, record.left, record.next) == ("done", [], ""), record.message
        assert record.torque is not None
        assert len(record.torque.points) == 2
        # Half of the 3.1 A that its driver is made for; the axis has 0.02 N m of friction beside the motor's own.
        motor = StepperMotor(supply_v=36.0, current_a=1.55)
        for point in record.torque.points:
            friction = 0.025 + 1e-3 * point.speed_rps * 2 * math.pi
            expected = float(motor.available_nm(point.speed_rps * 51_200)) - friction
            assert point.torque_nm == pytest.approx(expected, rel=0.1)
        assert made.rotor_fullsteps == pytest.approx(stage["start_fullsteps"], abs=2.0)


@pytest.mark.parametrize(("model", "reduction"), [("tmc428", 0.05), ("tmc429", 0.01), ("tmc4210", 0.01)])
async def test_each_acceleration_that_may_be_tried_has_its_pair(model: str, reduction: float) -> None:
    async with controller(model, started=True) as b:
        space = RampSpace(b.device, 0, ramp_of(b.device), await held_of(b.device))
        one = space.most("acceleration") / 2047
        for a_max in (2, 10, 100, 777, 2047):
            words = {each.name.lower(): each.value for each in space.registers({"acceleration": a_max * one})}
            assert words["a_max"] == a_max
            p = (128 + (words["pmul_pdiv"] >> 8 & 0x7F)) / 2 ** (3 + (words["pmul_pdiv"] & 0xF))
            ideal = a_max / (128 * 2.0 ** (STARTED.ramp_div - STARTED.pulse_div))
            assert (1 - reduction) * (1 - 1 / 128) * ideal <= p <= (1 - reduction) * ideal


async def test_where_the_dividers_end_the_search_the_plan_says_so(tmp_path: Path) -> None:
    async with studied(tmp_path) as (s, _):
        for v_max, said in ((START.v_max, False), (1000, True)):
            await s.passing(_write(s, "v_max", v_max))
            plan = await KINDS["fastest_move"].plan(s.device, 0, s.document(MOVE))
            assert any("speed ends at 62469 pps" in line for line in plan.warnings) == said, plan.warnings


async def _write(s: Studied, name: str, value: int) -> None:
    await s.device.registers.write(name, 0, value)


async def test_a_study_that_needs_an_encoder_says_so(tmp_path: Path) -> None:
    async with studied(tmp_path) as (s, _):
        plan = await KINDS["fastest_move"].plan(s.device, 0, s.document({**MOVE, "seen_by": "encoder"}))
        assert any("encoder" in line for line in plan.missing)
