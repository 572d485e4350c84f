"""Status and event registers of the TMC4361 (DS-TMC4361 7)."""

from __future__ import annotations

from ..build import RW, R, Rows, choice
from ..model import Field
from .bits import EVENTS
from .rows import INACTIVE_ACTIVE, TOM_STEPPYR, TOM_TBONE_STEPPYR

_row = Rows("events", f"DS-TMC4361 7.2; {TOM_TBONE_STEPPYR}")

TMC26X = "motor driver TMC26x or TMC2130"
TMC24X = "motor driver TMC23x or TMC24x"


def _events() -> tuple[Field, ...]:
    return tuple(Field(name, 1, meaning, lsb=bit) for bit, (name, meaning) in EVENTS.items())


def _selection(purpose: str) -> tuple[Field, ...]:
    """One field an event, with `purpose` before its meaning, and the bit that selects nothing.

    That one is there because "all events" is written as 0xFFFFFFFF, and the word is kept as it is.
    """
    selected = tuple(Field(part.name, 1, f"{purpose}: {part.help}", lsb=part.lsb) for part in _events())
    return (*selected, Field("reserved", 1, "no event has this bit", lsb=22))


def _flag(name: str, lsb: int, meaning: str, when: str = "") -> Field:
    return choice(lsb, name, 1, meaning, INACTIVE_ACTIVE, when=when)


EVENT_ROWS = (
    _row(
        0x0B,
        "SPI_STATUS_SELECTION",
        32,
        RW,
        "events that the status byte of each datagram shows, packed from its bit 0; the lowest eight count",
    ).having(*_selection("show"), reset=0x82029805, source=f"DS-TMC4361 7.2; {TOM_STEPPYR}"),
    _row(0x0C, "EVENT_CLEAR_CONF", 32, RW, "events that reading EVENTS leaves as they are").having(
        *_selection("keep"), source=f"DS-TMC4361 7.2; {TOM_TBONE_STEPPYR}"
    ),
    _row(0x0D, "INTR_CONF", 32, RW, "events that make the pin INTR active").having(
        *_selection("interrupt"), source=f"DS-TMC4361 7.2; {TOM_TBONE_STEPPYR}"
    ),
    _row(
        0x0E,
        "EVENTS",
        32,
        R,
        "what has happened since the last reading; a reading clears all that EVENT_CLEAR_CONF does not keep",
    ).having(*_events(), reset=None, volatile=True, read_clears=True),
    _row(0x0F, "STATUS_FLAGS", 32, R, "how things are now, and what the motor driver says").having(
        _flag("TARGET_REACHED_F", 0, "XACTUAL is XTARGET"),
        _flag("POS_COMP_REACHED_F", 1, "the compared position has been reached"),
        _flag("VEL_REACHED_F", 2, "VACTUAL is VMAX"),
        choice(
            3, "VEL_STATE_F", 2, "direction of motion", {0: "standstill", 1: "positive", 2: "negative"}, range=(0, 2)
        ),
        choice(5, "RAMP_STATE_F", 2, "what the speed does", {0: "constant", 1: "rising", 2: "falling"}, range=(0, 2)),
        _flag("STOPL_ACTIVE_F", 7, "the left switch holds the motor"),
        _flag("STOPR_ACTIVE_F", 8, "the right switch holds the motor"),
        _flag("VSTOPL_ACTIVE_F", 9, "the position is at or left of VIRT_STOP_LEFT"),
        _flag("VSTOPR_ACTIVE_F", 10, "the position is at or right of VIRT_STOP_RIGHT"),
        _flag("ACTIVE_STALL_F", 11, "the motor driver reports a stall above VSTALL_LIMIT"),
        _flag("HOME_ERROR_F", 12, "the home switch contradicts the position"),
        _flag("FS_ACTIVE_F", 13, "full steps are used"),
        _flag("ENC_FAIL_F", 14, "the encoder deviates by more than ENC_POS_DEV_TOL"),
        _flag("N_ACTIVE_F", 15, "the index of the encoder is active"),
        _flag("ENC_LATCH_F", 16, "ENC_LATCH has been written"),
        _flag("MULTI_CYCLE_FAIL_F", 17, "repeated SSI data differed", "encoder is SSI with ssi_multi_cycle_data"),
        _flag("SER_ENC_VAR_F", 17, "the encoder jumped", "encoder is serial with serial_enc_variation_limit"),
        _flag("CL_FIT_F", 19, "the deviation is inside CL_TOLERANCE"),
        *(_flag(f"SERIAL_ENC_FLAG[{n}]", 20 + n, f"status bit {n} of the serial encoder") for n in range(4)),
        _flag("SG", 24, "the driver reports a stall", TMC26X),
        _flag("UV_SF", 24, "undervoltage at the driver, or its stall flag", TMC24X),
        _flag("OT", 25, "the driver is off because it is too hot"),
        _flag("OTPW", 26, "the driver warns that it is hot"),
        _flag("S2GA", 27, "phase A is shorted to ground", TMC26X),
        _flag("OCA", 27, "overcurrent in phase A", TMC24X),
        _flag("S2GB", 28, "phase B is shorted to ground", TMC26X),
        _flag("OCB", 28, "overcurrent in phase B", TMC24X),
        _flag("OLA", 29, "phase A seems to be open"),
        _flag("OLB", 30, "phase B seems to be open"),
        _flag("STST", 31, "the driver sees no steps", TMC26X),
        _flag("OCHS", 31, "overcurrent of the high side", TMC24X),
        reset=None,
        volatile=True,
        source=f"DS-TMC4361 7.1 (name, address); {TOM_TBONE_STEPPYR} (bits); KMARX (bits 31:24)",
    ),
)
