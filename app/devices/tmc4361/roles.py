"""Registers that the driver itself needs, by their roles."""

from __future__ import annotations

from ...registers.model import Field, Register
from ...registers.tmc4361.bits import EVENT_BITS
from ...registers.tmc4361.events import TMC24X, TMC26X
from ...registers.tmc4361.table import TMC4361

AXIS = 0


def row(name: str) -> Register:
    """Raises KeyError."""
    return TMC4361.get(name, AXIS)


def part(register: Register, name: str) -> Field:
    """A field of a row. Raises KeyError."""
    found = register.field_named(name)
    if found is None:
        raise KeyError(f"{register.name} has no field {name}")
    return found


GENERAL_CONF = row("GENERAL_CONF")
REFERENCE_CONF = row("REFERENCE_CONF")
START_CONF = row("START_CONF")
CURRENT_CONF = row("CURRENT_CONF")
ENC_IN_CONF = row("ENC_IN_CONF")
STEP_CONF = row("STEP_CONF")
SPI_STATUS_SELECTION = row("SPI_STATUS_SELECTION")
EVENT_CLEAR_CONF = row("EVENT_CLEAR_CONF")
INTR_CONF = row("INTR_CONF")
EVENTS = row("EVENTS")
STATUS = row("STATUS_FLAGS")
RAMPMODE = row("RAMPMODE")
XACTUAL = row("XACTUAL")
VACTUAL = row("VACTUAL")
AACTUAL = row("AACTUAL")
VMAX = row("VMAX")
VSTART = row("VSTART")
VSTOP = row("VSTOP")
VBREAK = row("VBREAK")
AMAX = row("AMAX")
DMAX = row("DMAX")
ASTART = row("ASTART")
DFINAL = row("DFINAL")
BOWS = tuple(row(f"BOW{number}") for number in (1, 2, 3, 4))
CLK_FREQ = row("CLK_FREQ")
HOME_SAFETY_MARGIN = row("HOME_SAFETY_MARGIN")
X_HOME = row("X_HOME")
X_LATCH = row("X_LATCH")
XTARGET = row("XTARGET")
RESET = row("RESET_CLK_GATING")
ENC_POS = row("ENC_POS")
ENC_CONST = row("ENC_CONST")
ENC_POS_DEV = row("ENC_POS_DEV")
CL_OFFSET = row("CL_OFFSET")
V_ENC_MEAN = row("V_ENC_MEAN")
MSCNT = row("MSCNT")
CURRENTS = row("CURRENTA_B")
SCALE = row("SCALE_PARAM")
VERSION = row("VERSION_NO")
SPI_OUT_CONF = row("SPI_OUT_CONF")
COVER_LOW, COVER_HIGH = row("COVER_LOW"), row("COVER_HIGH")
COVER_DRV_LOW, COVER_DRV_HIGH = row("COVER_DRV_LOW"), row("COVER_DRV_HIGH")
VSTALL_LIMIT = row("VSTALL_LIMIT")
MSLUT = tuple(row(f"MSLUT[{index}]") for index in range(8))
MSLUTSEL = row("MSLUTSEL")
MSLUTSTART = row("START_SIN___START_SIN90_120___DAC_OFFSET")
DAC_OFFSET = part(MSLUTSTART, "DAC_OFFSET")

RAMP = (
    GENERAL_CONF,
    START_CONF,
    RAMPMODE,
    VMAX,
    VSTART,
    VSTOP,
    VBREAK,
    AMAX,
    DMAX,
    ASTART,
    DFINAL,
    *BOWS,
    CLK_FREQ,
)
"""What decides a motion."""
REMEMBERED = (
    *RAMP,
    REFERENCE_CONF,
    CURRENT_CONF,
    ENC_IN_CONF,
    STEP_CONF,
    SPI_OUT_CONF,
    SPI_STATUS_SELECTION,
    INTR_CONF,
    HOME_SAFETY_MARGIN,
    X_HOME,
    CL_OFFSET,
    ENC_CONST,
)
"""What is kept in mind besides; EVENT_CLEAR_CONF too, which `events` looks after."""
MOVING = frozenset(
    register.address
    for register in (*RAMP, REFERENCE_CONF, ENC_IN_CONF, XACTUAL, XTARGET, row("GEAR_RATIO"), row("VIRT_STOP_LEFT"))
) | {row("VIRT_STOP_RIGHT").address, row("DSTOP").address, row("X_RANGE").address, RESET.address}
"""Addresses a write to which may move or stop the motor, or change how it moves."""

SHAPE = part(RAMPMODE, "RAMP_PROFILE")
HOLD, TRAPEZOID, S_SHAPED = range(3)
"""RAMP_PROFILE."""
POSITIONING_BIT = 4
"""RAMPMODE: go to XTARGET by itself."""

VEL_STATE = part(STATUS, "VEL_STATE_F")
RAMP_STATE = part(STATUS, "RAMP_STATE_F")
FULL_STEPS = part(STEP_CONF, "fs_per_rev")
MICROSTEPS = part(STEP_CONF, "mstep_per_fs")
REGULATION = part(ENC_IN_CONF, "regulation_modus")
HOME_EVENT = part(REFERENCE_CONF, "home_event")
OUTPUT_FORMAT = part(SPI_OUT_CONF, "spi_output_format")
TALKATIVE_FORMS = (10, 11, 12, 13)
"""Those of a TMC26x and TMC2130, which is asked and told by itself."""
COVERS_ONLY = part(SPI_OUT_CONF, "cover_done_only_for_cover")
STALL_FOR_UNDERVOLTAGE = part(SPI_OUT_CONF, "stall_flag_instead_of_uv_en")
COVER_LENGTH = part(SPI_OUT_CONF, "cover_data_length")
SDIN_MODE = part(GENERAL_CONF, "sdin_mode")
REVERSED = part(GENERAL_CONF, "reverse_motor_dir")
GATE_XTARGET, GATE_VMAX, GATE_RAMPMODE = (part(START_CONF, f"start_en[{index}]") for index in range(3))


TMC24X_FORMS = (8, 9)
"""spi_output_format of the TMC23x and TMC24x."""
DRIVER_LSB = 24
"""Of the flags that STATUS has of the motor driver."""
_TMC24X = frozenset(part.name for part in STATUS.fields if part.when == TMC24X)
_TMC26X = frozenset(part.name for part in STATUS.fields if part.when == TMC26X)


def other_drivers(spi_out_conf: int) -> frozenset[str]:
    """Flags of STATUS that are those of other motor drivers than what SPI_OUT_CONF names."""
    return _TMC26X if OUTPUT_FORMAT.unpack(spi_out_conf) in TMC24X_FORMS else _TMC24X


def driver_flags(spi_out_conf: int) -> dict[int, str]:
    """Names of the driver's flags, by their bits from `DRIVER_LSB` on."""
    others = other_drivers(spi_out_conf)
    told = (part for part in STATUS.fields if part.lsb >= DRIVER_LSB and part.name not in others)
    return {part.lsb - DRIVER_LSB: part.name for part in told}


def event(*names: str) -> int:
    """Bits of EVENTS by their names."""
    return sum(1 << EVENT_BITS[name] for name in names)


BLOCKING = event("FROZEN", "STOPL_EVENT", "STOPR_EVENT", "VSTOPL_ACTIVE", "VSTOPR_ACTIVE", "STOP_ON_STALL")
"""Events that hold the motor as long as they are not cleared: nothing but a command to move may clear them."""
