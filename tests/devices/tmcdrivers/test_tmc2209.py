"""The driver of a TMC2209 over its emulator: what it knows, refuses and does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.conditions.judge import AxisObservation, judge
from app.devices.core.axis_limits import AxisLimits
from app.devices.core.capabilities import LatchedFlags
from app.devices.core.config import AxisSettings
from app.devices.core.start_up import AxisStartUp, Figures
from app.devices.families import models_found
from app.devices.tmcdrivers.start_up import plan
from app.errors import BadReply, CannotMove, LinkTimeout, OtherModel, OutOfRange, SoftLimit, UsageError, WrongState
from app.links.datagram_uart import UartForm
from app.links.queue import LinkQueue
from app.links.register_access import UartAccess
from tests.devices.tmcdrivers.harness import bench

CLOCK_HZ = 12e6
UNIT_PPS = CLOCK_HZ / 2**24
SENSE = AxisLimits(current_max_a=1.0, sense_resistor_ohm=0.11)


async def test_it_finds_its_chip_and_no_other() -> None:
    async with bench() as b:
        assert await b.device.identity.probe() == "a TMC2209 answers, version 0x21"
        assert b.device.state == "connected"


@pytest.mark.parametrize("node", [0, 1, 3])
async def test_it_is_reached_at_its_node(node: int) -> None:
    async with bench(node=node) as b:
        assert (await b.device.registers.read("IOIN")).fields["VERSION"] == 0x21


async def test_a_write_is_read_back_or_counted() -> None:
    async with bench() as b:
        done = await b.device.registers.write("PWMCONF", None, fields={"PWM_OFS": 40})
        assert (done.verified, done.fields["PWM_OFS"], done.fields["PWM_LIM"]) == (True, 40, 12)
        done = await b.device.registers.write("SGTHRS", None, 77)
        assert (done.verified, b.held("SGTHRS")) == (True, 77)
        assert "arrived" in done.note
        assert [reading.value for reading in b.device.registers.kept(0) if reading.name == "SGTHRS"] == [77]


async def test_fields_of_what_cannot_be_read_are_written_over_what_is_known() -> None:
    async with bench() as b:
        await b.device.registers.write("IHOLD_IRUN", None, fields={"IRUN": 20})
        assert b.held("IHOLD_IRUN") == 1 << 16 | 20 << 8 | 16, "the others as after the reset that was seen"


@pytest.mark.parametrize("way", [1, -1])
async def test_it_rotates_and_stops(way: int) -> None:
    async with bench(motor="rigid") as b:
        await b.ready()
        rotating = await b.device.motion.rotate(0, way * 25_600.0)
        assert rotating.velocity_pps == pytest.approx(way * 25_600, abs=UNIT_PPS)
        assert any("jumps" in warning for warning in rotating.warnings)
        await b.clock.advance(1.0)
        state = await b.state()
        assert (state.moving, state.mode) == (True, "velocity")
        assert state.velocity_pps == pytest.approx(way * 25_600, rel=0.005)
        assert state.target_velocity_pps == pytest.approx(way * 25_600, rel=1e-4)
        assert b.chip.ground_truth(0).shaft_fullsteps == pytest.approx(way * 100, abs=1)
        (outcome,) = await b.device.stop_axes([0])
        assert outcome.ok
        await b.clock.advance(0.5)
        state = await b.state()
        assert (state.moving, state.velocity_pps, state.mode) == (False, 0.0, "step/dir")


async def test_units_and_the_limit_of_the_chip() -> None:
    async with bench() as b:
        await b.ready()
        assert (await b.device.motion.rotate(0, 60, "rpm")).velocity_pps == pytest.approx(51_200, rel=1e-4)
        with pytest.raises(OutOfRange, match="velocity"):
            await b.device.motion.rotate(0, 7e6)
        with pytest.raises(UsageError):
            await b.device.motion.rotate(0, 1, "parsec")


async def test_it_can_be_sent_nowhere() -> None:
    async with bench() as b:
        with pytest.raises(WrongState, match="counts no position"):
            await b.device.motion.move(0, 1000)


async def test_a_driver_that_is_off_does_not_rotate() -> None:
    async with bench() as b:
        await b.put(CHOPCONF=0x1000_0050)
        with pytest.raises(CannotMove, match="toff"):
            await b.device.motion.rotate(0, 1000)
        assert b.held("VACTUAL") == 0


async def test_microsteps_are_those_of_the_pins_until_the_register_is_chosen() -> None:
    async with bench(node=2) as b:
        await b.state()
        assert b.device.axes[0].microsteps_per_full_step == 64
        await b.ready()
        await b.put(CHOPCONF=0x1400_0053)
        await b.state()
        assert b.device.axes[0].microsteps_per_full_step == 16


async def test_a_reset_is_seen_once_and_kept_for_who_reads_gstat() -> None:
    async with bench() as b:
        await b.state()
        signs = b.device.monitor.signs(0, await b.state())
        await b.put(SGTHRS=9)
        b.patch(power_cycle=True)
        state = await b.state()
        assert b.device.monitor.signs(0, state).resets == (signs.resets or 0) + 1
        assert state.flags["reset"]
        assert [r.value for r in b.device.registers.kept(0) if r.name == "SGTHRS"] == [0], "as after a reset"
        flags = b.device.need(LatchedFlags)
        await flags.clear_flags(0)
        assert not (await b.state()).flags["reset"]


@pytest.mark.parametrize(
    ("change", "kind", "words"),
    [
        ({"motor": {"short_to_ground": "a"}}, "driver_fault", "phase A is shorted"),
        ({"motor": {"temperature_c": 160.0}}, "driver_fault", "too hot"),
        ({"motor": {"temperature_c": 130.0}}, "ready", "the driver warns that it is hot"),
        ({"pins": {"enn": True}}, "cannot_move", "ENN"),
        ({"supply_v": 2.0}, "driver_fault", "charge pump"),
    ],
)
async def test_conditions(change: dict[str, object], kind: str, words: str) -> None:
    async with bench() as b:
        await b.ready()
        b.patch(**change)
        await b.clock.advance(0.01)
        state = await b.state()
        found = judge(AxisObservation(0, "connected", state=state, signs=b.device.monitor.signs(0, state)))
        assert (found.kind, words in found.cause) == (kind, True), found


async def test_soft_limits_of_velocity_and_current() -> None:
    limits = replace(SENSE, velocity_max_pps=10_000.0)
    async with bench(axis=AxisSettings("x", limits=limits)) as b:
        await b.put(IHOLD_IRUN=0x08_04, CHOPCONF=0x1000_0053)
        with pytest.raises(SoftLimit):
            await b.device.motion.rotate(0, 10_001.0)
        with pytest.raises(SoftLimit):
            await b.put(VACTUAL=-20_000)
        with pytest.raises(SoftLimit):
            await b.put(IHOLD_IRUN=0x1F_00)  # 1.77 A
        with pytest.raises(SoftLimit):
            await b.device.raw.exchange(_datagram(0x22, 20_000))
        assert b.held("VACTUAL") == 0
        await b.device.motion.rotate(0, 9000.0)
        assert b.held("VACTUAL") * UNIT_PPS == pytest.approx(9000, abs=UNIT_PPS)


def _datagram(register: int, data: int) -> bytes:
    return UartForm(0).write(register, data)


async def test_positions_cannot_be_limited() -> None:
    with pytest.raises(UsageError, match="counts no position"):
        async with bench(axis=AxisSettings("x", limits=AxisLimits(position_max=1000))):
            pass


async def test_start_up_by_amperes_makes_it_turn() -> None:
    """1 A RMS with 110 mOhm: vsense makes the finer scale of it, 0.98 A at IRUN 31 (DS-TMC2209 8)."""
    limits = AxisLimits(sense_resistor_ohm=0.11)
    async with bench(axis=AxisSettings("x", limits=limits)) as b:
        wanted = AxisStartUp(0, b.device.axes[0].settings, Figures(run_current_a=0.97, microsteps=16))
        done = await b.device.registers.write_many((await plan(b.device, [wanted])).items)
        assert done.failed is None
        ihold_irun, chopconf = b.held("IHOLD_IRUN"), await b.value("CHOPCONF")
        vfs = 0.18 if chopconf >> 17 & 1 else 0.325
        rms = vfs / 0.13 * ((ihold_irun >> 8 & 31) + 1) / 32 / 2**0.5
        assert rms == pytest.approx(0.97, rel=0.03)
        await b.state()
        assert b.device.axes[0].microsteps_per_full_step == 16
        await b.device.motion.rotate(0, 1600.0)
        await b.clock.advance(1.0)
        assert b.chip.ground_truth(0).shaft_fullsteps == pytest.approx(100, abs=2)


async def test_samples() -> None:
    async with bench(motor="rigid") as b:
        await b.ready()
        await b.device.motion.rotate(0, -12_800.0)
        await b.clock.advance(0.5)
        names = ["velocity.0", "target_velocity.0", "mscnt.0", "current_a.0", "load_value.0", "driver_flags.0"]
        plan = b.device.telemetry.sample_plan(names)
        taken = await b.device.telemetry.take_samples(plan)
        row = plan.decode(np.asarray(taken.times_s), b"".join(taken.replies))[0]
        assert row[:2] == pytest.approx([-12_800, -12_800], rel=0.005)
        assert 0 <= row[2] < 1024
        assert not any(name.startswith("position") for name in (c.name for c in b.device.telemetry.channels()))


async def test_raw_datagrams_are_taken_into_account() -> None:
    async with bench() as b:
        await b.ready()
        answer = await b.device.raw.exchange(_datagram(0x22, 1000))
        assert answer.decoded["register"] == "VACTUAL"
        assert (await b.state()).mode == "velocity"
        with pytest.raises(UsageError, match="CRC"):
            await b.device.raw.exchange(_datagram(0x22, 1000)[:-1] + b"\0")


async def test_links_that_fail() -> None:
    async with bench() as b:
        await b.ready()
        b.patch(faults={"silence": True})
        with pytest.raises(LinkTimeout):
            await b.device.motion.rotate(0, 1000.0)
        b.patch(faults={"silence": False, "bit_error_rate": 1.0})
        with pytest.raises(BadReply):
            await b.state()
        b.patch(faults={"bit_error_rate": 0.0})
        assert (await b.device.stop_axes([0]))[0].ok
        assert b.held("VACTUAL") == 0


async def test_another_chip_is_told_by_its_version() -> None:
    """A TMC5160 at the same node: its own VERSION stands elsewhere."""
    async with bench() as b:
        queue = LinkQueue(b.device.session.port)
        assert await models_found(queue, UartAccess()) == ("tmc2209",)
        b.chip._chip.kind = replace(b.chip._chip.kind, version=0x77)
        with pytest.raises(OtherModel, match="0x77"):
            await b.device.identity.probe()


async def test_burning_the_memory_is_refused_by_name_and_left_to_a_datagram_by_hand() -> None:
    async with bench() as b:
        before = (await b.device.registers.read("OTP_READ")).value
        for word in ({"value": 0xBD17}, {"fields": {"OTPMAGIC": 0xBD, "OTPBYTE": 1, "OTPBIT": 7}}):
            with pytest.raises(WrongState, match="nobody can take back"):
                await b.device.registers.write("OTP_PROG", **word)
        await b.device.registers.write("OTP_PROG", value=0x17)
        assert (await b.device.registers.read("OTP_READ")).value == before
        await b.device.raw.exchange(_datagram(0x04, 0xBD17))
        assert (await b.device.registers.read("OTP_READ")).value == before | 1 << 15
