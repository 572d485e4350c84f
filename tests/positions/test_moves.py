"""Moves beyond the counter on the real drivers and emulators of every family, and everything that ends them."""

from __future__ import annotations

import pytest

from app.devices.core.events import DeviceEvent, MotionCommanded
from app.errors import UsageError, WrongState
from tests.positions.harness import FAMILIES, bench

NEAR = 3000
"""How far from its end a counter stands at the beginning [microsteps]."""
FAST = ("tmc428", "tmc4210", "tmc5160")
"""Emulators that go round their counter within a moment."""


def commands(told: list[DeviceEvent]) -> int:
    return sum(isinstance(event, MotionCommanded) for event in told)


@pytest.mark.sheet("AN-001", "2.1")
@pytest.mark.parametrize("model", FAMILIES)
@pytest.mark.parametrize("way", [1, -1])
async def test_a_move_goes_on_over_the_counter_s_end(model: str, way: int) -> None:
    async with bench(model) as b:
        start = await b.stand(way * (b.half - NEAR))
        await b.service.go_to(b.device, 0, start + way * 3 * NEAR)
        arrived = await b.arrived(30)
        assert (arrived.state, arrived.message) == ("idle", "at its target")
        assert arrived.actual == start + way * 3 * NEAR
        assert (await b.device.monitor.axis_state(0)).position == arrived.counter == -way * (b.half - 2 * NEAR)
        await b.service.go_to(b.device, 0, start)
        assert (await b.arrived(30)).actual == start


@pytest.mark.sheet("AN-001", "2.1")
@pytest.mark.sheet("AN-001", "2.2")
@pytest.mark.parametrize("model", FAST)
async def test_a_move_of_many_pieces_ends_at_its_target(model: str) -> None:
    """Nobody looks but the service, and the counter wraps on the way."""
    async with bench(model) as b:
        start = await b.stand(NEAR - b.half)
        target = start - int(0.6 * b.whole) - 7
        await b.service.go_to(b.device, 0, target)
        seen = []
        piece_s = b.whole / 4 / b.device.motion.speed_limit_pps(0)
        while (state := await b.arrived_within(piece_s / 8)).state == "moving":
            assert state.pieces is not None
            assert state.progress is not None
            assert state.actual is not None
            seen.append((state.pieces.done, state.progress))
            assert state.pieces.total == 3
        assert seen == sorted(seen)
        assert {done for done, _ in seen} == {0, 1, 2}
        assert (state.state, state.actual, state.progress) == ("idle", target, 1.0)
        assert state.pieces is not None
        assert state.pieces.done == 3
        moved = commands(b.told)
        await b.clock.advance(100)
        assert commands(b.told) == moved


@pytest.mark.parametrize("model", FAMILIES)
@pytest.mark.parametrize("how", ["stop", "rotate", "move", "write", "by hand"])
async def test_whatever_else_commands_the_axis_ends_the_move_for_good(model: str, how: str) -> None:
    async with bench(model) as b:
        await b.service.go_to(b.device, 0, 10 * b.whole)
        await b.clock.advance(1)
        assert b.seen().state == "moving"
        match how:
            case "stop":
                await b.device.stop(0)
            case "rotate":
                await b.device.motion.rotate(0, -1000)
            case "move":
                await b.device.motion.move(0, -500)
            case "write":
                await b.write_target(-500)
            case "by hand":
                await b.device.raw.exchange(b.frame_of_target(-500))
        state = b.seen()
        assert (state.state, state.target) == ("idle", 10 * b.whole)
        assert "another command" in state.message
        commanded = commands(b.told)
        await b.clock.advance(25)
        assert commands(b.told) == commanded
        assert state.trusted


@pytest.mark.parametrize("model", FAMILIES)
async def test_a_stop_that_comes_while_the_target_is_moved_on_wins(model: str) -> None:
    async with bench(model) as b:
        await b.service.go_to(b.device, 0, 10 * b.whole)
        await b.clock.advance(1)
        move = b.watched().move
        assert move is not None
        target = await b.target()
        move.written = 0  # as if the target had to be moved on now
        b.stop_within_the_next_retarget()
        await b.watched().serve()
        assert b.stopped is not None
        assert (await b.stopped)[0].ok
        assert "another command to this axis: stop" in b.seen().message
        await b.clock.advance(25)
        assert await b.target() == target
        assert not (await b.device.monitor.axis_state(0)).moving


@pytest.mark.parametrize("model", FAMILIES)
async def test_a_lost_link_ends_the_move_and_nothing_is_sent_again(model: str) -> None:
    async with bench(model) as b:
        await b.service.go_to(b.device, 0, 10 * b.whole)
        await b.clock.advance(1)
        b.patch(faults={"unplugged": True})
        await b.clock.advance(3)
        state = b.seen()
        assert (state.state, state.trusted) == ("lost", False)
        assert "the link failed" in state.reason
        assert "connect the device" in state.way_out
        assert "nothing is sent again" in state.message
        b.told.clear()
        b.patch(faults={"unplugged": False})
        await b.clock.advance(5)
        assert b.device.state == "connected"
        state = b.seen()
        assert (state.state, state.trusted, state.reason) == ("idle", True, "")
        assert commands(b.told) == 0
        await b.device.stop(0)
        await b.clock.advance(10)
        state = await b.state()
        assert state.actual == (await b.device.monitor.axis_state(0)).position


@pytest.mark.parametrize("model", FAST)
async def test_two_targets_in_a_row_and_back(model: str) -> None:
    async with bench(model) as b:
        await b.service.go_to(b.device, 0, b.whole // 2)
        await b.clock.advance(2)
        await b.service.go_to(b.device, 0, -b.whole // 64)
        assert b.seen().state == "moving"
        arrived = await b.arrived(400)
        assert (arrived.actual, arrived.message) == (-b.whole // 64, "at its target")


async def test_a_switch_that_stops_the_motor_is_told_and_nothing_is_sent_again() -> None:
    async with bench("tmc5160") as b:
        await b.device.registers.write("SW_MODE", 0, fields={"stop_r_enable": 1})
        await b.service.go_to(b.device, 0, 10 * b.whole)
        await b.clock.advance(1)
        b.patch(axes=[{"axis": 0, "switches": {"right": True}}])
        state = await b.until(lambda state: state.state != "moving", 60)
        assert state.state == "idle"
        assert state.message.startswith("the motor stands short of its target: the right switch is active")


async def test_an_axis_that_cannot_move_says_so_and_watches_on() -> None:
    async with bench("tmc428", set_up=False) as b:
        with pytest.raises(WrongState, match="v_max is 0"):
            await b.service.go_to(b.device, 0, 1 << 40)
        state = await b.state()
        assert (state.watching, state.state, state.trusted) == (True, "idle", True)
        assert "v_max is 0" in state.message


async def test_positions_are_64_bits() -> None:
    async with bench("tmc428") as b:
        with pytest.raises(UsageError, match="a position is"):
            await b.service.go_to(b.device, 0, 1 << 63)
        await b.service.set_actual(b.device, 0, (1 << 63) - 1)
        assert (await b.state()).actual == (1 << 63) - 1
        with pytest.raises(WrongState, match="has no turn"):
            await b.service.go_turns(b.device, 0, 1)


@pytest.mark.parametrize("model", ["tmc5062", "tmc428"])
async def test_two_axes_go_their_own_ways(model: str) -> None:
    async with bench(model) as b:
        await b.service.go_to(b.device, 0, b.whole // 3)
        await b.service.go_to(b.device, 1, -b.whole // 2)
        first = await b.arrived(500)
        assert first.actual == b.whole // 3
        assert b.seen(1).state == "moving"
        await b.device.stop(0)
        assert b.seen(1).state == "moving"
        second = await b.arrived(500, axis=1)
        assert second.actual == -b.whole // 2
        assert b.seen(0).actual == b.whole // 3


async def test_an_end_of_the_watch_stops_the_move() -> None:
    async with bench("tmc428") as b:
        await b.service.go_to(b.device, 0, 10 * b.whole)
        await b.clock.advance(1)
        await b.service.unwatch(b.device, 0)
        await b.clock.advance(10)
        assert not (await b.device.monitor.axis_state(0)).moving
        assert (await b.state()).watching is False
        assert b.service.saved() == []
