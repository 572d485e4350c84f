"""Registers of the TMC2660 (TMC26x): five of 20 bits that are written, and three answers; over SPI alone.

A datagram says by its upper bits which register it writes (`TaggedFormat`); its answer is the status that DRVCONF.RDSEL
selected before. No register that is written can be read. Addresses are the maker's own (PY, API), which count answers
from 0 and registers from 8. Sources: DS-TMC2660 6.10 (answers), PY and KLIPPER-TMC2660 (places of the fields), what a
field does as in the TMC5130's driver where it has the same in the same place (DS-TMC5130, inferred).

Not told by any source that was at hand: what the slopes SLPH and SLPL are in numbers. After power-on all are 0.
"""

from __future__ import annotations

from dataclasses import replace

from ..build import Rows, W, choice, flag, state
from ..model import Field, Register, RegisterTable
from ..spi_format import TaggedFormat
from ..tmc5xxx import driver
from ..tmc5xxx.rows import SCALE_UNIT
from .behaviour import with_behaviour

FORMAT = TaggedFormat()
DRVSTATUS_MSTEP, DRVSTATUS_SG, DRVSTATUS_SG_SE = range(3)
DRVCTRL, CHOPCONF, SMARTEN, SGCSCONF, DRVCONF = 0x8, 0xC, 0xD, 0xE, 0xF
SOURCE = "API; PY; KLIPPER-TMC2660"
STEPS = "SDOFF = 0"
CURRENTS = "SDOFF = 1"
NOT_MODELLED = {
    "DEDGE": "the bench tells how many steps come in, whatever their edges",
    "rndtf": "the emulated chopper has no frequency that could be heard",
    "TST": "for the factory",
    "SLPH": "the emulated bridges switch at once",
    "SLPL": "the emulated bridges switch at once",
    "DISS2G": "the emulated driver sees every short",
    "TS2G": "the emulated driver sees a short at once",
}
"""What the emulated driver keeps without acting on it, and why."""

_control = Rows("microsteps", SOURCE)
_current = Rows("current", SOURCE)
_driver = Rows("driver", SOURCE)
_general = Rows("general", SOURCE)
_FLAGS = (
    state(0, "SG", "a stall: the load value is 0"),
    state(1, "OT", "too hot: the driver is off"),
    state(2, "OTPW", "warning of overtemperature"),
    state(3, "S2GA", "short to ground at phase A: the driver is off"),
    state(4, "S2GB", "short to ground at phase B: the driver is off"),
    state(5, "OLA", "no load at phase A; tells nothing at rest and at high speed"),
    state(6, "OLB", "no load at phase B; tells nothing at rest and at high speed"),
    state(7, "STST", "no step came at STEP for 2^20 clocks"),
)
FLAGS = tuple(part.name for part in _FLAGS)
"""The lowest bits of every answer, the lowest first."""


def _answer(address: int, name: str, help_: str, *fields: Field) -> Register:
    row = _driver.reading(address, name, 20, f"{help_}; two datagrams with DRVCONF bring it")
    return row.having(*_FLAGS, *fields, source="DS-TMC2660 6.10; PY; API")


def _taken_from(sister: Register, names: tuple[str, ...], to: dict[str, int] | None = None) -> tuple[Field, ...]:
    """Fields of a sister's register, of which some lie elsewhere here."""
    places = to or {}
    return tuple(replace(part, lsb=places.get(part.name, part.lsb)) for part in sister.fields if part.name in names)


_SPREADCYCLE = "chm = 0"
_ROWS = (
    _answer(
        DRVSTATUS_MSTEP,
        "DRVSTATUS_MSTEP",
        "flags, and the place in the microstep table",
        Field("MSTEP", 10, "place of coil A in the microstep table", unit="1/1024 electrical turn", lsb=10),
    ),
    _answer(
        DRVSTATUS_SG,
        "DRVSTATUS_SG",
        "flags, and the load value",
        Field("SG_RESULT", 10, "StallGuard2's value: the less, the more load; 0 at a stall", lsb=10),
    ),
    _answer(
        DRVSTATUS_SG_SE,
        "DRVSTATUS_SG_SE",
        "flags, the upper half of the load value, and the current scale",
        Field("SE", 5, "current scale now", unit=SCALE_UNIT, lsb=10),
        Field("SG_UPPER", 5, "StallGuard2's value", unit="32", lsb=15),
    ),
    _control(DRVCTRL, "DRVCTRL", 18, W, "steps: how long they are; or with SDOFF the coil currents").having(
        choice(0, "mres", 4, "microsteps a full step", driver.MRES, range=(0, 8), when=STEPS),
        flag(8, "DEDGE", "both edges of STEP make a step", when=STEPS),
        flag(9, "intpol", "steps of a sixteenth are interpolated to 256 microsteps", when=STEPS),
        Field("CB", 8, "current of coil B", unit="1/248 of the wave's peak", range=(0, 248), lsb=0, when=CURRENTS),
        choice(8, "PHB", 1, "polarity of coil B", {0: "OB1 to OB2", 1: "OB2 to OB1"}, when=CURRENTS),
        Field("CA", 8, "current of coil A", unit="1/248 of the wave's peak", range=(0, 248), lsb=9, when=CURRENTS),
        choice(17, "PHA", 1, "polarity of coil A", {0: "OA1 to OA2", 1: "OA2 to OA1"}, when=CURRENTS),
    ),
    _driver(CHOPCONF, "CHOPCONF", 17, W, "how the chopper regulates the coil currents").having(
        choice(
            11,
            "HDEC",
            2,
            "how fast the hysteresis shrinks within a cycle",
            {0: "16", 1: "32", 2: "48", 3: "64"},
            unit="tCLK",
            when=_SPREADCYCLE,
            behaviour="the emulated chopper has no ripple",
        ),
        *_taken_from(
            driver.CHOPCONF_5130,
            ("toff", "hstrt", "tfd_2_0", "hend", "offset", "fd3", "disfdcc", "rndtf", "chm", "tbl"),
        ),
    ),
    _driver(SMARTEN, "SMARTEN", 17, W, "CoolStep").having(
        *_taken_from(driver.COOLCONF, ("semin", "seup", "semax", "sedn", "seimin")),
    ),
    _current(SGCSCONF, "SGCSCONF", 17, W, "current scale, and StallGuard2").having(
        Field("CS", 5, "current scale", unit=SCALE_UNIT, lsb=0),
        *_taken_from(driver.COOLCONF, ("sgt", "sfilt"), {"sgt": 8, "sfilt": 16}),
    ),
    _general(DRVCONF, "DRVCONF", 17, W, "what the driver is set to do, and what it answers").having(
        choice(
            4,
            "RDSEL",
            2,
            "what answers show",
            {0: "MSTEP", 1: "load value", 2: "load value and current scale"},
            range=(0, 2),
        ),
        choice(
            6, "vsense", 1, "voltage at the sense resistor for full current", {0: "310 mV", 1: "165 mV"}
        ),
        choice(7, "SDOFF", 1, "what the coils follow", {0: "STEP and DIR", 1: "currents of DRVCTRL"}),
        Field("TS2G", 2, "how long a short to ground may last: 0 is longest", lsb=8),
        flag(10, "DISS2G", "a short to ground is not looked for"),
        Field("SLPL", 2, "slope of the low side", lsb=12),
        Field("SLPH", 2, "slope of the high side", lsb=14),
        flag(16, "TST", "for the factory: stays off"),
    ),
)  # fmt: skip


def _told(row: Register) -> Register:
    """`row` with what is not modelled of it."""
    parts = tuple(replace(part, behaviour=NOT_MODELLED.get(part.name, part.behaviour)) for part in row.fields)
    return replace(row, fields=parts)


_CHIP = ("DRVCONF",)
TABLE = RegisterTable(
    "tmc2660", tuple(_told(with_behaviour(row)).completed(None if row.name in _CHIP else 0) for row in _ROWS)
)
