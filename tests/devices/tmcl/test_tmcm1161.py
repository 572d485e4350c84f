"""The TMCM-1161 by the driver of its family: pps in its own units, a counter of 24 bits, parameters in its EEPROM."""

from __future__ import annotations

import numpy as np
import pytest

from app.devices.core.axis_limits import AxisLimits
from app.devices.core.capabilities import ParameterStore
from app.devices.core.config import AxisSettings
from app.devices.manager import DeviceChange
from app.errors import OtherModel, OutOfRange, SoftLimit, UnknownThing, WrongState
from app.links.tmcl import Request
from app.registers.tmcl.commands import Opcode
from tests.devices.tmcl.harness import Bench, bench, state_of

MODEL = "tmcm-1161"
CLOCK_HZ = 16e6
ONE_PPS = CLOCK_HZ / 2**19
"""Of a speed of 1 with the divider that it comes with, 3."""
HALF = 1 << 23


async def _read(b: Bench, name: str) -> int:
    return (await b.device.registers.read(name, 0)).value


async def test_it_is_known_by_its_number() -> None:
    async with bench(MODEL) as b:
        assert await b.device.identity.probe() == "TMCM-1161, firmware 1.46, address 1"


@pytest.mark.parametrize("distance", [-120_000, 30_000, 500])
async def test_a_move_goes_as_predicted(distance: int) -> None:
    async with bench(MODEL) as b:
        plan = b.device.telemetry.sample_plan(["position.0", "residual.0", "predicted_velocity.0", "velocity.0"])
        rows: list[tuple[float, bytes]] = []
        port = b.device.session.sampling_port
        assert port is not None
        port.start_sampling(plan.frames, 0.002, lambda time_s, row: rows.append((time_s, row)))
        started = await b.device.motion.move(0, distance)
        assert started.predicted_duration_s is not None
        await b.clock.advance(started.predicted_duration_s + 0.2)
        port.run_due_samples()
        times = np.array([time_s for time_s, _ in rows])
        position, residual, expected_pps, velocity_pps = plan.decode(times, b"".join(row for _, row in rows)).T
        assert position[-1] == distance
        fastest = np.abs(expected_pps).max()
        assert np.nanmax(np.abs(residual)) < 3 + 3e-3 * fastest
        assert np.abs(velocity_pps).max() == pytest.approx(fastest, rel=0.02)
        end = b.device.monitor.motion_ends(0)[-1]
        assert (end.reason, end.position) == ("target_reached", distance)


@pytest.mark.parametrize(
    ("velocity", "unit", "speed"),
    [(10_000, "pps", 328), (-30_000, "pps", -983), (1, "rps", 1678), (7, "chip", 7)],
)
async def test_speeds_are_told_in_its_units_and_seen_in_pps(velocity: float, unit: str, speed: int) -> None:
    async with bench(MODEL) as b:
        rotating = await b.device.motion.rotate(0, velocity, unit)
        assert rotating.velocity_pps == pytest.approx(speed * ONE_PPS)
        sent = next(frame for frame in b.tap.frames if frame.opcode in (Opcode.ROR, Opcode.ROL))
        assert (sent.opcode, sent.value) == (Opcode.ROR if speed > 0 else Opcode.ROL, abs(speed))
        await b.clock.advance(2.0)
        state = await b.device.monitor.axis_state(0)
        assert state.velocity_pps == pytest.approx(speed * ONE_PPS)
        assert state.target_velocity_pps == pytest.approx(speed * ONE_PPS)
        await b.device.stop(0, "ramp")
        await b.at_rest()


async def test_a_speed_beyond_the_divider_is_refused_with_what_it_allows() -> None:
    async with bench(MODEL) as b:
        with pytest.raises(OutOfRange) as refusal:
            await b.device.motion.rotate(0, 70_000)
        assert refusal.value.maximum == pytest.approx(2047 * ONE_PPS)
        await b.device.registers.write("pulse_div", 0, 2)
        rotating = await b.device.motion.rotate(0, 70_000)
        assert rotating.velocity_pps == pytest.approx(70_000, rel=1e-3)


async def test_units_are_never_guessed() -> None:
    """Somebody else has changed the divider: the next look sees it before a speed is told."""
    async with bench(MODEL) as b:
        b.module.exchange(Request(1, Opcode.SAP, 154, 0, 5).encode())
        rotating = await b.device.motion.rotate(0, 10_000)
        assert rotating.velocity_pps == pytest.approx(10_000, rel=1e-3)
        assert b.module.exchange(Request(1, Opcode.GAP, 2).encode())[4:8] == round(10_000 * 2**21 / 16e6).to_bytes(4)


@pytest.mark.parametrize("mode", ["ramp", "immediate"])
async def test_both_stops_end_a_motion_and_leave_the_acceleration_as_it_was(mode: str) -> None:
    async with bench(MODEL) as b:
        slope = await _read(b, "maximum_acceleration")
        await b.device.motion.rotate(0, 40_000)
        await b.clock.advance(1.5)
        before = (await b.device.monitor.axis_state(0)).position
        (outcome,) = await b.device.stop_axes([0], mode)  # type: ignore[arg-type]
        assert outcome.ok, outcome.problem
        await b.at_rest()
        way = (await b.device.monitor.axis_state(0)).position - before
        # By the acceleration that it comes with, or by the greatest that these dividers allow.
        rate = CLOCK_HZ**2 / 2**39 * (slope if mode == "ramp" else 2047)
        assert way == pytest.approx(40_000**2 / 2 / rate, rel=0.1, abs=50)
        await b.clock.advance(1.0)
        assert await _read(b, "maximum_acceleration") == slope
        assert (await b.device.monitor.axis_state(0)).moving is False


async def test_positions_wrap_at_24_bits_and_targets_end_there() -> None:
    async with bench(MODEL) as b:
        assert b.device.counter.counter_bits(0) == 24
        with pytest.raises(OutOfRange) as refusal:
            await b.device.motion.move(0, HALF)
        assert (refusal.value.minimum, refusal.value.maximum) == (-HALF, HALF - 1)
        await b.device.registers.write("actual_position", 0, HALF - 500)
        await b.device.motion.rotate(0, 30_000)
        await b.clock.advance(1.0)
        state = await b.device.monitor.axis_state(0)
        assert state.position < 0
        assert state.deviation is not None


async def test_what_its_sibling_has_is_not_here() -> None:
    async with bench(MODEL) as b:
        channels = {channel.quantity for channel in b.device.telemetry.channels()}
        assert {"position", "velocity", "load_value", "encoder_position", "deviation"} <= channels
        assert not channels & {"measured_speed", "pwm_scale", "external_encoder_position", "external_deviation"}
        for name in ("unit_mode", "ap255", "velocity_v1", "external_encoder_position"):
            with pytest.raises(UnknownThing):
                await b.device.registers.read(name, 0)
        await b.device.identity.refresh()
        asked = {frame.type for frame in b.tap.frames if frame.opcode == Opcode.GAP}
        assert asked <= {row.address for row in b.device.family.table if row.axis == 0}, (
            "nobody asks for what is not there"
        )


async def test_parameters_go_to_its_eeprom_and_come_back() -> None:
    async with bench(MODEL) as b:
        store = b.device.need(ParameterStore)
        await b.device.registers.write("maximum_positioning_speed", 0, 700)
        assert (await store.store("maximum_positioning_speed", 0)).value == 700
        await b.device.registers.write("maximum_positioning_speed", 0, 300)
        assert (await store.restore("ap4", 0)).value == 700
        b.patch(power_cycle=True)
        assert await _read(b, "ap4") == 700
        with pytest.raises(WrongState, match="RAM alone"):
            await store.store("actual_position", 0)


async def test_writing_the_ramp_mode_is_a_motion() -> None:
    async with bench(MODEL) as b:
        await b.device.motion.move(0, 20_000)
        await b.at_rest()
        await b.device.motion.rotate(0, -5_000)
        await b.clock.advance(1.0)
        written = await b.device.registers.write("ramp_mode", 0, 0)
        assert written.value == 0
        assert await b.at_rest() == 20_000


async def test_soft_limits_reckon_by_its_dividers() -> None:
    async with bench(MODEL) as b:
        limits = AxisLimits(velocity_max_pps=20_000.0, acceleration_max_pps2=60_000.0, position_min=-9_000)
        await b.device.registers.write("maximum_positioning_speed", 0, 600)
        await b.manager.edit(b.device.id, DeviceChange(axes=(AxisSettings(limits=limits),)))
        await b.device.registers.write("maximum_positioning_speed", 0, 655)  # 19,989 pps
        with pytest.raises(SoftLimit):
            await b.device.registers.write("maximum_positioning_speed", 0, 656)
        with pytest.raises(SoftLimit):
            await b.device.registers.write("pulse_div", 0, 2)
        with pytest.raises(SoftLimit):
            await b.device.registers.write("ramp_div", 0, 6)
        with pytest.raises(SoftLimit):
            await b.device.motion.move(0, -9_001)
        await b.device.registers.write("pulse_div", 0, 4)
        await b.device.registers.write("maximum_positioning_speed", 0, 1_310)
        with pytest.raises(WrongState, match="EEPROM"):
            await b.device.raw.exchange(Request(1, Opcode.RSAP, 4).encode())
        with pytest.raises(WrongState, match="MVP"):
            await b.device.registers.write("ramp_mode", 0, 0)


async def test_another_module_is_not_taken_for_it() -> None:
    async with bench("pd42-1241") as b:
        real = b.tap.spoil
        assert real is None
        b.tap.spoil = lambda request, reply: (
            bytes.fromhex("02 01 64 88 04 89 01 2E") + bytes([sum(bytes.fromhex("02 01 64 88 04 89 01 2E")) & 0xFF])
            if request.opcode == Opcode.GET_VERSION
            else reply
        )
        with pytest.raises(OtherModel, match=r"module 1161, firmware 1\.46, not a PD42-1241"):
            await b.device.identity.probe()
        assert state_of(b.device) == "connected"
