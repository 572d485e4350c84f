"""Registers of the TMC2209: 7-bit addresses, 32 data bits, over a single-wire UART alone.

Sources: DS-TMC2209 by section; API and PY, which are of one origin. They differ in resets: API has GCONF 0x40 and
IHOLD_IRUN 0x00071703, where the sheet tells I_scale_analog and multistep_filt set, and what an unburnt memory gives
(5.1.1); the sheet is followed. PWMCONF's PWM_REG is 1 by its reset word, 8 by an unburnt memory; the word is followed,
which API has as well.
"""

from __future__ import annotations

from dataclasses import replace

from ..build import RW, R, Rows, W, choice, flag, state
from ..model import Field, Register, RegisterTable
from ..tmc5xxx import driver, general, motion
from ..tmc5xxx.rows import CLOCKS, LOW_HIGH, VELOCITY_UNIT, VENDOR
from .behaviour import with_behaviour
from .rows import PLACE_ROWS

VERSION = 0x21
VERSION_ADDRESS = 0x06
_GENERAL, _OTP, _SPEED, _STALL, _PLACE, _CHOPPER = "5.1", "5.1.1", "5.2", "5.3", "5.4", "5.5"
_general = Rows(general.GROUP, _OTP)
_thresholds = Rows("thresholds", _SPEED)
_current = Rows("current", _SPEED)
_velocity = Rows("velocity", _SPEED)
_driver = Rows(driver.DRIVER, _STALL)

GCONF = _general(0x00, "GCONF", 10, RW, "what the chip is set to do").having(
    flag(0, "I_scale_analog", "the voltage at VREF scales the motor current; else the reference inside"),
    flag(1, "internal_Rsense", "current is measured inside the chip, without sense resistors"),
    choice(
        2,
        "en_spreadcycle",
        1,
        "the chopper; the pin SPREAD turns it round",
        {0: "StealthChop, SpreadCycle by velocity", 1: "SpreadCycle alone"},
    ),
    flag(3, "shaft", "the motor turns the other way"),
    flag(4, "index_otpw", "the pin INDEX shows the warning of overtemperature"),
    flag(5, "index_step", "the pin INDEX gives the steps of VACTUAL"),
    flag(6, "pdn_disable", "the pin PDN_UART is the UART's alone"),
    choice(7, "mstep_reg_select", 1, "who sets the microsteps", {0: "pins MS1 and MS2", 1: "mres"}),
    flag(8, "multistep_filt", "filters the steps that StealthChop sees"),
    flag(9, "test_mode", "for the factory: stays off"),
    reset=0x101,
    source=f"{_GENERAL}; API has 0x40 as its reset",
)
_OTP_PROG = _general(0x04, "OTP_PROG", 16, W, "burns one bit of the chip's memory, once and for all").having(
    Field("OTPBIT", 3, "which bit", lsb=0),
    Field("OTPBYTE", 2, "which byte", range=(0, 2), lsb=4),
    choice(8, "OTPMAGIC", 8, "anything but the key does nothing", {0xBD: "burn"}),
    reset=None,
)
_OTP_READ = _general(0x05, "OTP_READ", 24, R, "what is burnt into the chip: resets of other registers").having(
    *(
        Field(f"OTP{n}", 8, help_, lsb=8 * n)
        for n, help_ in enumerate(
            (
                "trim of the clock, temperature limit and internal resistor",
                "resets of PWM_GRAD and TPWMTHRS, or of CHOPCONF",
                "resets of PWM_OFS, PWM_REG, PWM_FREQ, IHOLDDELAY, IHOLD and the chopper",
            )
        )
    ),
    reset=None,
)
IOIN = _general.reading(VERSION_ADDRESS, "IOIN", 32, "levels of the pins, and the chip's version").having(
    *(
        choice(lsb, name, 1, f"pin {name}", LOW_HIGH)
        for name, lsb in (
            *(("ENN", 0), ("MS1", 2), ("MS2", 3), ("DIAG", 4), ("PDN_UART", 6)),
            *(("STEP", 7), ("SPREAD_EN", 8), ("DIR", 9)),
        )
    ),
    Field("VERSION", 8, "version of the silicon", lsb=24),
    source=_GENERAL,
)
_FACTORY_CONF = _general(0x07, "FACTORY_CONF", 10, RW, "trims; after a reset as burnt").having(
    Field("FCLKTRIM", 5, "of the clock: 0 is slowest, 31 fastest", lsb=0),
    choice(
        8,
        "OTTRIM",
        2,
        "temperatures of shutdown and warning",
        {0: "143 and 120 degC", 1: "150 and 120 degC", 2: "150 and 143 degC", 3: "157 and 143 degC"},
    ),
    reset=None,
    source=_GENERAL,
)


def _threshold(name: str, address: int, help_: str) -> Register:
    return _thresholds(address, name, 20, W, help_, unit=CLOCKS)


_COOLCONF = replace(
    driver.COOLCONF,
    width=16,
    address=0x42,
    source=_STALL,
    fields=tuple(part for part in driver.COOLCONF.fields if part.lsb < 16),
)
DRV_STATUS = _driver.reading(0x6F, "DRV_STATUS", 32, "current and faults of the driver now").having(
    state(0, "otpw", "warning of overtemperature"),
    state(1, "ot", "too hot: the driver is off"),
    state(2, "s2ga", "short to ground at phase A: the driver is off"),
    state(3, "s2gb", "short to ground at phase B: the driver is off"),
    state(4, "s2vsa", "short to the supply at phase A: the driver is off"),
    state(5, "s2vsb", "short to the supply at phase B: the driver is off"),
    state(6, "ola", "no load at phase A; tells nothing at rest, at high speed and with StealthChop"),
    state(7, "olb", "no load at phase B; tells nothing at rest, at high speed and with StealthChop"),
    *(state(lsb, f"t{celsius}", f"{celsius} degC or more") for lsb, celsius in enumerate((120, 143, 150, 157), 8)),
    Field("CS_ACTUAL", 5, "current scale now", unit="1/32, plus 1/32", lsb=16),
    state(30, "stealth", "StealthChop now"),
    state(31, "stst", "the motor stands"),
    source="5.5.3",
)
_CHOPCONF_FIELDS = {"toff", "hstrt", "hend", "mres", "dedge", "diss2g", "diss2vs", "intpol"}
CHOPCONF = replace(
    driver.CHOPCONF_5160,
    reset=0x10000053,
    source=f"{_CHOPPER}.1",
    fields=(
        *(replace(part, when="") for part in driver.CHOPCONF_5160.fields if part.name in _CHOPCONF_FIELDS),
        *(part for part in driver.CHOPCONF_5130.fields if part.name in ("tbl", "vsense")),
    ),
)
_PWMCONF, _PWM_SCALE, _PWM_AUTO = driver.PWM_5160
CHIP = (
    GCONF,
    replace(general.GSTAT_5160, source=_GENERAL),
    replace(general.IFCNT, source=_GENERAL),
    _general(
        0x03,
        "NODECONF",
        12,
        W,
        "patience of the UART; SLAVECONF in the vendor's headers. The address is that of MS1 and MS2",
    ).having(*(part for part in general.nodeconf().fields if part.name == "SENDDELAY"), source=_GENERAL),
    _OTP_PROG,
    _OTP_READ,
    IOIN,
    _FACTORY_CONF,
)
AXIS = (
    replace(motion.ihold_irun(0x10), reset=0x00011F10, source=f"{_SPEED} and {_OTP}; API has 0x00071703 as its reset"),
    _current(
        0x11, "TPOWERDOWN", 8, W, "delay from standstill to the lower current; StealthChop needs 2 or more"
    ).having(unit="2^18 tCLK", reset=20),
    _thresholds.reading(
        0x12, "TSTEP", 20, "time between two of 256 microsteps a full step; all ones at standstill"
    ).having(unit=CLOCKS, source=_SPEED),
    _threshold("TPWMTHRS", 0x13, "StealthChop where TSTEP is this or more; 0: at every speed"),
    _threshold("TCOOLTHRS", 0x14, "CoolStep, and a stall shown at DIAG, where TSTEP is this or less"),
    _velocity(
        0x22,
        "VACTUAL",
        24,
        W,
        "velocity at which the chip turns the motor by itself, without a ramp; 0: by STEP and DIR",
    ).having(signed=True, unit=VELOCITY_UNIT, range=(-(1 << 23) + 1, (1 << 23) - 1)),
    _driver(0x40, "SGTHRS", 8, W, "a stall is shown where SG_RESULT is twice this or less", unit="2"),
    _driver.reading(
        0x41, "SG_RESULT", 10, "StallGuard4's value: the less, the more load; bits 0 and 9 are always 0"
    ).having(source=_STALL),
    _COOLCONF,
    *(replace(row, source=_PLACE) for row in PLACE_ROWS),
    CHOPCONF,
    DRV_STATUS,
    replace(_PWMCONF, access=RW, reset=0xC10D0024, source=f"{_CHOPPER}.2"),
    replace(_PWM_SCALE, source=f"{_CHOPPER}.2"),
    replace(_PWM_AUTO, source=f"{_CHOPPER}.2"),
)


def _row(row: Register, axis: int | None) -> Register:
    """A row of this chip, whose source has begun with the section."""
    section, *more = row.source.split("; ")
    source = "; ".join((f"DS-TMC2209 {section}", *more, VENDOR))
    return with_behaviour(replace(row, source=source)).completed(axis)


TABLE = RegisterTable("tmc2209", (*(_row(row, None) for row in CHIP), *(_row(row, 0) for row in AXIS)))
