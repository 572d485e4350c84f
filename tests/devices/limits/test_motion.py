"""Moves, rotations and stops within soft limits, of every family."""

from __future__ import annotations

import pytest

from app.devices.core.axis_limits import AxisLimits
from app.devices.core.device import Device
from app.devices.core.results import AxisMove, WriteItem
from app.devices.manager import DeviceChange
from app.errors import SoftLimit
from app.registers.catalog import CHIPS_32
from app.registers.tmcl.modules import MODULES
from tests.devices.limits.harness import Bench, bench
from tests.devices.limits.setup import MOVERS, set_up

RANGE = AxisLimits(position_min=-5_000, position_max=8_000)


@pytest.fixture(params=MOVERS)
def model(request: pytest.FixtureRequest) -> str:
    found = request.param
    assert isinstance(found, str)
    return found


def writes_to(made: Bench) -> list[bytes]:
    """Frames that have reached the chip and changed something."""
    return [frame for frame in made.port.frames if _writes(made.device, frame)]


def _writes(device: Device, frame: bytes) -> bool:
    if device.model in CHIPS_32:
        return not frame[0] & 1
    if device.model in MODULES:
        return frame[1] not in (6, 10, 31, 136, 13)
    # EVENT_CLEAR_CONF of a TMC4361 is written around a reading of its events, so that this does not clear them.
    return bool(frame[0] & 0x80) and not (device.model == "tmc4361" and frame[0] == 0x8C)


async def test_a_target_outside_is_refused_before_anything_is_sent(model: str) -> None:
    async with bench(model) as made:
        await set_up(made.device)
        await made.limit(RANGE)
        made.port.frames.clear()
        commands = made.device.session.motion_commands[0]
        for target, relative in ((8_001, False), (-5_001, False), (8_001, True)):
            with pytest.raises(SoftLimit) as refusal:
                await made.device.motion.move(0, target, relative=relative)
            assert (refusal.value.quantity, refusal.value.axis) == ("position", 0)
            assert refusal.value.wanted == target
            assert refusal.value.limit in (8_000, -5_000)
        assert writes_to(made) == []
        assert made.device.session.motion_commands[0] == commands  # nobody was told to let go of the axis
        await made.device.motion.move(0, 8_000)
        assert (await made.farthest(2.0))[1] <= 8_002


async def test_a_speed_beyond_is_refused_and_one_at_the_limit_goes(model: str) -> None:
    async with bench(model) as made:
        await set_up(made.device)
        await made.limit(AxisLimits(velocity_max_pps=19_005.0))
        with pytest.raises(SoftLimit) as refusal:
            await made.device.motion.rotate(0, 19_006)
        assert (refusal.value.quantity, refusal.value.limit, refusal.value.unit) == ("velocity", 19_005.0, "pps")
        for velocity in (19_005, -19_005):
            rotating = await made.device.motion.rotate(0, velocity)
            assert abs(rotating.velocity_pps) <= 19_005 * (1 + 1e-9)  # rounded towards the limit, not over it
            assert abs(rotating.velocity_pps) == pytest.approx(19_005, rel=2e-3)


async def test_what_is_set_beyond_a_new_limit_is_told_stays_and_starts_nothing(model: str) -> None:
    async with bench(model) as made:
        await set_up(made.device)
        await made.limit(AxisLimits(velocity_max_pps=5_000.0, acceleration_max_pps2=60_000.0))
        told = made.device.limit_warnings(0)
        assert any("above the limit of 5000 pps" in text and "write" in text for text in told)
        assert any("above the limit of 60000 pps^2" in text for text in told)
        made.port.frames.clear()
        with pytest.raises(SoftLimit):
            await made.device.motion.move(0, 1_000)
        assert writes_to(made) == []
        await made.limit(None)
        assert made.device.limit_warnings(0) == []
        await made.device.motion.move(0, 1_000)


async def test_stops_pass_whatever_is_set(model: str) -> None:
    async with bench(model) as made:
        await set_up(made.device)
        await made.device.motion.rotate(0, 10_000)
        await made.clock.advance(0.5)
        await made.limit(AxisLimits(position_min=-10, position_max=10, velocity_max_pps=1.0, acceleration_max_pps2=1.0))
        for mode in ("immediate", "ramp"):
            outcome = (await made.device.stop_axes([0], mode))[0]
            assert outcome.ok, outcome.problem
        await made.clock.advance(1.0)
        assert not (await made.device.monitor.axis_state(0)).moving


async def test_nothing_that_slows_down_is_refused(model: str) -> None:
    name = "ap4" if model in MODULES else "VMAX" if model.startswith(("tmc4361", "tmc5")) else "V_MAX"
    async with bench(model) as made:
        await set_up(made.device)
        await made.limit(AxisLimits(velocity_max_pps=100.0))
        held = (await made.device.registers.read(name, 0)).value if not model.startswith("tmc5") else 20_000
        for value in (held // 2, held // 4):  # beyond the limit still, and less than before
            await made.device.registers.write(name, 0, value)
        with pytest.raises(SoftLimit):
            await made.device.registers.write(name, 0, held // 2)


async def test_an_axis_outside_of_its_range_may_come_back(model: str) -> None:
    async with bench(model) as made:
        await set_up(made.device)
        await made.device.motion.move(0, 12_000)
        await made.farthest(2.0, step_s=0.1)
        await made.limit(RANGE)
        assert any("outside of its range" in text for text in made.device.limit_warnings(0))
        with pytest.raises(SoftLimit):
            await made.device.motion.move(0, 12_500)
        with pytest.raises(SoftLimit):
            await made.device.motion.rotate(0, 1_000)
        await made.device.motion.move(0, 10_000)  # on the way back
        await made.farthest(1.0, step_s=0.1)
        await made.device.motion.move(0, 0)
        assert (await made.farthest(2.0, step_s=0.1))[0] >= -2
        assert made.device.limit_warnings(0) == []


async def test_a_position_outside_is_not_called_so(model: str) -> None:
    name = "ap1" if model in MODULES else "X_ACTUAL" if model in CHIPS_32 else "XACTUAL"
    async with bench(model) as made:
        await set_up(made.device)
        await made.limit(RANGE)
        with pytest.raises(SoftLimit):
            await made.device.registers.write(name, 0, 9_000)
        set_position = getattr(made.device, "set_position", None)
        if set_position is not None:
            made.port.frames.clear()
            with pytest.raises(SoftLimit):
                await set_position(0, 9_000)
            assert writes_to(made) == []
            await set_position(0, 7_000)


async def test_a_batch_is_judged_as_a_whole_before_its_first_write() -> None:
    async with bench("tmc428") as made:
        await set_up(made.device)
        await made.limit(AxisLimits(velocity_max_pps=20_000.0))
        made.port.frames.clear()
        batch = [WriteItem("v_max", 0, 100), WriteItem("pulse_div", 0, 0), WriteItem("v_max", 0, 1310)]
        with pytest.raises(SoftLimit) as refusal:
            await made.device.registers.write_many(batch)
        assert refusal.value.wanted == pytest.approx(100 * 16e6 / 65536)  # by the second
        assert writes_to(made) == []
        # The same in an order in which it is slow enough all the time.
        done = await made.device.registers.write_many([WriteItem("v_max", 0, 80), WriteItem("pulse_div", 0, 0)])
        assert done.failed is None


async def test_moves_together_set_off_together_or_not_at_all() -> None:
    for model in ("tmc428", "tmc5072"):
        async with bench(model) as made:
            await set_up(made.device)
            await made.limit(AxisLimits(position_max=1_000, velocity_max_pps=30_000.0))
            made.port.frames.clear()
            with pytest.raises(SoftLimit):
                await made.device.motion.move_together([AxisMove(0, 500), AxisMove(1, 1_500)])
            assert writes_to(made) == []


async def test_dividers_and_clocks_that_make_a_set_speed_too_fast_are_refused() -> None:
    async with bench("tmc428") as made:
        await set_up(made.device)
        await made.limit(AxisLimits(velocity_max_pps=25_000.0))
        with pytest.raises(SoftLimit) as refusal:
            await made.device.registers.write("pulse_div", 0, 3)
        assert refusal.value.quantity == "velocity"
        assert "v_max" in refusal.value.way_out
        await made.device.registers.write("pulse_div", 0, 5)
    async with bench("tmc4361") as made:
        await set_up(made.device)
        await made.limit(AxisLimits(velocity_max_pps=25_000.0))
        with pytest.raises(SoftLimit):
            await made.device.registers.write("CLK_FREQ", 0, 8_000_000)
    async with bench("tmc4361") as made:
        await set_up(made.device)
        await made.limit(AxisLimits(acceleration_max_pps2=160_000.0))
        with pytest.raises(SoftLimit):
            await made.device.registers.write("GENERAL_CONF", 0, fields={"direct_acc_val_en": 1})


@pytest.mark.parametrize("model", ["tmc428", "tmc5160"])
async def test_another_clock_that_makes_a_set_speed_too_fast_is_refused(model: str) -> None:
    async with bench(model) as made:
        await set_up(made.device)
        await made.manager.edit(made.device.id, DeviceChange(clock_hz=8e6))
        await made.limit(AxisLimits(velocity_max_pps=12_000.0))  # 10,000 pps are set, by half the clock
        with pytest.raises(SoftLimit) as refusal:
            await made.manager.edit(made.device.id, DeviceChange(clock_hz=16e6))
        assert refusal.value.quantity == "velocity"
        assert made.device.clock_hz == 8e6
        await made.manager.edit(made.device.id, DeviceChange(clock_hz=9e6))
