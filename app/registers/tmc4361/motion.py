"""Ramp generator, reference switches and positions of the TMC4361 (DS-TMC4361 8 and 9)."""

from __future__ import annotations

from ..build import RW, R, Rows, W, choice, flag
from ..model import Access, Field, Register
from .rows import (
    ACCELERATION_UNIT,
    BOW_UNIT,
    HEADERS,
    LOW_HIGH,
    MICROSTEPS,
    TOM,
    TOM_STEPPYR,
    TOM_TBONE,
    TOM_TBONE_STEPPYR,
    VELOCITY_UNIT,
)

_ramp = Rows("ramp", HEADERS)
_freeze = Rows("freeze", HEADERS)
_reference = Rows("reference", HEADERS)

RAMP_PROFILES = {0: "hold (rectangle)", 1: "trapezoid", 2: "S-shaped"}
DIRECT = "fCLK^2/2^37 with direct_acc_val_en"


def _velocity(name: str, address: int, meaning: str, source: str) -> Register:
    """An unsigned velocity of 23 bits and 8 fractional bits."""
    return _ramp(address, name, 31, RW, meaning, unit=VELOCITY_UNIT, source=f"DS-TMC4361 8; {source}")


def _acceleration(name: str, address: int, meaning: str, source: str, group: str = "ramp") -> Register:
    """An unsigned acceleration of 22 bits and 2 fractional bits, or in direct units."""
    section = "8, 8.2.3" if group == "ramp" else "8.2.3, 9, 9.1"
    row = Rows(group, f"DS-TMC4361 {section}; {source}")
    return row(address, name, 24, RW, f"{meaning}; {DIRECT}", unit=ACCELERATION_UNIT)


def _bow(number: int, meaning: str) -> Register:
    return _ramp(0x2C + number, f"BOW{number}", 24, RW, f"{meaning}; fCLK^3/2^53 with direct_bow_val_en").having(
        unit=BOW_UNIT, source=f"DS-TMC4361 8, 8.2.3; {TOM_TBONE_STEPPYR}"
    )


RAMP_ROWS = (
    _ramp(0x20, "RAMPMODE", 3, RW, "velocity or positioning, and the shape of ramps").having(
        choice(0, "RAMP_PROFILE", 2, "shape of ramps", RAMP_PROFILES, range=(0, 2)),
        choice(2, "OPERATION_MODE", 1, "what VMAX is", {0: "velocity mode", 1: "positioning mode"}),
        source=f"DS-TMC4361 8, 8.2; {TOM_TBONE_STEPPYR}",
    ),
    _ramp(0x21, "XACTUAL", 32, RW, "where the ramp generator is").having(
        signed=True, unit=MICROSTEPS, volatile=True, source=f"DS-TMC4361 8; {TOM_TBONE_STEPPYR}"
    ),
    _ramp(0x22, "VACTUAL", 32, R, "velocity now, without fractions").having(
        signed=True,
        unit="pps",
        volatile=True,
        source=f"DS-TMC4361 8.2.3 (32 bits; the table of 8 says 24); {TOM_TBONE_STEPPYR}",
    ),
    _ramp(0x23, "AACTUAL", 32, R, "acceleration now, without fractions").having(
        signed=True,
        unit="pps^2",
        volatile=True,
        source=f"DS-TMC4361 8, 8.2.3 (24 bits); {TOM_TBONE_STEPPYR} (32 bits, sign extended)",
    ),
    _ramp(
        0x24,
        "VMAX",
        32,
        RW,
        "velocity mode: target velocity with its sign; positioning: speed limit, whose sign does not count",
    ).having(signed=True, unit=VELOCITY_UNIT, source=f"DS-TMC4361 8, 8.2, 8.2.3; {TOM_TBONE_STEPPYR}"),
    _velocity("VSTART", 0x25, "speed at which a ramp begins, in both directions", TOM_TBONE_STEPPYR),
    _velocity("VSTOP", 0x26, "speed from which a ramp ends at once, in both directions", TOM_TBONE_STEPPYR),
    _velocity("VBREAK", 0x27, "below this speed a trapezoid uses ASTART and DFINAL; 0 for never", TOM_STEPPYR),
    _acceleration("AMAX", 0x28, "greatest acceleration", TOM_TBONE_STEPPYR),
    _acceleration("DMAX", 0x29, "greatest deceleration", TOM_TBONE_STEPPYR),
    _ramp(
        0x2A, "ASTART", 32, RW, f"acceleration with which an S-ramp begins, and of a trapezoid below VBREAK; {DIRECT}"
    ).having(
        Field("ASTART", 24, "the acceleration", unit=ACCELERATION_UNIT, lsb=0),
        choice(
            31,
            "SIGN_AACT",
            1,
            "sign that AACTUAL gets when the ramp takes over from STPIN (KMARX has it at bit 28)",
            {0: "positive", 1: "negative"},
        ),
        source=f"DS-TMC4361 8, 8.2, 8.2.3 (24 bits); {TOM_STEPPYR}",
    ),
    _acceleration(
        "DFINAL",
        0x2B,
        "deceleration with which an S-ramp ends in velocity mode, and of a trapezoid below VBREAK",
        TOM_STEPPYR,
    ),
    _bow(1, "jerk of bow B1: acceleration begins"),
    _bow(2, "jerk of bow B2: acceleration ends"),
    _bow(3, "jerk of bow B3: deceleration begins"),
    _bow(4, "jerk of bow B4: deceleration ends"),
    _ramp(0x37, "XTARGET", 32, RW, "where positioning goes").having(
        signed=True, unit=MICROSTEPS, source=f"DS-TMC4361 8; {TOM_TBONE_STEPPYR}"
    ),
    _ramp(0x7B, "TZEROWAIT", 32, W, "standstill before the next ramp after the velocity came to 0").having(
        unit="tCLK", source=f"{HEADERS} (unit inferred)"
    ),
    _freeze(0x4E, "FREEZE", 32, Access.RW_IF, "what happens when the pin NFREEZE goes low").having(
        Field("DFREEZE", 24, "deceleration; 0 stops at once", unit="fCLK^2/2^37 pps^2", lsb=0),
        Field("IFREEZE", 8, "current scale while frozen; 0 keeps the one before", lsb=24),
        write_note="taken once after a reset, before the first motion",
        source=f"{TOM} (TOM4361 calls it D_FREEZE); KMARX (fields)",
    ),
)

_STOP_MODES = {0: "reserved", 1: "at once", 2: "with DSTOP", 3: "reserved"}
_HOME_EVENTS = {
    0: "next N event of the encoder",
    2: "rising edge of an active high zone",
    3: "the level tells the side: low is negative",
    4: "falling edge of an active high zone",
    6: "centre of an active high zone",
    9: "centre of an active low zone",
    11: "rising edge of an active low zone",
    12: "the level tells the side: high is negative",
    13: "falling edge of an active low zone",
}

REFERENCE_ROWS = (
    _reference(0x01, "REFERENCE_CONF", 32, RW, "what switches, virtual stops, home and compare position do").having(
        flag(0, "stop_left_en", "STOPL stops motion to the left"),
        flag(1, "stop_right_en", "STOPR stops motion to the right"),
        choice(2, "pol_stop_left", 1, "level of an active STOPL", LOW_HIGH),
        choice(3, "pol_stop_right", 1, "level of an active STOPR", LOW_HIGH),
        flag(4, "invert_stop_direction", "STOPL and STOPR change their sides"),
        choice(5, "soft_stop_en", 1, "how a switch stops", {0: "at once", 1: "with DSTOP"}),
        flag(6, "virtual_left_limit_en", "VIRT_STOP_LEFT stops the motor"),
        flag(7, "virtual_right_limit_en", "VIRT_STOP_RIGHT stops the motor"),
        choice(8, "virt_stop_mode", 2, "how a virtual stop stops", _STOP_MODES),
        flag(10, "latch_x_on_inactive_l", "X_LATCH when STOPL becomes inactive"),
        flag(11, "latch_x_on_active_l", "X_LATCH when STOPL becomes active"),
        flag(12, "latch_x_on_inactive_r", "X_LATCH when STOPR becomes inactive"),
        flag(13, "latch_x_on_active_r", "X_LATCH when STOPR becomes active"),
        flag(14, "stop_left_is_home", "STOPL is the home switch too"),
        flag(15, "stop_right_is_home", "STOPR is the home switch too"),
        choice(16, "home_event", 4, "what is home", _HOME_EVENTS),
        flag(20, "start_home_tracking", "the next home event sets X_HOME"),
        flag(21, "clr_pos_at_target", "XACTUAL becomes 0 on arrival: endless cycles"),
        flag(22, "circular_movement_en", "positions wrap at X_RANGE"),
        choice(
            23,
            "pos_comp_output",
            2,
            "what the pin TARGET_REACHED shows",
            {0: "TARGET_REACHED_F", 1: "VEL_REACHED_F", 2: "ENC_FAIL_F", 3: "POS_COMP_REACHED_F"},
        ),
        choice(25, "pos_comp_source", 1, "position that is compared", {0: "XACTUAL", 1: "ENC_POS"}),
        flag(26, "stop_on_stall", "a stall above VSTALL_LIMIT stops at once"),
        flag(27, "drv_after_stall", "motion is allowed after the stall event was cleared"),
        choice(
            28,
            "modified_pos_compare",
            2,
            "what the position is compared with",
            {0: "POS_COMP", 1: "X_HOME", 2: "X_LATCH or ENC_LATCH", 3: "REV_CNT"},
        ),
        flag(
            30,
            "automatic_cover",
            "cover datagrams of their own at SPI_SWITCH_VEL",
            behaviour="the emulated driver keeps one configuration at all speeds",
        ),
        flag(31, "circular_enc_en", "ENC_POS wraps at X_RANGE too"),
        volatile=True,
        write_note="start_home_tracking returns to 0 by itself",
        source=f"DS-TMC4361 9, 9.1; {TOM_TBONE_STEPPYR} (bits)",
    ),
    _reference(
        0x1E, "HOME_SAFETY_MARGIN", 16, RW, "around X_HOME the home switch is not judged, so far to each side"
    ).having(unit=MICROSTEPS, source=f"DS-TMC4361 9; {TOM}"),
    _acceleration("DSTOP", 0x2C, "deceleration of soft stops by switches and virtual stops", TOM, "reference"),
    _reference(0x32, "POS_COMP", 32, RW, "position to compare with").having(
        signed=True, unit=MICROSTEPS, source=f"DS-TMC4361 9; {TOM_TBONE}"
    ),
    _reference(0x33, "VIRT_STOP_LEFT", 32, RW, "stops the motor at and left of here").having(
        signed=True, unit=MICROSTEPS, source=f"DS-TMC4361 9; {TOM_TBONE_STEPPYR}"
    ),
    _reference(0x34, "VIRT_STOP_RIGHT", 32, RW, "stops the motor at and right of here").having(
        signed=True,
        unit=MICROSTEPS,
        source=f"DS-TMC4361 9 (called left there, with the right comparison); {TOM_TBONE_STEPPYR}",
    ),
    _reference(0x35, "X_HOME", 32, RW, "position of home").having(
        signed=True, unit=MICROSTEPS, volatile=True, source=f"DS-TMC4361 9; {TOM}"
    ),
    _reference(0x36, "X_LATCH", 32, R, "XACTUAL at the latest edge that was to be latched").having(
        signed=True, unit=MICROSTEPS, volatile=True, source=f"DS-TMC4361 9 (RW there; a write is X_RANGE); {TOM_TBONE}"
    ),
    _reference(0x36, "REV_CNT", 32, R, "how often the position wrapped").having(
        signed=True, unit="revolutions", volatile=True, when="circular_cnt_as_xlatch is on"
    ),
    _reference(0x36, "X_RANGE", 32, W, "circular motion is from minus this to this minus 1", unit=MICROSTEPS),
    _reference(
        0x7C, "CIRCULAR_DEC", 32, W, "fraction of a microstep that a revolution has more than 2 * X_RANGE"
    ).having(unit="microsteps/2^31", source=f"{HEADERS}; REV310 (format)"),
)
