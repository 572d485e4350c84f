"""Torque over speed without an encoder: the edge of a switch tells which ramps have lost steps."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.calc.motor_torque import StepperMotor
from app.emulators.tmc5xxx.options import Tmc5xxxPatch
from app.studies.kinds import KINDS
from app.studies.report import html_of
from tests.studies.harness import Studied, studied
from tests.studies.test_torque_curve import FULL, INERTIA, LOAD, MOTOR, NAMES, PLANT, QUICK

BLIND = replace(FULL, counts_per_rev=0)
SIDES: dict[str, dict[str, Any]] = {
    "left": {"left_at_fullsteps": -21.3, "right_at_fullsteps": 1e6},
    "right": {"left_at_fullsteps": -1e6, "right_at_fullsteps": 17.7},
}
BUDGET = {"time_s": 7200.0}


def plant(side: str, **more: Any) -> dict[str, Any]:
    return {**PLANT, "stage": SIDES[side], **more}


def wish(s: Studied, side: str, **more: Any) -> Any:
    return s.document({**QUICK, "seen_by": f"{side} switch", **more}, budget=BUDGET)


def rotor_fullsteps(s: Studied) -> float:
    """The ground truth, which no study sees."""
    return float(s.b.wire.state().axes[0].truth.rotor_fullsteps)


@pytest.mark.parametrize("side", SIDES)
async def test_ramps_between_which_steps_are_lost_tell_the_torque(tmp_path: Path, side: str) -> None:
    async with studied(tmp_path, BLIND, **plant(side)) as s:
        before = await s.settings(*NAMES)
        record = await s.finish(s.begin(wish(s, side)), 7200)
        found = record.torque
        assert (record.state, record.left, record.next) == ("done", [], ""), record.message
        assert found is not None
        assert len(found.points) == 2
        for point in found.points:
            motor = StepperMotor(supply_v=36.0)
            friction = 0.025 + 1e-3 * point.speed_rps * 2 * np.pi
            expected = float(motor.available_nm(point.speed_rps * 51_200)) - friction
            assert point.torque_nm == pytest.approx(expected, rel=0.08)
            assert point.interval_nm is not None
            assert point.interval_nm.low < expected < point.interval_nm.high
            assert point.both_ways_radps2 is None
            assert point.slips >= 1
        assert found.margin is not None
        assert await s.settings(*NAMES) == before
        # whatever was lost on the way, the counter is right again
        assert (await s.b.state()).position == 0
        assert rotor_fullsteps(s) == pytest.approx(0.0, abs=1.0)
        assert "Torque over speed" in html_of(record)


async def test_an_axis_too_light_to_lose_steps_is_told_what_it_has_at_least(tmp_path: Path) -> None:
    async with studied(tmp_path, BLIND, **plant("left", load={"inertia_kgm2": 1.5e-4})) as s:
        record = await s.finish(s.begin(wish(s, "left", inertia_kgm2=None)), 7200)
        assert record.state == "done", record.message
        assert "no step is lost at the greatest acceleration" in record.verdict


async def test_the_plan_tells_where_it_goes_and_what_keeps_it_from_it(tmp_path: Path) -> None:
    plan = KINDS["torque_curve"].plan
    async with studied(tmp_path / "right", BLIND, **plant("right")) as s:
        told = await plan(s.device, 0, wish(s, "right"))
        assert told.missing == []
        assert (told.position_from, told.position_to) == (-200 * 51_200, 2 * 51_200)
        assert any("right switch" in step for step in told.steps)
        blind = await plan(s.device, 0, s.document(QUICK))
        assert any("encoder" in line for line in blind.missing)
    async with studied(tmp_path / "pressed", BLIND, **{**plant("left"), "stage": {"left_at_fullsteps": 3.0}}) as s:
        told = await plan(s.device, 0, wish(s, "left"))
        assert any("left switch is pressed" in line for line in told.missing)


async def test_a_stop_puts_the_ramp_back_and_says_that_steps_may_be_lost(tmp_path: Path) -> None:
    async with studied(tmp_path, BLIND, **plant("left")) as s:
        before, run = await s.settings(*NAMES), s.begin(wish(s, "left"))
        while run.record.runs < 6:
            await s.clock.advance(0.05)
            assert run.running, run.record.message
        await s.clock.advance(0.3)
        await s.device.stop_axes([0], "immediate")
        record = await s.finish(run, 60)
        assert (record.state, record.left) == ("aborted", [])
        assert "search the reference" in record.next
        assert await s.settings(*NAMES) == before


async def test_where_an_acceleration_cannot_set_in_by_parts_no_torque_is_claimed(tmp_path: Path) -> None:
    """An emulator at twenty times real time: the speed is there before the last part of its acceleration is set."""
    async with studied(tmp_path, BLIND, **plant("left")) as s:
        s.b.patch(Tmc5xxxPatch(time_scale=20.0))
        record = await s.finish(s.begin(wish(s, "left")), 7200)
        assert record.state == "failed"
        assert "the link is too slow for so light a load" in record.message
        assert record.torque is not None
        assert record.torque.points == []


async def test_with_little_room_it_looks_as_fast_as_that_allows_and_says_so(tmp_path: Path) -> None:
    async with studied(tmp_path, BLIND, **plant("left")) as s:
        record = await s.finish(s.begin(wish(s, "left", travel_turns=12.0)), 7200)
        assert record.state == "done", record.message
        assert record.torque is not None
        assert 5 < max(point.speed_rps for point in record.torque.points) < 8
        assert record.next.startswith("more travel: to ")
        record = await s.finish(s.begin(wish(s, "left", travel_turns=10.0)), 7200)
        assert record.state == "failed"
        assert "more travel, or a higher greatest speed" in record.message


async def test_a_load_too_heavy_for_a_switch_that_stops_it_at_once_is_told(tmp_path: Path) -> None:
    """It lost steps as its edge was learnt: the study went on with a counter that was 40 full steps off."""
    heavy = {**LOAD, "inertia_kgm2": 8 * INERTIA}
    async with studied(tmp_path, BLIND, **plant("left", load=heavy, motor=MOTOR)) as s:
        record = await s.finish(s.begin(wish(s, "left")), 7200)
        assert record.state == "failed"
        assert "the left switch stops so heavy a load at once" in record.message
