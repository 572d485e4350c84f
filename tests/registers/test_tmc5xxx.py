"""The register tables of the TMC5xxx against figures written down a second time from the fact sheets.

Those come from the five data sheets, each compared with the vendor's headers and PyTrinamic's tables.
"""

from __future__ import annotations

import re

import pytest

from app.registers.catalog import MODELS
from app.registers.microstep_rows import MSLUT_RESET
from app.registers.model import Access, Register
from app.registers.tmc5xxx.table import AXES, DRIVER_STEP, PWM_STEP, RAMP_STEP, TABLES
from app.registers.tmc4361.table import TMC4361

EVERY = pytest.mark.parametrize("model", ["tmc5031", "tmc5062", "tmc5072", "tmc5130", "tmc5160"])
DUAL = pytest.mark.parametrize("model", [model for model, axes in AXES.items() if axes == 2])

# Of the whole chip and of the first axis: address, name, access, width (s: signed), reset (-: no source tells).
# R+C: reading clears; R+WC: writing 1 does. Without the eight words of the microstep table.
WORDS = {
    "tmc5031": """
        00 GCONF RW 11 0x0; 01 GSTAT R+C 4 -; 03 TEST_SEL W 4 0x0; 04 INPUT R 32 -; 05 X_COMPARE W s32 0x0; 20 RAMPMODE
        RW 2 0x0; 21 XACTUAL RW s32 0x0; 22 VACTUAL R s24 -; 23 VSTART W 18 0x0; 24 A1 W 16 0x0; 25 V1 W 20 0x0; 26 AMAX
        W 16 0x0; 27 VMAX W 23 0x0; 28 DMAX W 16 0x0; 2a D1 W 16 0x0; 2b VSTOP W 18 0x0; 2c TZEROWAIT W 16 0x0; 2d
        XTARGET RW s32 0x0; 30 IHOLD_IRUN W 20 0x0; 31 VCOOLTHRS W 23 0x0; 32 VHIGH W 23 0x0; 34 SW_MODE RW 12 0x0; 35
        RAMP_STAT R+C 14 -; 36 XLATCH R s32 -; 68 MSLUTSEL W 32 0xffff8056; 69 MSLUTSTART W 24 0xf70000; 6a MSCNT R 10
        -; 6b MSCURACT R 25 -; 6c CHOPCONF RW 31 0x0; 6d COOLCONF W 25 0x0; 6f DRV_STATUS R 32 -
    """,
    "tmc5062": """
        00 GCONF RW 11 0x0; 01 GSTAT R+C 4 -; 02 IFCNT R 8 -; 03 SLAVECONF W 8 0x0; 04 INPUT R 32 -; 04 OUTPUT W 12 0x0;
        05 X_COMPARE W s32 0x0; 20 RAMPMODE RW 2 0x0; 21 XACTUAL RW s32 0x0; 22 VACTUAL R s24 -; 23 VSTART W 18 0x0; 24
        A1 W 16 0x0; 25 V1 W 20 0x0; 26 AMAX W 16 0x0; 27 VMAX W 23 0x0; 28 DMAX W 16 0x0; 2a D1 W 16 0x0; 2b VSTOP W 18
        0x0; 2c TZEROWAIT W 16 0x0; 2d XTARGET RW s32 0x0; 30 IHOLD_IRUN W 20 0x0; 31 VCOOLTHRS W 23 0x0; 32 VHIGH W 23
        0x0; 33 VDCMIN W 23 0x0; 34 SW_MODE RW 12 0x0; 35 RAMP_STAT R+C 14 -; 36 XLATCH R s32 -; 38 ENCMODE RW 11 0x0;
        39 X_ENC RW s32 0x0; 3a ENC_CONST W s32 0x10000; 3b ENC_STATUS R+C 1 -; 3c ENC_LATCH R s32 -; 68 MSLUTSEL W 32
        0xffff8056; 69 MSLUTSTART W 24 0xf70000; 6a MSCNT R 10 -; 6b MSCURACT R 25 -; 6c CHOPCONF RW 32 0x0; 6d COOLCONF
        W 25 0x0; 6e DCCTRL W 16 0x0; 6f DRV_STATUS R 32 -
    """,
    "tmc5072": """
        00 GCONF RW 12 0x0; 01 GSTAT R+C 4 -; 02 IFCNT R 8 -; 03 NODECONF W 12 0x0; 04 INPUT R 32 -; 04 OUTPUT W 11 0x0;
        05 X_COMPARE W s32 0x0; 10 PWMCONF W 22 0x0; 11 PWM_STATUS R 8 -; 20 RAMPMODE RW 2 0x0; 21 XACTUAL RW s32 0x0;
        22 VACTUAL R s24 -; 23 VSTART W 18 0x0; 24 A1 W 16 0x0; 25 V1 W 20 0x0; 26 AMAX W 16 0x0; 27 VMAX W 23 0x0; 28
        DMAX W 16 0x0; 2a D1 W 16 0x0; 2b VSTOP W 18 0x0; 2c TZEROWAIT W 16 0x0; 2d XTARGET RW s32 0x0; 30 IHOLD_IRUN W
        20 0x0; 31 VCOOLTHRS W 23 0x0; 32 VHIGH W 23 0x0; 33 VDCMIN W 23 0x0; 34 SW_MODE RW 12 0x0; 35 RAMP_STAT R+C 14
        -; 36 XLATCH R s32 -; 38 ENCMODE RW 12 0x0; 39 X_ENC RW s32 0x0; 3a ENC_CONST W s32 0x10000; 3b ENC_STATUS R+C 1
        -; 3c ENC_LATCH R s32 -; 68 MSLUTSEL W 32 0xffff8056; 69 MSLUTSTART W 24 0xf70000; 6a MSCNT R 10 -; 6b MSCURACT
        R 25 -; 6c CHOPCONF RW 31 0x0; 6d COOLCONF W 25 0x0; 6e DCCTRL W 16 0x0; 6f DRV_STATUS R 32 -
    """,
    "tmc5130": """
        00 GCONF RW 18 0x0; 01 GSTAT R+C 3 -; 02 IFCNT R 8 -; 03 NODECONF W 12 0x0; 04 IOIN R 32 -; 04 OUTPUT W 1 0x1;
        05 X_COMPARE W s32 0x0; 10 IHOLD_IRUN W 20 0x0; 11 TPOWERDOWN W 8 0x0; 12 TSTEP R 20 -; 13 TPWMTHRS W 20 0x0; 14
        TCOOLTHRS W 20 0x0; 15 THIGH W 20 0x0; 20 RAMPMODE RW 2 0x0; 21 XACTUAL RW s32 0x0; 22 VACTUAL R s24 -; 23
        VSTART W 18 0x0; 24 A1 W 16 0x0; 25 V1 W 20 0x0; 26 AMAX W 16 0x0; 27 VMAX W 23 0x0; 28 DMAX W 16 0x0; 2a D1 W
        16 0x0; 2b VSTOP W 18 0x0; 2c TZEROWAIT W 16 0x0; 2d XTARGET RW s32 0x0; 33 VDCMIN W 23 0x0; 34 SW_MODE RW 12
        0x0; 35 RAMP_STAT R+C 14 -; 36 XLATCH R s32 -; 38 ENCMODE RW 11 0x0; 39 X_ENC RW s32 0x0; 3a ENC_CONST W s32
        0x0; 3b ENC_STATUS R+C 1 -; 3c ENC_LATCH R s32 -; 68 MSLUTSEL W 32 0xffff8056; 69 MSLUTSTART W 24 0xf70000; 6a
        MSCNT R 10 -; 6b MSCURACT R 25 -; 6c CHOPCONF RW 31 0x0; 6d COOLCONF W 25 0x0; 6e DCCTRL W 24 0x0; 6f DRV_STATUS
        R 32 -; 70 PWMCONF W 22 0x50480; 71 PWM_SCALE R 8 -; 72 ENCM_CTRL W 2 0x0; 73 LOST_STEPS R 20 -
    """,
    "tmc5160": """
        00 GCONF RW 18 0x8; 01 GSTAT R+WC 3 -; 02 IFCNT R 8 -; 03 NODECONF W 12 0x0; 04 IOIN R 32 -; 04 OUTPUT W 1 0x1;
        05 X_COMPARE W s32 0x0; 06 OTP_PROG W 16 -; 07 OTP_READ R 8 -; 08 FACTORY_CONF RW 5 -; 09 SHORT_CONF W 19
        0x10606; 0a DRV_CONF W 22 0x400; 0b GLOBAL_SCALER W 8 0x0; 0c OFFSET_READ R 16 -; 10 IHOLD_IRUN W 20 0x0; 11
        TPOWERDOWN W 8 0xa; 12 TSTEP R 20 -; 13 TPWMTHRS W 20 0x0; 14 TCOOLTHRS W 20 0x0; 15 THIGH W 20 0x0; 20 RAMPMODE
        RW 2 0x0; 21 XACTUAL RW s32 0x0; 22 VACTUAL R s24 -; 23 VSTART W 18 0x0; 24 A1 W 16 0x0; 25 V1 W 20 0x0; 26 AMAX
        W 16 0x0; 27 VMAX W 23 0x0; 28 DMAX W 16 0x0; 2a D1 W 16 0x0; 2b VSTOP W 18 0x1; 2c TZEROWAIT W 16 0x0; 2d
        XTARGET RW s32 0x0; 33 VDCMIN W 23 0x0; 34 SW_MODE RW 12 0x0; 35 RAMP_STAT R+WC 14 -; 36 XLATCH R s32 -; 38
        ENCMODE RW 11 0x0; 39 X_ENC RW s32 0x0; 3a ENC_CONST W s32 0x10000; 3b ENC_STATUS R+WC 2 -; 3c ENC_LATCH R s32
        -; 3d ENC_DEVIATION W 20 0x0; 68 MSLUTSEL W 32 0xffff8056; 69 MSLUTSTART W 24 0xf70000; 6a MSCNT R 10 -; 6b
        MSCURACT R 25 -; 6c CHOPCONF RW 32 0x10410150; 6d COOLCONF W 25 0x0; 6e DCCTRL W 24 0x0; 6f DRV_STATUS R 32 -;
        70 PWMCONF W 32 0xc40c001e; 71 PWM_SCALE R 25 -; 72 PWM_AUTO R 24 -; 73 LOST_STEPS R 20 -
    """,
}
ALL_REGISTERS = {"tmc5031": 73, "tmc5062": 89, "tmc5072": 83, "tmc5130": 55, "tmc5160": 63}


def described(row: Register) -> str:
    access = "R+C" if row.read_clears else row.access.value
    reset = "-" if row.reset is None else f"{row.reset:#x}"
    return f"{row.address:02x} {row.name} {access} {'s' if row.signed else ''}{row.width} {reset}"


@EVERY
def test_every_word_of_the_first_axis_and_of_the_chip(model: str) -> None:
    wanted = [" ".join(word.split()) for word in WORDS[model].split(";")]
    rows = [row for row in TABLES[model] if row.axis != 1 and not row.name.startswith("MSLUT[")]
    assert [described(row) for row in rows] == wanted
    assert len(TABLES[model]) == ALL_REGISTERS[model]


@DUAL
def test_the_second_axis_is_the_first_one_further_on(model: str) -> None:
    table = TABLES[model]
    second = {row.name: row for row in table if row.axis == 1}
    first = {row.name: row for row in table if row.axis == 0}
    assert set(first) - set(second) == {"X_COMPARE"}, "only the first axis has a position compare"
    for name, row in second.items():
        start = first[name].address
        step = PWM_STEP if start < 0x20 else RAMP_STEP if start < 0x60 else DRIVER_STEP
        assert row.address == start + step
        assert (row.fields, row.width, row.signed, row.access, row.reset) == (
            first[name].fields,
            first[name].width,
            first[name].signed,
            first[name].access,
            first[name].reset,
        )
    assert second["XACTUAL"].address == 0x41
    assert second["CHOPCONF"].address == 0x7C


@EVERY
def test_which_chips_have_which_interfaces(model: str) -> None:
    known = MODELS[model]
    uarts = {"tmc5031": "", "tmc5062": "plain"}
    assert (known.kind, known.datagram_bits, known.uart) == ("chip", 40, uarts.get(model, "node"))
    assert (known.axes, known.clock_hz_default, known.clock_hz_max) == (AXES[model], 16e6, 18e6)
    names = {row.name for row in known.table}
    assert ("IFCNT" in names) == bool(known.uart)
    assert ("NODECONF" in names) == (known.uart == "node")


@EVERY
def test_the_microstep_table_is_the_tmc4361s_at_another_address(model: str) -> None:
    """Of the TMC5072 one for both axes; its numbers are those of the vendor's header."""
    rows = [row for row in TABLES[model] if row.name.startswith("MSLUT[")]
    both: list[int | None] = [0, 1]
    tables: dict[str, list[int | None]] = {"tmc5031": both, "tmc5062": both, "tmc5072": [None]}
    axes = tables.get(model, [0])
    assert {row.axis for row in rows} == set(axes)
    assert [row.reset for row in rows] == list(MSLUT_RESET) * len(axes)
    assert [row.address for row in rows] == [
        n for axis in axes for n in range(0x60 + 0x10 * (axis or 0), 0x68 + 0x10 * (axis or 0))
    ]
    assert TABLES[model].get("MSLUTSEL", 0).reset == TMC4361.get("MSLUTSEL", 0).reset


@EVERY
def test_pins_are_read_where_outputs_are_written(model: str) -> None:
    table = TABLES[model]
    read, written = table.at(0x04), table.at(0x04, write=True)
    assert read is not None
    assert written is not None
    assert read.name == ("IOIN" if AXES[model] == 1 else "INPUT")
    assert written.name == ("INPUT" if model == "tmc5031" else "OUTPUT")
    assert read.access is Access.R


@EVERY
def test_what_clears_by_reading_clears_by_writing_1_on_the_tmc5160(model: str) -> None:
    """AN-001 reads RAMP_STAT of the older chips to clear it; the TMC5160's data sheet gives it to writing."""
    clearing = {row.name for row in TABLES[model] if row.read_clears}
    by_writing = {row.name for row in TABLES[model] if row.access is Access.R_W1C}
    status = {"GSTAT", "RAMP_STAT"} | ({"ENC_STATUS"} if model != "tmc5031" else set())
    assert clearing == (set() if model == "tmc5160" else status)
    assert by_writing == (status if model == "tmc5160" else set())


def test_flags_that_are_as_things_are_cannot_be_cleared() -> None:
    """INFERRED which flags of RAMP_STAT stay: the latches', the stall stop, position reached, second move."""
    table = TABLES["tmc5160"]
    assert table.get("RAMP_STAT", 0).write_mask == 0b01_0000_1100_1100
    assert table.get("GSTAT").write_mask == 0b111


@EVERY
def test_ranges_that_a_width_does_not_tell(model: str) -> None:
    table = TABLES[model]
    assert table.get("VMAX", 0).range == (0, (1 << 23) - 512)
    mres = table.get("CHOPCONF", 0).field_named("mres")
    assert (mres is None) == (model == "tmc5031"), "the TMC5031 always makes 256 microsteps"
    if mres is not None:
        assert (mres.minimum, mres.maximum, mres.values[0], mres.values[8]) == (0, 8, "256", "1")


@EVERY
def test_packed_words_are_no_numbers_but_their_parts_are(model: str) -> None:
    """The sheets call MSCURACT signed: its two parts are. ENC_CONST is one number too, in 1/65536."""
    signed = {row.name for row in TABLES[model] if row.signed and row.fields}
    assert signed == (set() if model == "tmc5031" else {"ENC_CONST"})
    assert TABLES[model].get("MSCURACT", 0).unpack(0x01FF_0001) == {"CUR_B": 1, "CUR_A": -1}


@EVERY
def test_every_axis_answers_to_its_own_names(model: str) -> None:
    table = TABLES[model]
    for axis in range(AXES[model]):
        found = table.find("irun", axis)
        assert found is not None
        register, part = found
        assert (register.name, register.axis) == ("IHOLD_IRUN", axis)
        assert part is not None
        assert part.lsb == 8
        assert re.match(r"DS-TMC5\d{3} ", register.source)
    assert table.find("irun") is None, "which axis?"
