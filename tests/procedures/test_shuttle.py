"""Back and forth until anybody wants something else."""

from __future__ import annotations

import pytest

from app.emulators.tmc428.options import EmulatorPatch
from app.errors import OutOfRange
from app.procedures.procedures import Procedures
from app.registers.catalog import CHIPS_32
from tests.devices.harness import bench

BOTH = pytest.mark.parametrize("model", list(CHIPS_32))


@BOTH
async def test_it_goes_between_the_two_positions_and_rests_there(model: str) -> None:
    async with bench(model) as b:
        procedures = Procedures(b.clock)
        assert procedures.shuttle_state(b.device, 0).running is False
        state = procedures.start_shuttle(b.device, 0, -2000, 3000, dwell_s=0.5)
        assert (state.running, state.first, state.second, state.dwell_s) == (True, -2000, 3000, 0.5)
        seen: list[int] = []
        rests = 0
        for _ in range(1000):
            await b.clock.advance(0.02)
            axis = await b.device.monitor.axis_state(0)
            seen.append(axis.position)
            rests += not axis.moving
        assert (min(seen), max(seen)) == (-2000, 3000)
        cycles = procedures.shuttle_state(b.device, 0).cycles
        assert 6 <= cycles <= 20
        assert rests * 0.02 == pytest.approx(2 * cycles * 0.5, rel=0.3)
        await procedures.cancel(b.device)


async def test_time_scale_10_is_ten_times_as_many_cycles() -> None:
    async with bench(time_scale=10.0) as b:
        procedures = Procedures(b.clock)
        procedures.start_shuttle(b.device, 0, 0, 20_000, dwell_s=0.0)
        await b.clock.advance(5.0)
        # 1.13 s of chip time a way
        assert procedures.shuttle_state(b.device, 0).cycles >= 15
        await procedures.cancel(b.device)


async def test_stopped_on_request_it_stops_the_motor() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        procedures.start_shuttle(b.device, 0, 0, 50_000)
        await b.clock.advance(1.0)
        state = await procedures.stop_shuttle(b.device, 0)
        assert (state.running, state.message) == (False, "stopped on request")
        rest = await b.at_rest()
        await b.clock.advance(3.0)
        assert (await b.device.monitor.axis_state(0)).position == rest
        assert (await procedures.stop_shuttle(b.device, 0)).running is False


@pytest.mark.parametrize("command", ["stop", "stop all", "move", "rotate", "write"])
async def test_any_other_command_ends_it(command: str) -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        procedures.start_shuttle(b.device, 0, 0, 50_000)
        await b.clock.advance(1.0)
        match command:
            case "stop":
                await b.device.stop(0)
            case "stop all":
                await b.manager.stop_all("immediate")
            case "move":
                await b.device.motion.move(0, 777)
            case "rotate":
                await b.device.motion.rotate(0, 3000)
            case _:
                await b.device.registers.write("x_target", 0, value=777)
        await b.clock.advance(0.1)
        state = procedures.shuttle_state(b.device, 0)
        assert not state.running
        assert "another command" in state.message
        await b.clock.advance(10.0)
        axis = await b.device.monitor.axis_state(0)
        if command in ("move", "write"):
            assert axis.position == 777
        assert axis.moving == (command == "rotate")


async def test_reading_and_other_axes_do_not_end_it() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        procedures.start_shuttle(b.device, 0, 0, 5000)
        await b.clock.advance(0.3)
        await b.device.registers.read_all()
        await b.device.motion.move(1, 100)
        await b.device.registers.write("clk2_div", value=9)
        await b.clock.advance(5.0)
        assert procedures.shuttle_state(b.device, 0).running
        await procedures.cancel(b.device)


async def test_a_switch_in_the_way_ends_it_with_the_reason() -> None:
    async with bench(stops=True, stages=[{"start_fullsteps": 10.0}]) as b:
        procedures = Procedures(b.clock)
        procedures.start_shuttle(b.device, 0, 0, -20_000)
        await b.clock.advance(5.0)
        state = procedures.shuttle_state(b.device, 0)
        assert not state.running
        assert "stands at" in state.message


async def test_a_chip_that_loses_its_power_ends_it() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        procedures.start_shuttle(b.device, 0, 0, 50_000)
        await b.clock.advance(1.0)
        b.wire.patch(EmulatorPatch(power_cycle=True))
        await b.clock.advance(5.0)
        state = procedures.shuttle_state(b.device, 0)
        assert not state.running
        assert state.message


async def test_a_removed_device_ends_it() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        procedures.start_shuttle(b.device, 0, 0, 50_000)
        await b.clock.advance(1.0)
        await b.manager.remove("bench")
        await b.clock.advance(5.0)
        assert not procedures.shuttle_state(b.device, 0).running


async def test_what_is_no_shuttle() -> None:
    async with bench() as b:
        procedures = Procedures(b.clock)
        with pytest.raises(OutOfRange):
            procedures.start_shuttle(b.device, 0, 5, 5)
        with pytest.raises(OutOfRange):
            procedures.start_shuttle(b.device, 0, 0, 5, dwell_s=-1.0)
        procedures.start_shuttle(b.device, 0, 0, 1 << 23)
        await b.clock.advance(5.0)
        assert "allowed is" in procedures.shuttle_state(b.device, 0).message
