"""Ramp generator, reference switches and positions of the TMC4361 (DS-TMC4361 8 and 9)."""

from __future__ import annotations

from ..model import Access, Field, Register
from .rows import (
    ACCELERATION_UNIT,
    BOW_UNIT,
    HEADERS,
    LOW_HIGH,
    MICROSTEPS,
    OFF_ON,
    TOM,
    TOM_STEPPYR,
    TOM_TBONE,
    TOM_TBONE_STEPPYR,
    VELOCITY_UNIT,
)

RAMP_PROFILES = {0: "hold (rectangle)", 1: "trapezoid", 2: "S-shaped"}
DIRECT = "fCLK^2/2^37 with direct_acc_val_en"


def _velocity(name: str, address: int, meaning: str, source: str) -> Register:
    """An unsigned velocity of 23 bits and 8 fractional bits."""
    return Register(
        name, 31, meaning, unit=VELOCITY_UNIT, address=address, group="ramp", source=f"DS-TMC4361 8; {source}"
    )


def _acceleration(name: str, address: int, meaning: str, source: str, group: str = "ramp") -> Register:
    """An unsigned acceleration of 22 bits and 2 fractional bits, or in direct units."""
    section = "8, 8.2.3" if group == "ramp" else "8.2.3, 9, 9.1"
    return Register(
        name,
        24,
        f"{meaning}; {DIRECT}",
        unit=ACCELERATION_UNIT,
        address=address,
        group=group,
        source=f"DS-TMC4361 {section}; {source}",
    )


def _bow(number: int, meaning: str) -> Register:
    return Register(
        f"BOW{number}",
        24,
        f"{meaning}; fCLK^3/2^53 with direct_bow_val_en",
        unit=BOW_UNIT,
        address=0x2C + number,
        group="ramp",
        source=f"DS-TMC4361 8, 8.2.3; {TOM_TBONE_STEPPYR}",
    )


def _position(
    name: str,
    address: int,
    meaning: str,
    source: str,
    access: Access = Access.RW,
    volatile: bool = False,
    group: str = "reference",
) -> Register:
    return Register(
        name,
        32,
        meaning,
        signed=True,
        unit=MICROSTEPS,
        address=address,
        access=access,
        volatile=volatile,
        group=group,
        source=source,
    )


RAMP_ROWS = (
    Register(
        "RAMPMODE",
        3,
        "velocity or positioning, and the shape of ramps",
        address=0x20,
        group="ramp",
        source=f"DS-TMC4361 8, 8.2; {TOM_TBONE_STEPPYR}",
        fields=(
            Field("RAMP_PROFILE", 2, "shape of ramps", lsb=0, range=(0, 2), values=RAMP_PROFILES),
            Field("OPERATION_MODE", 1, "what VMAX is", lsb=2, values={0: "velocity mode", 1: "positioning mode"}),
        ),
    ),
    _position(
        "XACTUAL",
        0x21,
        "where the ramp generator is",
        f"DS-TMC4361 8; {TOM_TBONE_STEPPYR}",
        volatile=True,
        group="ramp",
    ),
    Register(
        "VACTUAL",
        32,
        "velocity now, without fractions",
        signed=True,
        unit="pps",
        address=0x22,
        access=Access.R,
        volatile=True,
        group="ramp",
        source=f"DS-TMC4361 8.2.3 (32 bits; the table of 8 says 24); {TOM_TBONE_STEPPYR}",
    ),
    Register(
        "AACTUAL",
        32,
        "acceleration now, without fractions",
        signed=True,
        unit="pps^2",
        address=0x23,
        access=Access.R,
        volatile=True,
        group="ramp",
        source=f"DS-TMC4361 8, 8.2.3 (24 bits); {TOM_TBONE_STEPPYR} (32 bits, sign extended)",
    ),
    Register(
        "VMAX",
        32,
        "velocity mode: target velocity with its sign; positioning: speed limit, whose sign does not count",
        signed=True,
        unit=VELOCITY_UNIT,
        address=0x24,
        group="ramp",
        source=f"DS-TMC4361 8, 8.2, 8.2.3; {TOM_TBONE_STEPPYR}",
    ),
    _velocity("VSTART", 0x25, "speed at which a ramp begins, in both directions", TOM_TBONE_STEPPYR),
    _velocity("VSTOP", 0x26, "speed from which a ramp ends at once, in both directions", TOM_TBONE_STEPPYR),
    _velocity("VBREAK", 0x27, "below this speed a trapezoid uses ASTART and DFINAL; 0 for never", TOM_STEPPYR),
    _acceleration("AMAX", 0x28, "greatest acceleration", TOM_TBONE_STEPPYR),
    _acceleration("DMAX", 0x29, "greatest deceleration", TOM_TBONE_STEPPYR),
    Register(
        "ASTART",
        32,
        f"acceleration with which an S-ramp begins, and of a trapezoid below VBREAK; {DIRECT}",
        address=0x2A,
        group="ramp",
        source=f"DS-TMC4361 8, 8.2, 8.2.3 (24 bits); {TOM_STEPPYR}",
        fields=(
            Field("ASTART", 24, "the acceleration", unit=ACCELERATION_UNIT, lsb=0),
            Field(
                "SIGN_AACT",
                1,
                "sign that AACTUAL gets when the ramp takes over from STPIN (KMARX has it at bit 28)",
                values={0: "positive", 1: "negative"},
                lsb=31,
            ),
        ),
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
    _position(
        "XTARGET",
        0x37,
        "where positioning goes",
        f"DS-TMC4361 8; {TOM_TBONE_STEPPYR}",
        group="ramp",
    ),
    Register(
        "TZEROWAIT",
        32,
        "standstill before the next ramp after the velocity came to 0",
        unit="tCLK",
        address=0x7B,
        access=Access.W,
        group="ramp",
        source=f"{HEADERS} (unit inferred)",
    ),
    Register(
        "FREEZE",
        32,
        "what happens when the pin NFREEZE goes low",
        address=0x4E,
        access=Access.RW_IF,
        group="freeze",
        write_note="taken once after a reset, before the first motion",
        source=f"{TOM} (TOM4361 calls it D_FREEZE); KMARX (fields)",
        fields=(
            Field("DFREEZE", 24, "deceleration; 0 stops at once", unit="fCLK^2/2^37 pps^2", lsb=0),
            Field("IFREEZE", 8, "current scale while frozen; 0 keeps the one before", lsb=24),
        ),
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
    Register(
        "REFERENCE_CONF",
        32,
        "what switches, virtual stops, home and compare position do",
        address=0x01,
        group="reference",
        volatile=True,
        write_note="start_home_tracking returns to 0 by itself",
        source=f"DS-TMC4361 9, 9.1; {TOM_TBONE_STEPPYR} (bits)",
        fields=(
            Field("stop_left_en", 1, "STOPL stops motion to the left", lsb=0, values=OFF_ON),
            Field("stop_right_en", 1, "STOPR stops motion to the right", lsb=1, values=OFF_ON),
            Field("pol_stop_left", 1, "level of an active STOPL", lsb=2, values=LOW_HIGH),
            Field("pol_stop_right", 1, "level of an active STOPR", lsb=3, values=LOW_HIGH),
            Field("invert_stop_direction", 1, "STOPL and STOPR change their sides", lsb=4, values=OFF_ON),
            Field("soft_stop_en", 1, "how a switch stops", lsb=5, values={0: "at once", 1: "with DSTOP"}),
            Field("virtual_left_limit_en", 1, "VIRT_STOP_LEFT stops the motor", lsb=6, values=OFF_ON),
            Field("virtual_right_limit_en", 1, "VIRT_STOP_RIGHT stops the motor", lsb=7, values=OFF_ON),
            Field("virt_stop_mode", 2, "how a virtual stop stops", lsb=8, values=_STOP_MODES),
            Field("latch_x_on_inactive_l", 1, "X_LATCH when STOPL becomes inactive", lsb=10, values=OFF_ON),
            Field("latch_x_on_active_l", 1, "X_LATCH when STOPL becomes active", lsb=11, values=OFF_ON),
            Field("latch_x_on_inactive_r", 1, "X_LATCH when STOPR becomes inactive", lsb=12, values=OFF_ON),
            Field("latch_x_on_active_r", 1, "X_LATCH when STOPR becomes active", lsb=13, values=OFF_ON),
            Field("stop_left_is_home", 1, "STOPL is the home switch too", lsb=14, values=OFF_ON),
            Field("stop_right_is_home", 1, "STOPR is the home switch too", lsb=15, values=OFF_ON),
            Field("home_event", 4, "what is home", lsb=16, values=_HOME_EVENTS),
            Field("start_home_tracking", 1, "the next home event sets X_HOME", lsb=20, values=OFF_ON),
            Field("clr_pos_at_target", 1, "XACTUAL becomes 0 on arrival: endless cycles", lsb=21, values=OFF_ON),
            Field("circular_movement_en", 1, "positions wrap at X_RANGE", lsb=22, values=OFF_ON),
            Field(
                "pos_comp_output",
                2,
                "what the pin TARGET_REACHED shows",
                lsb=23,
                values={0: "TARGET_REACHED_F", 1: "VEL_REACHED_F", 2: "ENC_FAIL_F", 3: "POS_COMP_REACHED_F"},
            ),
            Field("pos_comp_source", 1, "position that is compared", lsb=25, values={0: "XACTUAL", 1: "ENC_POS"}),
            Field("stop_on_stall", 1, "a stall above VSTALL_LIMIT stops at once", lsb=26, values=OFF_ON),
            Field("drv_after_stall", 1, "motion is allowed after the stall event was cleared", lsb=27, values=OFF_ON),
            Field(
                "modified_pos_compare",
                2,
                "what the position is compared with",
                lsb=28,
                values={0: "POS_COMP", 1: "X_HOME", 2: "X_LATCH or ENC_LATCH", 3: "REV_CNT"},
            ),
            Field(
                "automatic_cover",
                1,
                "cover datagrams of their own at SPI_SWITCH_VEL",
                lsb=30,
                values=OFF_ON,
                behaviour="the emulated driver keeps one configuration at all speeds",
            ),
            Field("circular_enc_en", 1, "ENC_POS wraps at X_RANGE too", lsb=31, values=OFF_ON),
        ),
    ),
    Register(
        "HOME_SAFETY_MARGIN",
        16,
        "around X_HOME the home switch is not judged, so far to each side",
        unit=MICROSTEPS,
        address=0x1E,
        group="reference",
        source=f"DS-TMC4361 9; {TOM}",
    ),
    _acceleration("DSTOP", 0x2C, "deceleration of soft stops by switches and virtual stops", TOM, "reference"),
    _position("POS_COMP", 0x32, "position to compare with", f"DS-TMC4361 9; {TOM_TBONE}"),
    _position("VIRT_STOP_LEFT", 0x33, "stops the motor at and left of here", f"DS-TMC4361 9; {TOM_TBONE_STEPPYR}"),
    _position(
        "VIRT_STOP_RIGHT",
        0x34,
        "stops the motor at and right of here",
        f"DS-TMC4361 9 (called left there, with the right comparison); {TOM_TBONE_STEPPYR}",
    ),
    _position("X_HOME", 0x35, "position of home", f"DS-TMC4361 9; {TOM}", volatile=True),
    _position(
        "X_LATCH",
        0x36,
        "XACTUAL at the latest edge that was to be latched",
        f"DS-TMC4361 9 (RW there; a write is X_RANGE); {TOM_TBONE}",
        access=Access.R,
        volatile=True,
    ),
    Register(
        "REV_CNT",
        32,
        "how often the position wrapped",
        signed=True,
        unit="revolutions",
        address=0x36,
        access=Access.R,
        volatile=True,
        group="reference",
        when="circular_cnt_as_xlatch is on",
        source=HEADERS,
    ),
    Register(
        "X_RANGE",
        32,
        "circular motion is from minus this to this minus 1",
        unit=MICROSTEPS,
        address=0x36,
        access=Access.W,
        group="reference",
        source=HEADERS,
    ),
    Register(
        "CIRCULAR_DEC",
        32,
        "fraction of a microstep that a revolution has more than 2 * X_RANGE",
        unit="microsteps/2^31",
        address=0x7C,
        access=Access.W,
        group="reference",
        source=f"{HEADERS}; REV310 (format)",
    ),
)
