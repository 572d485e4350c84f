"""The watch over the range of positions: an axis is stopped before it leaves it, whatever set it in motion."""

from __future__ import annotations

import pytest

from app.clock import VirtualClock
from app.devices.core.axis_limits import AxisLimits
from app.devices.core.capabilities import PositionSetting
from app.devices.limits.watch import IDLE_S, POLL_S, REACTION_S
from app.errors import SoftLimit
from app.links import datagram32, datagram40
from app.links.tmcl import Request
from app.procedures.procedures import Procedures
from app.registers.tmcl.commands import Opcode
from app.registers.tmcl.modules import MODULES
from tests.devices.limits.harness import Bench, bench
from tests.devices.limits.setup import MOVERS, SPEED_PPS, module_ramp, set_up

RANGE = AxisLimits(position_min=-9_000, position_max=12_000)
BEFORE = SPEED_PPS * (2 * POLL_S + REACTION_S) + 64
"""How far before its limit an axis at full speed may stop: the bound that `limits.watch` states, and some rounding."""


@pytest.fixture(params=MOVERS)
def model(request: pytest.FixtureRequest) -> str:
    found = request.param
    assert isinstance(found, str)
    return found


async def rotating_into(made: Bench, velocity: float) -> tuple[int, int, int]:
    """Least, greatest and last position on the way."""
    await made.device.motion.rotate(0, velocity)
    least, greatest = await made.farthest(3.0 if abs(velocity) > 10_000 else 8.0)
    state = await made.device.monitor.axis_state(0)
    assert not state.moving
    return least, greatest, state.position


@pytest.mark.parametrize("velocity", [SPEED_PPS * 0.999, 3_000.0, 150.0])
async def test_a_rotation_is_stopped_before_either_end(model: str, velocity: float) -> None:
    async with bench(model) as made:
        await set_up(made.device)
        await made.limit(RANGE)
        if velocity == 150.0:
            await made.device.motion.move(0, 11_900)
            await made.farthest(2.0)
        _, greatest, last = await rotating_into(made, velocity)
        assert RANGE.position_max is not None
        assert RANGE.position_min is not None
        assert greatest <= RANGE.position_max
        assert last >= RANGE.position_max - BEFORE * (3 if model == "tmc4361" else 1)
        assert [(event.name, event.limit) for event in made.reached] == [("position_max", 12_000)]
        if velocity > 1_000:
            least, _, last = await rotating_into(made, -velocity)
            assert least >= RANGE.position_min
            if velocity > 10_000:
                assert last <= RANGE.position_min + BEFORE * (3 if model == "tmc4361" else 1)


async def test_at_the_end_only_the_way_back_is_open(model: str) -> None:
    async with bench(model) as made:
        await set_up(made.device)
        await made.limit(RANGE)
        await made.device.motion.move(0, 12_000)
        await made.farthest(2.0)
        with pytest.raises(SoftLimit) as refusal:
            await made.device.motion.rotate(0, 500)
        assert (refusal.value.quantity, refusal.value.limit) == ("position", 12_000)
        await made.device.motion.rotate(0, -500)
        await made.clock.advance(0.5)
        assert (await made.device.monitor.axis_state(0)).position < 11_900


async def test_moves_to_the_very_ends_are_left_alone(model: str) -> None:
    async with bench(model) as made:
        await set_up(made.device)
        await made.limit(RANGE)
        for target in (12_000, -9_000, 12_000):
            await made.device.motion.move(0, target)
            await made.farthest(3.0, step_s=0.05)
            assert (await made.device.monitor.axis_state(0)).position == target
        assert made.reached == []


async def test_a_rotation_that_turns_round_is_watched_that_way_too(model: str) -> None:
    async with bench(model) as made:
        await set_up(made.device)
        await made.limit(AxisLimits(position_max=6_000))
        await made.device.motion.rotate(0, -SPEED_PPS * 0.99)
        await made.clock.advance(0.3)
        await made.device.motion.rotate(0, SPEED_PPS * 0.99)
        assert (await made.farthest(3.0))[1] <= 6_000


@pytest.mark.parametrize("model", ["tmc428", "tmc5160", "tmc4361"])
async def test_a_rotation_by_raw_frames_is_stopped_too(model: str) -> None:
    async with bench(model) as made:
        await set_up(made.device)
        await made.limit(RANGE)
        device = made.device
        if model == "tmc428":
            frames = [datagram32.write(0x0A, 2), datagram32.write(0x04, 1300)]
        elif model == "tmc5160":
            frames = [datagram40.write(0x20, 1)]
        else:
            frames = [datagram40.write(0x20, 2)]
        for frame in frames:
            await device.raw.exchange(frame)
        assert (await made.farthest(3.0))[1] <= 12_000
        assert made.reached


@pytest.mark.parametrize("model", ["tmc5160", "pd42-1241", "tmcm-1161"])
async def test_a_motion_that_nobody_here_began_is_noticed_in_time(model: str) -> None:
    """As by another master, or a program of a module: the chip is written to past the driver."""
    async with bench(model) as made:
        await set_up(made.device)
        await made.limit(RANGE)
        await made.clock.advance(IDLE_S * 1.1)
        fast = module_ramp(model, 20_000.0, 1.0, 1.0)["ap4"] if model in MODULES else 0
        rotation = datagram40.write(0x20, 1) if model == "tmc5160" else Request(1, Opcode.ROR, 0, 0, fast).encode()
        made.port.wire.exchange(rotation, made.clock.now())
        assert (await made.farthest(3.0))[1] <= 12_000
        assert made.reached


async def test_a_search_ends_at_the_limit_and_says_so() -> None:
    for model in ("tmc428", "tmc5160", "pd42-1241", "tmcm-1161"):
        async with bench(model) as made:
            await set_up(made.device)
            await made.limit(AxisLimits(position_min=-3_000, position_max=3_000))
            procedures = Procedures(made.clock)
            if model in MODULES:
                procedures.start_search(made.device, 0, mode=1, search_speed_pps=4_000, switch_speed_pps=500)
            else:
                procedures.start_search(made.device, 0, "left", 4_000)
            least, _ = await made.farthest(4.0)
            assert least >= -3_000
            state = procedures.search_state(made.device, 0)
            assert state.state == "aborted"
            assert "position_min -3000, its soft limit" in state.message
            await procedures.close()


async def test_a_search_and_a_shuttle_that_lead_out_do_not_begin() -> None:
    async with bench("tmc428") as made:
        await set_up(made.device)
        await made.device.need(PositionSetting).set_position(0, 500)
        await made.limit(AxisLimits(position_min=100, position_max=3_000))
        procedures = Procedures(made.clock)
        with pytest.raises(SoftLimit, match="reference 0"):
            procedures.start_search(made.device, 0, "left")
        with pytest.raises(SoftLimit):
            procedures.start_shuttle(made.device, 0, 200, 3_001)
        await procedures.close()


async def test_the_watch_ends_with_its_device_and_with_its_limits() -> None:
    async with bench("tmc428") as made:
        await set_up(made.device)
        await made.limit(RANGE)
        await made.clock.advance(1.0)
        made.port.frames.clear()
        await made.clock.advance(IDLE_S * 2)
        assert made.port.frames  # it looks
        await made.limit(AxisLimits(velocity_max_pps=1e5))
        await made.clock.advance(0.01)
        made.port.frames.clear()
        await made.clock.advance(IDLE_S * 3)
        assert made.port.frames == []
        await made.limit(RANGE)
        await made.manager.disconnect(made.device.id)
        made.port.frames.clear()
        await made.clock.advance(IDLE_S * 3)
        assert made.port.frames == []


async def test_on_a_fast_emulator_the_limit_is_kept_too() -> None:
    async with bench("tmc5160", time_scale=4) as made:
        await set_up(made.device)
        await made.limit(RANGE)
        assert isinstance(made.clock, VirtualClock)
        await made.device.motion.rotate(0, SPEED_PPS * 0.99)
        assert (await made.farthest(2.0, step_s=0.005))[1] <= 12_000
