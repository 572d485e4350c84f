"""Start signal, target pipeline and shadow registers of the TMC4361."""

from __future__ import annotations

from ..build import RW, Rows, choice, flag
from ..model import Field, Register
from .general import START_TIME_ROWS
from .rows import ACCELERATION_UNIT, BOW_UNIT, HEADERS, LOW_HIGH, MICROSTEPS, TOM_TBONE, VELOCITY_UNIT

_WAITS = ("XTARGET", "VMAX", "RAMPMODE", "GEAR_RATIO")
_TRIGGERS = ("the pin START, which is an input then", "TARGET_REACHED", "VEL_REACHED", "POS_COMP_REACHED")
_PIPED = ("XTARGET", "POS_COMP", "GEAR_RATIO", "GENERAL_CONF")

OPTION = ("shadow_option = 0", "shadow_option = 1", "shadow_option = 2", "shadow_option = 3")
_TRAPEZOIDS = "shadow_option = 2 or 3"

_START_CONF = Rows("start", TOM_TBONE)(
    0x02, "START_CONF", 32, RW, "what waits for a start signal, and what gives one"
).having(
    *(flag(n, f"start_en[{n}]", f"a new {name} waits for the next start") for n, name in enumerate(_WAITS)),
    flag(4, "start_en[4]", "a start takes over the shadow registers"),
    *(flag(5 + n, f"trigger_events[{n}]", f"starts come from {name}") for n, name in enumerate(_TRIGGERS)),
    choice(9, "pol_start_signal", 1, "level of an active START", LOW_HIGH),
    flag(10, "immediate_start_in", "no START_DELAY after the pin START"),
    flag(11, "busy_state_en", "START stays busy, so that chips wait for each other"),
    *(flag(12 + n, f"pipeline_en[{n}]", f"a start moves the pipeline into {name}") for n, name in enumerate(_PIPED)),
    choice(
        16,
        "shadow_option",
        2,
        "what the shadow registers hold",
        {
            0: "one set, all shapes",
            1: "two sets, S-ramp",
            2: "two sets, trapezoid with VSTART",
            3: "two sets, trapezoid with VSTOP",
        },
    ),
    flag(18, "cyclic_shadow_regs", "replaced values go back into the shadow registers"),
    Field("shadow_miss_cnt", 4, "starts to let pass between two that take over the shadow registers", lsb=20),
    *(flag(24 + n, f"xpipe_rewrite_reg[{n}]", f"the value that leaves comes back at X_PIPE{n}") for n in range(8)),
)

_PIPELINE = tuple(
    Rows("pipeline", TOM_TBONE if n == 0 else HEADERS)(
        0x38 + n, f"X_PIPE{n}", 32, RW, f"stage {n} of the pipeline; pipeline_en says what it is for"
    ).having(signed=True, unit=MICROSTEPS, volatile=True)
    for n in range(8)
)


def _shadow(number: int, width: int, *fields: Field) -> Register:
    row = Rows("shadow", f"{HEADERS}; KMARX (RAMPMODE)" if number in (3, 4, 12, 13) else TOM_TBONE)
    help_ = f"shadow register {number}; shadow_option says what it is for"
    return row(0x40 + number, f"SH_REG{number}", width, RW, help_).having(*fields, volatile=True)


def _velocity(number: int, of: str, when: str, width: int = 31) -> Field:
    return Field(f"SH_REG{number}_{of}", width, f"shadow of {of}", signed=of == "VMAX", unit=VELOCITY_UNIT, when=when)


def _acceleration(number: int, of: str, when: str = "") -> Field:
    return Field(f"SH_REG{number}_{of}", 24, f"shadow of {of}", unit=ACCELERATION_UNIT, when=when)


def _bow(number: int, bow: int, when: str) -> Field:
    return Field(f"SH_REG{number}_BOW{bow}", 24, f"shadow of BOW{bow}", unit=BOW_UNIT, when=when)


_SHADOWS = (
    _shadow(0, 32, _velocity(0, "VMAX", "", 32)),
    _shadow(1, 24, _acceleration(1, "AMAX")),
    _shadow(2, 24, _acceleration(2, "DMAX")),
    _shadow(3, 24, _acceleration(3, "ASTART", "shadow_option is not 1"), _bow(3, 1, OPTION[1])),
    _shadow(4, 24, _acceleration(4, "DFINAL", "shadow_option is not 1"), _bow(4, 2, OPTION[1])),
    _shadow(5, 31, _velocity(5, "VBREAK", "shadow_option is not 1"), _bow(5, 3, OPTION[1])),
    _shadow(
        6,
        31,
        _velocity(6, "VSTART", "shadow_option = 0 or 2"),
        _bow(6, 4, OPTION[1]),
        _velocity(6, "VSTOP", OPTION[3]),
    ),
    _shadow(7, 32, _velocity(7, "VSTOP", OPTION[0], 32), _velocity(7, "VMAX", "shadow_option is not 0", 32)),
    _shadow(8, 24, _bow(8, 1, OPTION[0]), _acceleration(8, "AMAX", "shadow_option is not 0")),
    _shadow(9, 24, _bow(9, 2, OPTION[0]), _acceleration(9, "DMAX", "shadow_option is not 0")),
    _shadow(10, 24, _bow(10, 3, OPTION[0]), _bow(10, 1, OPTION[1]), _acceleration(10, "ASTART", _TRAPEZOIDS)),
    _shadow(11, 24, _bow(11, 4, OPTION[0]), _bow(11, 2, OPTION[1]), _acceleration(11, "DFINAL", _TRAPEZOIDS)),
    _shadow(
        12,
        31,
        Field("SH_REG12_RAMPMODE", 3, "shadow of RAMPMODE", when=OPTION[0]),
        _bow(12, 3, OPTION[1]),
        _velocity(12, "VBREAK", _TRAPEZOIDS),
    ),
    _shadow(13, 31, _bow(13, 4, OPTION[1]), _velocity(13, "VSTART", OPTION[2]), _velocity(13, "VSTOP", OPTION[3])),
)

START_ROWS = (_START_CONF, *START_TIME_ROWS, *_PIPELINE, *_SHADOWS)
