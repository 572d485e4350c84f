"""Ramp generator, switches, speed thresholds and encoder of the TMC5xxx, as their first axis has them."""

from __future__ import annotations

from ..build import RW, R, Rows, W, choice, flag, state
from ..model import Access, Field, Register
from .rows import (
    ACCELERATION_UNIT,
    ACTIVE_LEVEL,
    CLOCKS,
    DELAY_UNIT,
    LOW_HIGH,
    MICROSTEPS,
    SCALE_UNIT,
    VELOCITY_UNIT,
    VENDOR,
    clearing,
)

_ramp = Rows("ramp", VENDOR)
_switches = Rows("switches", VENDOR)
_current = Rows("current", VENDOR)
_thresholds = Rows("thresholds", VENDOR)
_encoder = Rows("encoder", VENDOR)

VELOCITY_MAX = (1 << 23) - 512
"""VMAX: the ramp generator goes no faster [velocity units]."""
RAMP_MODES = {0: "positioning", 1: "velocity, positive", 2: "velocity, negative", 3: "hold"}


def _velocity(name: str, address: int, width: int, help_: str, reset: int = 0, highest: int | None = None) -> Register:
    return _ramp(
        address, name, width, W, help_, unit=VELOCITY_UNIT, range=None if highest is None else (0, highest), reset=reset
    )


def _acceleration(name: str, address: int, help_: str) -> Register:
    return _ramp(address, name, 16, W, help_, unit=ACCELERATION_UNIT)


def _position(
    name: str, address: int, help_: str, access: Access = RW, group: str = "ramp", volatile: bool = False
) -> Register:
    return Rows(group, VENDOR)(address, name, 32, access, help_).having(
        signed=True, unit=MICROSTEPS, reset=0 if access.writable else None, volatile=volatile
    )


def ramp_rows(vstop_reset: int = 0) -> tuple[Register, ...]:
    """0x20 to 0x2D. vstop_reset: 1 of the TMC5160, 0 of the others."""
    return (
        _ramp(0x20, "RAMPMODE", 2, RW, "what the ramp generator does", values=RAMP_MODES),
        _position(
            "XACTUAL", 0x21, "position now; written while positioning, the motor sets off to XTARGET", volatile=True
        ),
        _ramp.reading(0x22, "VACTUAL", 24, "velocity now", unit=VELOCITY_UNIT, signed=True),
        _velocity("VSTART", 0x23, 18, "velocity with which a motion begins"),
        _acceleration("A1", 0x24, "acceleration from VSTART to V1"),
        _velocity("V1", 0x25, 20, "velocity between the two slopes each way; 0 leaves A1 and D1 out"),
        _acceleration("AMAX", 0x26, "acceleration from V1 to VMAX; in velocity modes the only slope, up and down"),
        _velocity("VMAX", 0x27, 23, "highest velocity; not below VSTART", highest=VELOCITY_MAX),
        _acceleration("DMAX", 0x28, "deceleration from VMAX to V1"),
        _acceleration("D1", 0x2A, "deceleration from V1 to VSTOP; never 0 while positioning, not even with V1 = 0"),
        _velocity(
            "VSTOP",
            0x2B,
            18,
            "velocity that a motion ends from; never 0, not below VSTART, better 10 or more",
            reset=vstop_reset,
        ),
        _ramp(0x2C, "TZEROWAIT", 16, W, "rest at standstill before the motor sets off again", unit="512 tCLK"),
        _position("XTARGET", 0x2D, "target of positioning; at most 2^31 - 1 from where the motor is"),
    )


VDCMIN = _velocity("VDCMIN", 0x33, 23, "from here on DcStep slows down under load; 0 never, bits 7..0 do not count")
XLATCH = _position(
    "XLATCH",
    0x36,
    "XACTUAL when a switch or the index channel last latched it; the vendor's headers read it unsigned",
    R,
    "switches",
    volatile=True,
)

_SWITCH_BITS = (
    flag(0, "stop_l_enable", "the left switch stops motion to the left"),
    flag(1, "stop_r_enable", "the right switch stops motion to the right"),
    choice(2, "pol_stop_l", 1, "level of the left switch", ACTIVE_LEVEL),
    choice(3, "pol_stop_r", 1, "level of the right switch", ACTIVE_LEVEL),
    flag(4, "swap_lr", "left and right switch change places"),
    flag(5, "latch_l_active", "XLATCH takes the position where the left switch becomes active"),
    flag(6, "latch_l_inactive", "XLATCH takes the position where the left switch becomes inactive"),
    flag(7, "latch_r_active", "XLATCH takes the position where the right switch becomes active"),
    flag(8, "latch_r_inactive", "XLATCH takes the position where the right switch becomes inactive"),
)
_LATCH_ENCODER = flag(9, "en_latch_encoder", "ENC_LATCH takes the encoder position with XLATCH")
_STOP_BITS = (
    flag(10, "sg_stop", "StallGuard stops the motor; not together with en_softstop"),
    choice(11, "en_softstop", 1, "how a switch stops the motor", {0: "at once", 1: "with DMAX, V1, D1"}),
)


def _sw_mode(*fields: Field) -> Register:
    return _switches(0x34, "SW_MODE", 12, RW, "what switches and StallGuard do to a motion").having(*fields)


SW_MODE = _sw_mode(*_SWITCH_BITS, _LATCH_ENCODER, *_STOP_BITS)
SW_MODE_NO_ENCODER = _sw_mode(*_SWITCH_BITS, *_STOP_BITS)


def _now(lsb: int, name: str, help_: str) -> Field:
    """A flag that is as things are, and that nobody can clear."""
    return state(lsb, name, help_, access=R)


def ramp_stat(write_clears: bool) -> Register:
    """RAMP_STAT. write_clears: writing 1 clears the flags that stay (TMC5160); else reading does."""
    cleared = "the latches' flags, event_stop_sg, event_pos_reached and second_move"
    help_ = "where the ramp is and what has happened"
    return clearing("ramp", 0x35, "RAMP_STAT", 14, help_, write_clears, cleared).having(
        _now(0, "status_stop_l", "the left switch is active"),
        _now(1, "status_stop_r", "the right switch is active"),
        state(2, "status_latch_l", "the left switch has latched a position"),
        state(3, "status_latch_r", "the right switch has latched a position"),
        _now(4, "event_stop_l", "the left switch holds the motor; ends with the switch or the other way"),
        _now(5, "event_stop_r", "the right switch holds the motor; ends with the switch or the other way"),
        state(6, "event_stop_sg", "StallGuard has stopped the motor; cleared, it may go on"),
        state(7, "event_pos_reached", "the target was reached"),
        _now(8, "velocity_reached", "VACTUAL is VMAX"),
        _now(9, "position_reached", "XACTUAL is XTARGET"),
        _now(10, "vzero", "the velocity is 0"),
        _now(11, "t_zerowait_active", "the motor rests for TZEROWAIT"),
        state(12, "second_move", "the motor had to come back to its target"),
        _now(13, "status_sg", "StallGuard sees a stall"),
    )


# --- current and thresholds ---------------------------------------------------------------------


def ihold_irun(address: int) -> Register:
    """0x10 of the single-axis chips, 0x30 of the others."""
    return _current(address, "IHOLD_IRUN", 20, W, "motor current in motion and at rest").having(
        Field("IHOLD", 5, "scale of the current at rest", unit=SCALE_UNIT, lsb=0),
        Field("IRUN", 5, "scale of the current in motion", unit=SCALE_UNIT, lsb=8),
        Field("IHOLDDELAY", 4, "time for each step down from IRUN to IHOLD; 0 at once", unit=DELAY_UNIT, lsb=16),
    )


def _clocks(name: str, address: int, help_: str) -> Register:
    return _thresholds(address, name, 20, W, help_, unit=CLOCKS)


def time_threshold_rows(powerdown_reset: int, powerdown_help: str) -> tuple[Register, ...]:
    """0x11 to 0x15 of the single-axis chips: thresholds that count the clocks of a microstep."""
    return (
        _current(0x11, "TPOWERDOWN", 8, W, powerdown_help, unit=DELAY_UNIT, reset=powerdown_reset),
        _thresholds.reading(
            0x12, "TSTEP", 20, "time between two of 256 microsteps a full step now; 2^20 - 1 at rest"
        ).having(unit=CLOCKS),
        _clocks("TPWMTHRS", 0x13, "StealthChop while TSTEP is not below this; 0 at every velocity"),
        _clocks("TCOOLTHRS", 0x14, "CoolStep and StallGuard while TSTEP is not above this; 0 never"),
        _clocks("THIGH", 0x15, "vhighchm and vhighfs while TSTEP is not above this; 0 never"),
    )


def _threshold(name: str, address: int, help_: str) -> Register:
    return _thresholds(address, name, 23, W, help_, unit=VELOCITY_UNIT)


VELOCITY_THRESHOLDS = (
    _threshold(
        "VCOOLTHRS",
        0x31,
        "StealthChop below, CoolStep and StallGuard from this velocity on; 0 always; bits 7..0 do not count",
    ),
    _threshold(
        "VHIGH", 0x32, "vhighchm and vhighfs from this velocity on, no CoolStep; 0 always; bits 7..0 do not count"
    ),
)
"""Of the chips with two axes: thresholds in units of velocity."""

# --- encoder ------------------------------------------------------------------------------------

_LATCH_NOW = flag(11, "latch_now", "this write latches both positions at once")


def _encmode(*more: Field) -> Register:
    return _encoder(
        0x38, "ENCMODE", 11 + len(more), RW, "what the encoder's index channel does, and how ENC_CONST counts"
    ).having(
        choice(0, "pol_A", 1, "level of A at an event of the index channel", LOW_HIGH),
        choice(1, "pol_B", 1, "level of B at an event of the index channel", LOW_HIGH),
        choice(2, "pol_N", 1, "active level of the index channel", LOW_HIGH),
        flag(3, "ignore_AB", "A and B do not matter to an event"),
        flag(4, "clr_cont", "each event latches (and clears, with clr_enc_x)"),
        flag(5, "clr_once", "the next event latches (and clears, with clr_enc_x), the chip then takes the bit back"),
        flag(6, "pos_edge", "the index channel's becoming active is an event"),
        flag(7, "neg_edge", "the index channel's becoming inactive is an event"),
        flag(8, "clr_enc_x", "an event clears X_ENC after latching it"),
        flag(9, "latch_x_act", "an event latches XACTUAL too"),
        choice(10, "enc_sel_decimal", 1, "how the fraction of ENC_CONST counts", {0: "1/65536", 1: "1/10000"}),
        *more,
        volatile=True,
        source=f"{VENDOR}; pos_edge and neg_edge: the data sheet alone",
    )


def _enc_const(reset: int) -> Register:
    return _encoder(
        0x3A, "ENC_CONST", 32, W, "microsteps for each edge of the encoder; its sign is the way it counts"
    ).having(
        Field("FRACTIONAL", 16, "fraction, as enc_sel_decimal counts it", lsb=0),
        Field("INTEGER", 16, "whole microsteps, with the sign", signed=True, lsb=16),
        signed=True,
        unit="1/65536 or 1/10000 microsteps",
        reset=reset,
        source=f"{VENDOR}, which read it unsigned, and alone tell its parts",
    )


def _enc_status(write_clears: bool) -> Register:
    events: tuple[Field, ...] = (state(0, "n_event", "the index channel had an event"),)
    if write_clears:
        events += (state(1, "deviation_warn", "X_ENC was farther from XACTUAL than ENC_DEVIATION"),)
    return clearing("encoder", 0x3B, "ENC_STATUS", len(events), "what the encoder saw", write_clears).having(*events)


def _encoder_rows(encmode: Register, const_reset: int, write_clears: bool) -> tuple[Register, ...]:
    return (
        encmode,
        _position("X_ENC", 0x39, "position of the encoder", group="encoder", volatile=True),
        _enc_const(const_reset),
        _enc_status(write_clears),
        _position("ENC_LATCH", 0x3C, "X_ENC at the last event", R, "encoder", volatile=True),
    )


ENCODER_5062 = _encoder_rows(_encmode(), 0x10000, write_clears=False)
ENCODER_5072 = _encoder_rows(_encmode(_LATCH_NOW), 0x10000, write_clears=False)
ENCODER_5130 = _encoder_rows(_encmode(), 0, write_clears=False)
"""ENC_CONST resets to 0 by the data sheet, to 1.0 by API."""
ENCODER_5160 = (
    *_encoder_rows(_encmode(), 0x10000, write_clears=True),
    _encoder(
        0x3D, "ENC_DEVIATION", 20, W, "greatest distance of X_ENC from XACTUAL without a warning; 0 never warns"
    ).having(unit=MICROSTEPS, source=VENDOR),
)
