"""What ended a motion, and when: from telemetry, from looks, and over a link that fails meanwhile."""

from __future__ import annotations

import pytest

from app.devices.core.events import DeviceEvent
from app.devices.core.results import MotionEnd
from tests.devices.tmcl.harness import Bench, bench


async def _ended(b: Bench, within_s: float = 10.0) -> MotionEnd:
    """The next end of a motion."""
    before = len(b.device.monitor.motion_ends(0))
    for _ in range(int(within_s / 0.05)):
        await b.clock.advance(0.05)
        if len(b.device.monitor.motion_ends(0)) > before:
            return b.device.monitor.motion_ends(0)[-1]
    raise AssertionError(f"no motion ended within {within_s} s")


async def test_arrival_and_stop_are_told_once_each() -> None:
    async with bench() as b:
        told: list[DeviceEvent] = []
        b.device.listen(told.append)
        await b.device.motion.move(0, 10_000)
        assert ((end := await _ended(b)).reason, end.position) == ("target_reached", 10_000)
        await b.device.motion.rotate(0, 20_000)
        await b.clock.advance(1.0)
        await b.device.stop(0)
        assert (await _ended(b)).reason == "stop_command"
        await b.clock.advance(3.0)
        ends = [event for event in told if isinstance(event, MotionEnd)]
        assert [end.reason for end in ends] == ["target_reached", "stop_command"]
        assert list(b.device.monitor.motion_ends(0)) == ends


@pytest.mark.parametrize(("side", "velocity"), [("left", -20_000.0), ("right", 20_000.0)])
@pytest.mark.sheet("FM-PD42-1241", "3.6.1")
async def test_a_stop_switch_is_named(side: str, velocity: float) -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, velocity)
        await b.clock.advance(1.0)
        b.patch(switches={side: True})
        assert (await _ended(b)).reason == f"{side}_switch"
        assert b.device.motion.prediction(0) is None


@pytest.mark.sheet("FM-PD42-1241", "6.2")
async def test_a_blocked_shaft_ends_in_a_deviation() -> None:
    async with bench() as b:
        await b.device.registers.write("ap212", 0, 1000)
        await b.device.motion.move(0, 100_000)
        await b.clock.advance(0.5)
        b.patch(blocked=True)
        end = await _ended(b)
        assert end.reason == "deviation"
        assert (await b.device.monitor.axis_state(0)).flags["deviation_stop"]


async def test_a_motion_that_somebody_else_began_is_noticed() -> None:
    async with bench() as b:
        b.module.receive(bytes.fromhex("01 04 00 00 00 00 C3 50 18"), b.module.clock.now())
        await b.clock.advance(0.5)
        assert (await b.device.monitor.axis_state(0)).moving
        end = await _ended(b)
        assert (end.reason, end.position) == ("target_reached", 50_000)


async def test_a_pause_between_two_legs_is_no_end() -> None:
    async with bench() as b:
        await b.device.registers.write("ramp_wait_time", 0, 31_250)  # 1 s
        await b.device.motion.rotate(0, 20_000)
        await b.clock.advance(1.0)
        await b.device.motion.move(0, 0)
        end = await _ended(b)
        assert (end.reason, end.position) == ("target_reached", 0)


async def test_a_link_lost_on_the_way_is_told_and_no_rest_is_made_up() -> None:
    async with bench() as b:
        await b.device.motion.move(0, 200_000)
        await b.clock.advance(1.0)
        b.patch(faults={"unplugged": True})
        end = await _ended(b)
        assert (end.reason, end.position) == ("lost_link", None)
        assert b.device.motion.prediction(0) is None
        await b.clock.advance(1.0)
        b.patch(faults={"unplugged": False})
        end = await _ended(b)
        assert (end.reason, end.position) == ("target_reached", 200_000)


async def test_the_latest_two_hundred_are_kept() -> None:
    async with bench() as b:
        for turn in range(203):
            await b.device.motion.move(0, 10 * (turn % 2) + 5)
            await b.clock.advance(0.2)
        assert len(b.device.monitor.motion_ends(0)) == 200
