"""Registers of the TMC2209: 7-bit addresses, 32 data bits, over a single-wire UART alone.

Sources: DS-TMC2209 by section; API and PY, which are of one origin. They differ in resets: API has GCONF 0x40 and
IHOLD_IRUN 0x00071703, where the sheet tells I_scale_analog and multistep_filt set, and what an unburnt memory gives
(5.1.1); the sheet is followed. PWMCONF's PWM_REG is 1 by its reset word, 8 by an unburnt memory; the word is followed,
which API has as well.
"""

from __future__ import annotations

from dataclasses import replace

from ..model import Access, Field, Register, RegisterTable
from ..tmc5xxx import driver, general, motion
from ..tmc5xxx.rows import CLOCKS, LOW_HIGH, VELOCITY_UNIT, VENDOR, flag, reading, state
from .behaviour import with_behaviour

VERSION = 0x21
VERSION_ADDRESS = 0x06
_GENERAL, _OTP, _SPEED, _STALL, _PLACE, _CHOPPER = "5.1", "5.1.1", "5.2", "5.3", "5.4", "5.5"

GCONF = Register(
    "GCONF",
    10,
    "what the chip is set to do",
    address=0x00,
    reset=0x101,
    group=general.GROUP,
    source=f"{_GENERAL}; API has 0x40 as its reset",
    fields=(
        flag(0, "I_scale_analog", "the voltage at VREF scales the motor current; else the reference inside"),
        flag(1, "internal_Rsense", "current is measured inside the chip, without sense resistors"),
        Field("en_spreadcycle", 1, "the chopper; the pin SPREAD turns it round", lsb=2,
              values={0: "StealthChop, SpreadCycle by velocity", 1: "SpreadCycle alone"}),
        flag(3, "shaft", "the motor turns the other way"),
        flag(4, "index_otpw", "the pin INDEX shows the warning of overtemperature"),
        flag(5, "index_step", "the pin INDEX gives the steps of VACTUAL"),
        flag(6, "pdn_disable", "the pin PDN_UART is the UART's alone"),
        Field("mstep_reg_select", 1, "who sets the microsteps", lsb=7, values={0: "pins MS1 and MS2", 1: "mres"}),
        flag(8, "multistep_filt", "filters the steps that StealthChop sees"),
        flag(9, "test_mode", "for the factory: stays off"),
    ),
)  # fmt: skip
_OTP_PROG = Register(
    "OTP_PROG",
    16,
    "burns one bit of the chip's memory, once and for all",
    address=0x04,
    access=Access.W,
    reset=None,
    group=general.GROUP,
    source=_OTP,
    fields=(
        Field("OTPBIT", 3, "which bit", lsb=0),
        Field("OTPBYTE", 2, "which byte", range=(0, 2), lsb=4),
        Field("OTPMAGIC", 8, "anything but the key does nothing", lsb=8, values={0xBD: "burn"}),
    ),
)
_OTP_READ = Register(
    "OTP_READ",
    24,
    "what is burnt into the chip: resets of other registers",
    address=0x05,
    access=Access.R,
    reset=None,
    group=general.GROUP,
    source=_OTP,
    fields=tuple(
        Field(f"OTP{n}", 8, help_, lsb=8 * n)
        for n, help_ in enumerate(
            (
                "trim of the clock, temperature limit and internal resistor",
                "resets of PWM_GRAD and TPWMTHRS, or of CHOPCONF",
                "resets of PWM_OFS, PWM_REG, PWM_FREQ, IHOLDDELAY, IHOLD and the chopper",
            )
        )
    ),
)
IOIN = reading(
    "IOIN",
    32,
    "levels of the pins, and the chip's version",
    VERSION_ADDRESS,
    general.GROUP,
    source=_GENERAL,
    fields=(
        *(
            Field(name, 1, f"pin {name}", lsb=lsb, values=LOW_HIGH)
            for name, lsb in (
                *(("ENN", 0), ("MS1", 2), ("MS2", 3), ("DIAG", 4), ("PDN_UART", 6)),
                *(("STEP", 7), ("SPREAD_EN", 8), ("DIR", 9)),
            )
        ),
        Field("VERSION", 8, "version of the silicon", lsb=24),
    ),
)
_FACTORY_CONF = Register(
    "FACTORY_CONF",
    10,
    "trims; after a reset as burnt",
    address=0x07,
    reset=None,
    group=general.GROUP,
    source=_GENERAL,
    fields=(
        Field("FCLKTRIM", 5, "of the clock: 0 is slowest, 31 fastest", lsb=0),
        Field("OTTRIM", 2, "temperatures of shutdown and warning", lsb=8,
              values={0: "143 and 120 degC", 1: "150 and 120 degC", 2: "150 and 143 degC", 3: "157 and 143 degC"}),
    ),
)  # fmt: skip


def _threshold(name: str, address: int, help_: str) -> Register:
    return Register(name, 20, help_, unit=CLOCKS, address=address, access=Access.W, group="thresholds", source=_SPEED)


_COOLCONF = replace(
    driver.COOLCONF,
    width=16,
    address=0x42,
    source=_STALL,
    fields=tuple(part for part in driver.COOLCONF.fields if part.lsb < 16),
)
DRV_STATUS = reading(
    "DRV_STATUS",
    32,
    "current and faults of the driver now",
    0x6F,
    driver.DRIVER,
    source="5.5.3",
    fields=(
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
    ),
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
_PLACE_ROWS = (
    replace(driver.PLACE_ROWS[0], help="place of phase A in the microstep table now; phase B is 256 ahead",
            source=_PLACE),
    replace(
        driver.PLACE_ROWS[1],
        source=_PLACE,
        fields=(
            Field("CUR_A", 9, "phase A: sine", signed=True, lsb=0),
            Field("CUR_B", 9, "phase B: cosine", signed=True, lsb=16),
        ),
    ),
)  # fmt: skip

CHIP = (
    GCONF,
    replace(general.GSTAT_5160, source=_GENERAL),
    replace(general.IFCNT, source=_GENERAL),
    Register(
        "NODECONF",
        12,
        "patience of the UART; SLAVECONF in the vendor's headers. The address is that of MS1 and MS2",
        address=0x03,
        access=Access.W,
        group=general.GROUP,
        source=_GENERAL,
        fields=tuple(part for part in general.nodeconf().fields if part.name == "SENDDELAY"),
    ),
    _OTP_PROG,
    _OTP_READ,
    IOIN,
    _FACTORY_CONF,
)
AXIS = (
    replace(motion.ihold_irun(0x10), reset=0x00011F10, source=f"{_SPEED} and {_OTP}; API has 0x00071703 as its reset"),
    Register(
        "TPOWERDOWN",
        8,
        "delay from standstill to the lower current; StealthChop needs 2 or more",
        unit="2^18 tCLK",
        address=0x11,
        access=Access.W,
        reset=20,
        group="current",
        source=_SPEED,
    ),
    reading("TSTEP", 20, "time between two of 256 microsteps a full step; all ones at standstill", 0x12, "thresholds",
            unit=CLOCKS, source=_SPEED),
    _threshold("TPWMTHRS", 0x13, "StealthChop where TSTEP is this or more; 0: at every speed"),
    _threshold("TCOOLTHRS", 0x14, "CoolStep, and a stall shown at DIAG, where TSTEP is this or less"),
    Register(
        "VACTUAL",
        24,
        "velocity at which the chip turns the motor by itself, without a ramp; 0: by STEP and DIR",
        signed=True,
        unit=VELOCITY_UNIT,
        range=(-(1 << 23) + 1, (1 << 23) - 1),
        address=0x22,
        access=Access.W,
        group="velocity",
        source=_SPEED,
    ),
    Register(
        "SGTHRS",
        8,
        "a stall is shown where SG_RESULT is twice this or less",
        unit="2",
        address=0x40,
        access=Access.W,
        group=driver.DRIVER,
        source=_STALL,
    ),
    reading("SG_RESULT", 10, "StallGuard4's value: the less, the more load; bits 0 and 9 are always 0", 0x41,
            driver.DRIVER, source=_STALL),
    _COOLCONF,
    *_PLACE_ROWS,
    CHOPCONF,
    DRV_STATUS,
    replace(_PWMCONF, access=Access.RW, reset=0xC10D0024, source=f"{_CHOPPER}.2"),
    replace(_PWM_SCALE, source=f"{_CHOPPER}.2"),
    replace(_PWM_AUTO, source=f"{_CHOPPER}.2"),
)  # fmt: skip


def _row(row: Register, axis: int | None) -> Register:
    """A row of this chip, whose source has begun with the section."""
    section, *more = row.source.split("; ")
    source = "; ".join((f"DS-TMC2209 {section}", *more, VENDOR))
    return with_behaviour(replace(row, source=source)).completed(axis)


TABLE = RegisterTable("tmc2209", (*(_row(row, None) for row in CHIP), *(_row(row, 0) for row in AXIS)))
