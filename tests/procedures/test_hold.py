"""A rotation that nobody keeps up ends by itself; one that ended is not begun again."""

from __future__ import annotations

import asyncio

import pytest

from app.errors import OutOfRange, WrongState
from app.procedures.procedures import Procedures
from app.registers.catalog import CHIPS_32
from tests.devices.harness import bench

BOTH = pytest.mark.parametrize("model", list(CHIPS_32))


@BOTH
async def test_it_turns_for_as_long_as_it_is_kept_up(model: str) -> None:
    async with bench(model) as b:
        procedures = Procedures(b.clock)
        rotating = await procedures.rotate_held(b.device, 0, 5000, "pps", 0.5)
        for _ in range(10):
            await b.clock.advance(0.4)
            assert (await b.device.monitor.axis_state(0)).velocity_pps == pytest.approx(rotating.velocity_pps)
            assert procedures.keep_rotating(b.device, 0, 0.5) == rotating
        await b.clock.advance(0.49)
        assert (await b.device.monitor.axis_state(0)).moving
        await b.clock.advance(0.5)
        state = await b.device.monitor.axis_state(0)
        assert (state.moving, state.velocity_pps) == (False, 0)


async def test_keeping_up_behind_a_stop_moves_nothing() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        await procedures.rotate_held(b.device, 0, 5000, "pps", 1.0)
        await b.clock.advance(0.3)
        await b.device.stop(0)
        await b.clock.advance(0.3)
        with pytest.raises(WrongState, match="nothing is held"):
            procedures.keep_rotating(b.device, 0, 1.0)
        assert not (await b.device.monitor.axis_state(0)).moving


async def test_another_command_takes_over_and_is_not_stopped() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        await procedures.rotate_held(b.device, 0, 5000, "pps", 0.5)
        await b.clock.advance(0.1)
        started = await b.device.motion.move(0, 40_000)
        await b.clock.advance(3.0)
        assert (await b.device.monitor.axis_state(0)).position == started.target_position == 40_000


async def test_the_other_way_round_at_once() -> None:
    """Somebody lets one button go and presses the other before the motor stands."""
    async with bench() as b:
        procedures = Procedures(b.clock)
        await procedures.rotate_held(b.device, 0, 5000, "pps", 0.5)
        await b.clock.advance(0.1)
        await b.device.stop(0)
        await procedures.rotate_held(b.device, 0, -5000, "pps", 0.5)
        await b.clock.advance(0.4)
        assert (await b.device.monitor.axis_state(0)).velocity_pps < 0
        await b.clock.advance(1.0)
        assert not (await b.device.monitor.axis_state(0)).moving


async def test_a_rotation_that_takes_over_is_not_stopped_by_the_end_of_the_one_before() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        await procedures.rotate_held(b.device, 0, 5000, "pps", 0.5)
        await b.clock.advance(0.4)
        async with b.device.session.queue.turn():  # the link is busy beyond the time of the first
            taking_over = asyncio.create_task(procedures.rotate_held(b.device, 0, -5000, "pps", 0.5))
            await b.clock.advance(0.2)
            assert not taking_over.done()
        await b.clock.advance(0.01)
        await taking_over
        await b.clock.advance(0.4)
        assert (await b.device.monitor.axis_state(0)).velocity_pps == pytest.approx(-5000, rel=0.01)


@pytest.mark.parametrize("hold_s", [0.0, 0.05, 11.0])
async def test_how_long_is_bounded(hold_s: float) -> None:
    async with bench() as b:
        with pytest.raises(OutOfRange, match="hold_s"):
            await Procedures(b.clock).rotate_held(b.device, 0, 5000, "pps", hold_s)
        assert not (await b.device.monitor.axis_state(0)).moving
