"""The TMC4361's register table against DS-TMC4361, and against itself where that ends."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.registers.catalog import MODELS
from app.registers.model import Access, Field, Register, RegisterTable
from app.registers.tmc4361.bits import (
    EVENT_BITS,
    EVENT_MASK,
    EVENTS,
    event_names,
    selected_events,
)
from app.registers.tmc4361.table import AXES, TMC4361

# Register tables of DS-TMC4361: name, address, access, width (fraction bits behind a plus), sign.
SECTION_7 = [
    ("STATUS_FLAGS", 0x0F, "R"),
    ("EVENTS", 0x0E, "R"),
    ("SPI_STATUS_SELECTION", 0x0B, "RW"),
    ("EVENT_CLEAR_CONF", 0x0C, "RW"),
    ("INTR_CONF", 0x0D, "RW"),
]
SECTION_8 = [
    ("GENERAL_CONF", 0x00, "RW", 32, False),
    ("RAMPMODE", 0x20, "RW", 3, False),
    ("XACTUAL", 0x21, "RW", 32, True),
    ("VMAX", 0x24, "RW", 24 + 8, True),
    ("VSTART", 0x25, "RW", 23 + 8, False),
    ("VSTOP", 0x26, "RW", 23 + 8, False),
    ("VBREAK", 0x27, "RW", 23 + 8, False),
    ("AMAX", 0x28, "RW", 22 + 2, False),
    ("DMAX", 0x29, "RW", 22 + 2, False),
    ("DFINAL", 0x2B, "RW", 22 + 2, False),
    ("BOW1", 0x2D, "RW", 24, False),
    ("BOW2", 0x2E, "RW", 24, False),
    ("BOW3", 0x2F, "RW", 24, False),
    ("BOW4", 0x30, "RW", 24, False),
    ("CLK_FREQ", 0x31, "RW", 25, False),
    ("XTARGET", 0x37, "RW", 32, True),
]
SECTION_9 = [
    ("REFERENCE_CONF", 0x01, False),
    ("HOME_SAFETY_MARGIN", 0x1E, False),
    ("DSTOP", 0x2C, False),
    ("POS_COMP", 0x32, True),
    ("VIRT_STOP_LEFT", 0x33, True),
    ("VIRT_STOP_RIGHT", 0x34, True),
    ("X_HOME", 0x35, True),
]


def test_one_axis_at_16_mhz_unless_told_otherwise() -> None:
    model = MODELS["tmc4361"]
    assert (model.axes, model.clock_hz_default, model.clock_hz_max) == (AXES, 16e6, 32e6)
    assert (model.kind, model.datagram_bits) == ("chip", 40)
    assert {register.axis for register in TMC4361} == {0}


@pytest.mark.sheet("DS-TMC4361", "5.1")
@pytest.mark.sheet("DS-TMC4361", "5.1.1")
@pytest.mark.sheet("DS-TMC4361", "17")
def test_addresses_have_seven_bits_and_only_one_is_unused() -> None:
    used = {register.address for register in TMC4361}
    assert used == set(range(0x80)) - {0x64}


@pytest.mark.sheet("DS-TMC4361", "5.1.2")
def test_every_register_begins_at_bit_0() -> None:
    for register in TMC4361:
        assert register.width <= 32
        if register.fields:
            assert min(part.lsb for part in register.fields) == 0


@pytest.mark.sheet("DS-TMC4361", "7")
@pytest.mark.parametrize(("name", "address", "access"), SECTION_7)
def test_registers_of_flags_and_events(name: str, address: int, access: str) -> None:
    register = TMC4361.get(name, 0)
    assert (register.address, register.access, register.width) == (address, access, 32)
    assert register.read_clears == (name == "EVENTS")


@pytest.mark.sheet("DS-TMC4361", "8")
@pytest.mark.sheet("DS-TMC4361", "17.16")
@pytest.mark.parametrize(("name", "address", "access", "width", "signed"), SECTION_8)
def test_registers_of_the_ramp_generator(name: str, address: int, access: str, width: int, signed: bool) -> None:
    register = TMC4361.get(name, 0)
    assert (register.address, register.access) == (address, access)
    assert (register.width, register.signed) == (width, signed)


@pytest.mark.sheet("DS-TMC4361", "8")
@pytest.mark.sheet("DS-TMC4361", "8.2.3")
def test_registers_whose_widths_the_sheet_and_later_sources_tell_differently() -> None:
    """VACTUAL is 24 bits in the table and 32 in the text; AACTUAL 24 bits, which later headers read as 32."""
    for name, address in (("VACTUAL", 0x22), ("AACTUAL", 0x23)):
        register = TMC4361.get(name, 0)
        assert (register.address, register.access, register.signed) == (address, Access.R, True)
        assert register.width == 32, "a number of 24 bits that is sign extended reads the same"
    astart = TMC4361.get("ASTART", 0)
    part = astart.field_named("ASTART")
    assert part is not None
    assert (astart.address, part.lsb, part.width, part.signed) == (0x2A, 0, 22 + 2, False)
    sign = astart.field_named("SIGN_AACT")
    assert sign is not None
    assert sign.lsb == 31, "an open question: another header of the vendor has bit 28"


@pytest.mark.sheet("DS-TMC4361", "8.1")
def test_two_times_of_sixteen_bits_share_a_word() -> None:
    register = TMC4361.get("STP_LENGTH_ADD___DIR_SETUP_TIME", 0)
    assert register.address == 0x10
    assert [(part.name, part.lsb, part.width) for part in register.fields] == [
        ("STP_LENGTH_ADD", 0, 16),
        ("DIR_SETUP_TIME", 16, 16),
    ]
    assert register.reset == 0, "an open question: an older table of the vendor's has 0x00040001"


@pytest.mark.sheet("DS-TMC4361", "8.1")
@pytest.mark.sheet("DS-TMC4361", "8.2.3")
def test_bits_of_general_conf_that_the_ramp_generator_has() -> None:
    register = TMC4361.get("GENERAL_CONF", 0)
    assert [part.name for part in register.fields if 1 <= part.lsb <= 5] == [
        "direct_acc_val_en",
        "direct_bow_val_en",
        "step_inactive_pol",
        "toggle_step",
        "pol_dir_out",
    ]


@pytest.mark.sheet("DS-TMC4361", "8.2")
def test_ramp_modes() -> None:
    register = TMC4361.get("RAMPMODE", 0)
    assert register.unpack(0b110) == {"RAMP_PROFILE": 2, "OPERATION_MODE": 1}
    profile, mode = register.fields
    assert profile.values == {0: "hold (rectangle)", 1: "trapezoid", 2: "S-shaped"}
    assert mode.values == {0: "velocity mode", 1: "positioning mode"}
    with pytest.raises(ValueError, match="RAMP_PROFILE is 0"):
        profile.encode(3)


@pytest.mark.sheet("DS-TMC4361", "1.4")
@pytest.mark.sheet("DS-TMC4361", "8.2.3")
def test_the_clock_is_between_4_2_and_32_mhz() -> None:
    register = TMC4361.get("CLK_FREQ", 0)
    assert register.range == (4_194_304, 32_000_000)
    assert register.reset == 16_000_000


@pytest.mark.sheet("DS-TMC4361", "9")
@pytest.mark.parametrize(("name", "address", "signed"), SECTION_9)
def test_registers_of_reference_switches(name: str, address: int, signed: bool) -> None:
    register = TMC4361.get(name, 0)
    assert (register.address, register.signed) == (address, signed)
    assert register.access is Access.RW


@pytest.mark.sheet("DS-TMC4361", "9")
def test_an_open_question_x_latch_is_read_and_x_range_written() -> None:
    """DS-TMC4361 calls X_LATCH readable and writable; later sources have another register behind the write."""
    assert TMC4361.at(0x36) is TMC4361.get("X_LATCH", 0)
    assert TMC4361.at(0x36, write=True) is TMC4361.get("X_RANGE", 0)
    assert [row.name for row in TMC4361.meanings(0x36)] == ["X_LATCH", "REV_CNT", "X_RANGE"]


@pytest.mark.sheet("DS-TMC4361", "9.1")
def test_switches_of_reference_conf() -> None:
    word = TMC4361.get("REFERENCE_CONF", 0).unpack(0b10_1011)
    names = ("stop_left_en", "stop_right_en", "pol_stop_left", "pol_stop_right", "soft_stop_en")
    assert [word[name] for name in names] == [1, 1, 0, 1, 1]


@pytest.mark.sheet("DS-TMC4361", "1.3.4")
def test_the_pwm_frequency_is_the_clock_over_pwm_freq() -> None:
    register = TMC4361.get("PWM_FREQ", 0)
    assert (register.address, register.unit) == (0x1F, "tCLK")
    assert 16e6 / (register.reset or 0) == 25e3


@pytest.mark.sheet("DS-TMC4361", "6")
def test_the_filter_register() -> None:
    register = TMC4361.get("INPUT_FILT_CONF", 0)
    assert (register.address, register.access) == (0x03, Access.RW)
    assert register.mask == 0xF7F7F7F7


RESETS = {
    "GENERAL_CONF": 0x6020,
    "SCALE_VALUES": 0xFFFFFFFF,
    "ENC_IN_CONF": 0x400,
    "STEP_CONF": 0xFB0C80,
    "SPI_STATUS_SELECTION": 0x82029805,
    "GEAR_RATIO": 0x1000000,
    "CL_ANGLES": 0xFF00FF,
    "PWM_FREQ": 0x280,
    "CLK_FREQ": 0xF42400,
    "ENC_POS_DEV_TOL": 0x7FFFFFFF,
    "SER_CLK_IN_HIGH_LOW": 0xA000A0,
    "SSI_IN_CLK_DELAY___SSI_IN_WTIME": 0xF00000,
    "SER_PTIME": 0x190,
    "ENC_VEL_ZERO": 0xFFFFFF,
    "MSLUTSEL": 0xFFFF8056,
    "START_SIN___START_SIN90_120___DAC_OFFSET": 0xF70000,
    "CURRENTA_B": 0xF70000,
    "CURRENTA_B_SPI": 0xF70000,
}


@pytest.mark.sheet("DS-TMC4361", "17")
def test_registers_that_reset_to_something() -> None:
    found = {row.name: row.reset for row in TMC4361 if row.reset and not row.name.startswith("MSLUT[") and not row.when}
    assert found == RESETS
    step = TMC4361.get("STEP_CONF", 0).unpack(RESETS["STEP_CONF"])
    assert (step["mstep_per_fs"], step["fs_per_rev"]) == (0, 200), "256 microsteps, 200 full steps"


@pytest.mark.sheet("DS-TMC4361", "17")
def test_two_registers_at_one_address_are_told_apart_by_the_write_bit() -> None:
    pairs = {
        row.address: (row.name, other.name)
        for row in TMC4361
        if (other := TMC4361.at(row.address, write=True)) is not None and TMC4361.at(row.address) is row is not other
    }
    assert pairs == {
        0x36: ("X_LATCH", "X_RANGE"),
        0x51: ("ENC_LATCH", "ENC_RESET_VAL"),
        0x52: ("ENC_POS_DEV", "CL_TR_TOLERANCE"),
        0x54: ("ENC_CONST", "ENC_IN_RES"),
        0x5A: ("PID_VEL", "PID_P"),
        0x5B: ("PID_ISUM_RD", "PID_I"),
        0x5D: ("PID_E", "PID_I_CLIP___PID_D_CLKDIV"),
        0x6C: ("POLLING_STATUS", "COVER_LOW"),
        0x6D: ("POLLING_REG", "COVER_HIGH"),
        0x79: ("MSCNT", "MSOFFSET"),
        0x7B: ("CURRENTA_B_SPI", "TZEROWAIT"),
        0x7C: ("SCALE_PARAM", "CIRCULAR_DEC"),
    }
    assert TMC4361.at(0x64) is TMC4361.at(0x64, write=True) is None


@pytest.mark.sheet("DS-TMC4361", "17")
def test_words_with_a_second_name_say_when_it_holds() -> None:
    second = {row.name: row.address for row in TMC4361 if row.when}
    assert second == {
        "PWM_VMAX": 0x17,
        "CL_UPSCALE_DELAY": 0x18,
        "CL_DNSCALE_DELAY": 0x19,
        "DAC_ADDR": 0x1D,
        "CHOPSYNC_DIV": 0x1F,
        "REV_CNT": 0x36,
        "CL_VMAX_CALC_P": 0x5A,
        "CL_VMAX_CALC_I": 0x5B,
        "CL_DELTA_P": 0x5C,
        "CL_TOLERANCE": 0x5F,
        "DC_VEL": 0x60,
        "CL_VMIN_EMF": 0x60,
        "CL_VADD_EMF": 0x61,
        "DC_LSPTM": 0x62,
        "SER_ENC_VARIATION___CL_CYCLE": 0x63,
    }


def test_what_the_emulator_does_not_act_on_says_why() -> None:
    silent = [row.name for row in TMC4361 if row.behaviour]
    assert {"SPI_SWITCH_VEL", "POLLING_REG"} <= set(silent)
    acted_on = {
        "VMAX",
        "BOW1",
        "XTARGET",
        "ENC_POS",
        "PID_P",
        "CL_DELTA_P",
        "START_CONF",
        "CHOPSYNC_DIV",
        "DC_VEL",
        "DAC_ADDR",
    }
    assert not acted_on & set(silent)
    for row in TMC4361:
        for part in (row, *row.fields):
            assert not part.behaviour.endswith(".")


@pytest.mark.sheet("DS-TMC4361", "1.6")
@pytest.mark.sheet("DS-TMC4361", "7.2")
@pytest.mark.sheet("DS-TMC4361", "17.12")
@pytest.mark.sheet("DS-TMC4361", "17.13")
@pytest.mark.parametrize("name", ["SPI_STATUS_SELECTION", "EVENT_CLEAR_CONF", "INTR_CONF", "EVENTS"])
def test_registers_that_select_events_have_the_events_bits(name: str) -> None:
    register = TMC4361.get(name, 0)
    assert {part.name: part.lsb for part in register.fields if part.name != "reserved"} == dict(EVENT_BITS)
    assert EVENT_MASK == 0xFFFFFFFF & ~(1 << 22)
    if register.access.writable:
        assert register.write_mask == 0xFFFFFFFF, "all events are selected by 0xFFFFFFFF"


@pytest.mark.sheet("DS-TMC4361", "7.2")
def test_every_combination_of_a_state_has_its_event() -> None:
    """VEL_STATE has two bits and three events, 00, 01 and 10; RAMP_STATE too."""
    assert [EVENTS[bit][0] for bit in range(3, 9)] == [
        f"{state}_STATE_{code}" for state in ("VEL", "RAMP") for code in ("00", "01", "10")
    ]
    status = TMC4361.get("STATUS_FLAGS", 0)
    for name in ("VEL_STATE_F", "RAMP_STATE_F"):
        part = status.field_named(name)
        assert part is not None
        assert (part.width, part.range) == (2, (0, 2))


STATUS_BITS = {
    "TARGET_REACHED_F": 0,
    "POS_COMP_REACHED_F": 1,
    "VEL_REACHED_F": 2,
    "VEL_STATE_F": 3,
    "RAMP_STATE_F": 5,
    "STOPL_ACTIVE_F": 7,
    "STOPR_ACTIVE_F": 8,
    "VSTOPL_ACTIVE_F": 9,
    "VSTOPR_ACTIVE_F": 10,
    "ACTIVE_STALL_F": 11,
    "HOME_ERROR_F": 12,
    "FS_ACTIVE_F": 13,
    "ENC_FAIL_F": 14,
    "N_ACTIVE_F": 15,
    "ENC_LATCH_F": 16,
    "MULTI_CYCLE_FAIL_F": 17,
    "SER_ENC_VAR_F": 17,
    "CL_FIT_F": 19,
    "SERIAL_ENC_FLAG[0]": 20,
    "SERIAL_ENC_FLAG[1]": 21,
    "SERIAL_ENC_FLAG[2]": 22,
    "SERIAL_ENC_FLAG[3]": 23,
    "SG": 24,
    "UV_SF": 24,
    "OT": 25,
    "OTPW": 26,
    "S2GA": 27,
    "OCA": 27,
    "S2GB": 28,
    "OCB": 28,
    "OLA": 29,
    "OLB": 30,
    "STST": 31,
    "OCHS": 31,
}
"""Lowest bit of each flag of STATUS_FLAGS. Where two share a bit, what is connected decides."""


@pytest.mark.sheet("DS-TMC4361", "7.1")
@pytest.mark.sheet("DS-TMC4361", "17.14")
def test_status_bits_are_the_fields_of_their_register() -> None:
    status = TMC4361.get("STATUS_FLAGS", 0)
    assert {part.name: part.lsb for part in status.fields} == STATUS_BITS
    assert status.mask == 0xFFFFFFFF & ~(1 << 18)


@pytest.mark.sheet("DS-TMC4361", "7.2")
def test_the_status_byte_after_a_reset() -> None:
    selection = TMC4361.get("SPI_STATUS_SELECTION", 0).reset or 0
    shown = [EVENTS[bit][0] for bit in selected_events(selection)]
    assert shown == [
        "TARGET_REACHED",
        "VEL_REACHED",
        "STOPL_EVENT",
        "STOPR_EVENT",
        "HOME_ERROR",
        "FS_ACTIVE",
        "COVER_DONE",
        "RST_EV",
    ]


@pytest.mark.sheet("DS-TMC4361", "7.2")
@given(st.integers(0, 0xFFFF_FFFF))
def test_the_first_eight_selected_events_make_the_status_byte(selection: int) -> None:
    """Against the sheet's words: sorted by bit position, and beyond eight the first eight, from index 0."""
    chosen = [bit for bit in range(32) if f"{selection:032b}"[31 - bit] == "1"][:8]
    assert list(selected_events(selection)) == chosen


@given(st.sets(st.sampled_from(sorted(EVENT_BITS))))
def test_names_of_events(names: set[str]) -> None:
    word = sum(1 << EVENT_BITS[name] for name in names)
    assert set(event_names(word)) == names
    assert event_names(word | 1 << 22) == event_names(word)


def test_a_second_meaning_may_overlap_but_not_another_of_the_same_condition() -> None:
    plain, other = Field("a", 4, "h"), Field("b", 8, "h", when="another driver")
    assert Register("r", 8, "h", source="s", fields=(plain, other)).mask == 0xFF
    with pytest.raises(ValueError, match="overlaps"):
        Register("r", 8, "h", source="s", fields=(other, Field("c", 1, "h", when="another driver")))


def test_a_second_name_needs_a_row_that_it_is_a_name_of() -> None:
    with pytest.raises(ValueError, match="no row"):
        RegisterTable("chip", (Register("r", 8, "h", address=1, source="s", when="sometimes"),))


def test_no_help_repeats_a_register_of_another_chip_by_mistake() -> None:
    """Names of registers inside of helps are those of this chip: a word in capitals with an underscore is one."""
    known = {row.name for row in TMC4361} | {part.name for row in TMC4361 for part in row.fields}
    known |= {"HOME_REF", "STDBY_CLK", "TARGET_REACHED", "CLK_EXT"}  # pins
    for row in TMC4361:
        for part in (row, *row.fields):
            for word in re.findall(r"\b[A-Z][A-Z0-9]*(?:_[A-Z0-9]+)+\b", part.help):
                assert word in known or word.casefold() in known, (row.name, word)
