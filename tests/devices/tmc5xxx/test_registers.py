"""Registers by name: what can be read back is, what cannot has to show that it arrived; raw datagrams; tables."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from app.calc.microsteps import mslut
from app.calc.microsteps.mslut_waves import Formula, wanted_wave
from app.devices.core.capabilities import MslutTable
from app.devices.tmc5xxx.start_up import Start, encoder_constant, start_up
from app.errors import OutOfRange, UsageError, WrongState
from app.registers.tmc5xxx.table import AXES
from tests.devices.tmc5xxx.harness import MODELS, START, bench


@pytest.mark.parametrize("model", MODELS)
async def test_every_writable_register_takes_its_reset_again(model: str) -> None:
    async with bench(model, None) as b:
        for row in b.memory.table:
            if not row.access.writable or row.when or row.name in ("OTP_PROG", "NODECONF", "SLAVECONF"):
                continue
            value = row.decode(row.reset or 0)
            written = await b.device.registers.write(row.name, row.axis, max(value, row.minimum))
            assert written.verified is not False, row.name
            if not row.access.readable:
                assert "arrived" in written.note, row.name


async def test_fields_of_a_write_only_register_keep_the_others() -> None:
    async with bench("tmc5072", None) as b:
        await b.device.registers.write("IHOLD_IRUN", 1, fields={"IHOLD": 4, "IRUN": 18, "IHOLDDELAY": 6})
        written = await b.device.registers.write("IRUN", 1, 20)
        assert (written.value, written.fields) == (20, {"IHOLD": 4, "IRUN": 20, "IHOLDDELAY": 6})
        assert "not known" not in written.note
        b.memory._unread.clear()
        b.memory.fresh = False  # as for a server that starts when somebody else has set the chip up
        written = await b.device.registers.write("IHOLD_IRUN", 1, fields={"IRUN": 20})
        assert "its other fields were not known" in written.note


async def test_what_a_write_does_besides_is_said() -> None:
    async with bench("tmc5130") as b:
        assert "the driver is off" in (await b.device.registers.write("CHOPCONF", 0, fields={"toff": 0})).note
        await b.device.registers.write("VSTART", 0, 1_000)
        assert "below VSTART" in (await b.device.registers.write("VSTOP", 0, 100)).note
        assert "must not have D1 0" in (await b.device.registers.write("D1", 0, 0)).note
        assert "the other way" in (await b.device.registers.write("GCONF", fields={"shaft": 1})).note
        assert "the other way" not in (await b.device.registers.write("GCONF", fields={"en_pwm_mode": 1})).note
        await b.device.registers.write("D1", 0, 1_000)
        await b.device.registers.write("VSTART", 0, 0)
        assert "drives to XTARGET" in (await b.device.registers.write("XACTUAL", 0, 500)).note


async def test_a_target_by_hand_is_predicted() -> None:
    async with bench("tmc5062") as b:
        await b.device.registers.write("XTARGET", 1, 9_000)
        expected = b.device.motion.prediction(1)
        assert expected is not None
        assert b.device.motion.prediction(0) is None
        await b.clock.advance(expected.duration_s + 0.01)
        assert (await b.state(1)).position == 9_000
        await b.device.registers.write("RAMPMODE", 1, 2)
        turning = b.device.motion.prediction(1)
        assert turning is not None
        assert turning.velocity_pps[-1] == pytest.approx(-50_000, abs=2)


async def test_two_axes_ask_for_which() -> None:
    async with bench("tmc5072", None) as b:
        with pytest.raises(UsageError, match="belongs to an axis"):
            await b.device.registers.read("XACTUAL")
        assert (await b.device.registers.read("GCONF")).axis is None
        assert (await b.device.registers.read("XACTUAL", 1)).address == 0x41


# --- raw ----------------------------------------------------------------------------------------


async def test_what_a_raw_read_brings_is_decoded_at_once() -> None:
    async with bench("tmc5130") as b:
        raw = await b.device.raw.exchange(bytes((0x21, 0, 0, 0, 0)))
        assert (raw.decoded["register"], raw.decoded["rw"], raw.decoded["value"]) == ("XACTUAL", "read", 0)
        flags = raw.decoded["flags"]
        assert isinstance(flags, dict)
        assert list(flags)[:3] == ["reset_flag", "driver_error", "sg2"]
        raw = await b.device.raw.exchange(bytes((0xA7, 0, 0, 0x27, 0x10)))
        assert (raw.decoded["register"], raw.decoded["value"]) == ("VMAX", 10_000)
        assert b.ramp(0).words["VMAX"] == 10_000
        with pytest.raises(OutOfRange, match=r"5\.\.5"):
            await b.device.raw.exchange(b"\x21\x00")
        with pytest.raises(UsageError, match="eight clocks write nothing: send 00"):
            await b.device.raw.exchange(b"\x21")


async def test_a_raw_target_is_predicted() -> None:
    async with bench() as b:
        raw = await b.device.raw.exchange(b"\xad" + (9_000).to_bytes(4, "big"))
        assert raw.decoded["register"] == "XTARGET"
        expected = b.device.motion.prediction(0)
        assert expected is not None
        await b.clock.advance(expected.duration_s + 0.01)
        assert (await b.state()).position == 9_000


async def test_a_raw_read_that_clears_is_told_and_done_once() -> None:
    async with bench("tmc5130") as b:
        await b.device.motion.move(0, 50)
        await b.clock.advance(0.04)
        b.port.frames.clear()
        raw = await b.device.raw.exchange(bytes((0x35, 0, 0, 0, 0)))
        assert [frame[0] for frame in b.port.frames] == [0x35, 0x00]
        fields = raw.decoded["fields"]
        assert isinstance(fields, dict)
        assert fields["event_pos_reached"] == 1
        assert b.event_names().count("event_pos_reached") == 1


# --- tables -------------------------------------------------------------------------------------


@pytest.mark.parametrize("model", MODELS)
async def test_a_microstep_table_is_written_to_every_axis_and_agrees(model: str) -> None:
    async with bench(model) as b:
        before = await b.device.need(MslutTable).read_mslut()
        assert before.registers == mslut.MslutRegisters(
            tuple(row.reset or 0 for row in b.memory.rows(0).mslut[:8]), 0xFFFF_8056, 0x00F7_0000
        )
        assert before.written == (model == "tmc5240"), "that has read it"
        registers = mslut.encode(wanted_wave(Formula(exponent=1.1, grid="whole_step")).wave.values, 0)
        held = await b.device.need(MslutTable).write_mslut(registers)
        assert (held.registers, held.written) == (registers, True)
        for axis in range(AXES[model]):
            await b.device.motion.move(axis, 300)
            await b.at_rest(axis)
            held = await b.device.need(MslutTable).read_mslut(axis)
            assert held.registers == registers
            assert mslut.decode(registers).currents(held.position) == (held.current_a, held.current_b)


# --- start-up -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("ratio", "decimal", "word"),
    [
        (Fraction(51_200, 40_000), True, 1 * 65_536 + 2_800),
        (Fraction(51_200, 8_192), False, 409_600),
        (Fraction(-51_200, 40_000), True, -2 * 65_536 + 7_200),
        (Fraction(-25, 4), False, -409_600),
        (Fraction(1, 3), False, 21_845),
    ],
)
def test_an_encoder_constant_is_exact_where_one_of_the_two_ways_is(ratio: Fraction, decimal: bool, word: int) -> None:
    """Facts: tmc5xxx-ramp, 8; a negative decimal one counts its fraction up from one below."""
    assert encoder_constant(ratio) == (decimal, word)


def test_an_encoder_constant_that_does_not_fit_is_refused() -> None:
    for ratio in (Fraction(0), Fraction(1 << 15)):
        with pytest.raises(UsageError, match="microsteps a count"):
            encoder_constant(ratio)


@pytest.mark.parametrize("invert", [False, True])
async def test_an_encoder_counts_in_microsteps_after_start_up(invert: bool) -> None:
    async with bench("tmc5072", None, encoder={"reversed": invert}) as b:
        await start_up(b.device, [replace(START, invert_encoder=invert)] * 2)
        for axis in (0, 1):
            await b.device.motion.move(axis, 51_200)
            state = await b.at_rest(axis)
            assert state.deviation is not None
            assert abs(state.deviation) < 30
            assert state.switches.right is None  # encoder 2 has taken its pin


async def test_a_start_that_does_not_fit_says_which_number() -> None:
    async with bench(start=None) as b:
        with pytest.raises(UsageError, match="A1: acceleration is"):
            await start_up(b.device, [Start(vmax=1_000, amax=1e9)])
        with pytest.raises(UsageError, match="has 1 axes, not 2"):
            await start_up(b.device, [Start(1.0, 1.0)] * 2)
        with pytest.raises(WrongState, match="VMAX is 0"):
            await b.device.motion.move(0, 1)
