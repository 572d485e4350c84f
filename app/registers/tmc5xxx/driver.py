"""Microstep table, chopper, StealthChop and status of the TMC5xxx's motor driver, as their first axis has them."""

from __future__ import annotations

from ..build import RW, Rows, W, choice, flag, state
from ..microstep_rows import GROUP as TABLE
from ..microstep_rows import START_RESET, mslut_rows
from ..model import Field, Register
from .rows import CLOCKS, VENDOR, VENDOR_RESET

DRIVER = "driver"
PWM = "stealthchop"
_table = Rows(TABLE, VENDOR)
_driver = Rows(DRIVER, VENDOR)
_pwm = Rows(PWM, VENDOR)
BLANK_CLOCKS = {0: 16, 1: 24, 2: 36, 3: 54}
"""TBL: clocks during which the current comparator is not looked at."""
MRES = {n: f"{256 >> n}" for n in range(9)}

_SPREADCYCLE = "chm = 0"
_CONSTANT_OFF = "chm = 1"
_THREE_PHASES = "ph3sel = 1"


def table_rows(start_90: str) -> tuple[Register, ...]:
    """0x60 to 0x69: the quarter wave and its start. start_90: what the chip calls the value at place 256."""
    return (
        *mslut_rows(0x60, VENDOR_RESET, f"{VENDOR}; {VENDOR_RESET}"),
        _table(0x69, "MSLUTSTART", 24, W, "values of the wave at its zero crossing and its peak").having(
            Field("START_SIN", 8, "value at place 0", lsb=0),
            Field(start_90, 8, "value at place 256", lsb=16),
            reset=START_RESET,
        ),
    )


PLACE_ROWS = (
    _table.reading(0x6A, "MSCNT", 10, "place of phase B in the microstep table now; phase A is 256 ahead").having(
        unit="1/1024 electrical turn"
    ),
    _table.reading(0x6B, "MSCURACT", 25, "both values of the microstep table now, before scaling").having(
        Field("CUR_B", 9, "phase B: sine", signed=True, lsb=0),
        Field("CUR_A", 9, "phase A: cosine", signed=True, lsb=16),
        source="API and PY have A and B the other way round",
    ),
)

# --- chopper ------------------------------------------------------------------------------------

_TOFF = Field(
    "toff",
    4,
    "slow decay lasts 24 + 32 times this many clocks; 0 switches the driver off, 1 only with tbl of 2 or 3",
    lsb=0,
)
_DECAY = (
    Field("hstrt", 3, "start of the hysteresis above hend: 1 to 8", unit="1, plus 1", lsb=4, when=_SPREADCYCLE),
    Field("tfd_2_0", 3, "fast decay time, low bits; 32 clocks each", lsb=4, when=_CONSTANT_OFF),
    Field("hend", 4, "end of the hysteresis: -3 to 12", unit="1, minus 3", lsb=7, when=_SPREADCYCLE),
    Field("offset", 4, "offset of the sine wave: -3 to 12", unit="1, minus 3", lsb=7, when=_CONSTANT_OFF),
    Field("fd3", 1, "fast decay time, highest bit", lsb=11, when=_CONSTANT_OFF),
    choice(
        12,
        "disfdcc",
        1,
        "what ends fast decay",
        {0: "time, or current below zero", 1: "time alone"},
        when=_CONSTANT_OFF,
    ),
)
RANDOM = flag(13, "rndtf", "the off time varies at random")
_CHM = choice(14, "chm", 1, "kind of chopper", {0: "SpreadCycle", 1: "constant off time"})
_TBL = choice(
    15,
    "tbl",
    2,
    "time in which the comparator is not looked at",
    {code: str(clocks) for code, clocks in BLANK_CLOCKS.items()},
    unit=CLOCKS,
)
_VSENSE = choice(
    17, "vsense", 1, "voltage at the sense resistor for full current", {0: "low sensitivity", 1: "high sensitivity"}
)
_HIGH_SPEED = (
    flag(18, "vhighfs", "full steps above the high velocity threshold"),
    flag(19, "vhighchm", "constant off time with fast decay above the high velocity threshold"),
)
_SYNC = Field("sync", 4, "chopper kept in step with a clock of fCLK / (64 n); 0 not at all", lsb=20)
_MRES = choice(24, "mres", 4, "microsteps a full step", MRES, range=(0, 8))
_DEDGE = flag(29, "dedge", "both edges of STEP make a step")
_SHORT_TO_GROUND = flag(30, "diss2g", "a short to ground is not looked for")


def _intpol(name: str) -> Field:
    return flag(28, name, "steps are interpolated to 256 microsteps")


def _chopconf(width: int, *fields: Field, reset: int = 0) -> Register:
    return _driver(0x6C, "CHOPCONF", width, RW, "how the chopper regulates the coil currents", reset=reset).having(
        _TOFF, *_DECAY, *fields
    )


_CLASSIC = (RANDOM, _CHM, _TBL, _VSENSE, *_HIGH_SPEED)
CHOPCONF_5031 = _chopconf(31, *_CLASSIC, _SYNC, _SHORT_TO_GROUND)
"""Always 256 microsteps: no mres."""
CHOPCONF_5062 = _chopconf(
    32,
    *_CLASSIC,
    _SYNC,
    _MRES,
    _intpol("intpol16"),
    _SHORT_TO_GROUND,
    choice(
        31,
        "ph3sel",
        1,
        "kind of motor; with three phases bits 15..0 mean something else",
        {0: "two phases", 1: "three phases"},
    ),
    Field("hyst", 6, "hysteresis", lsb=4, when=_THREE_PHASES),
    flag(10, "nosd3ph", "no slow decay", when=_THREE_PHASES),
    flag(12, "csync", "the choppers of all phases are kept in step", when=_THREE_PHASES),
)
CHOPCONF_5072 = _chopconf(31, *_CLASSIC, _MRES, _intpol("intpol16"), _DEDGE, _SHORT_TO_GROUND)
CHOPCONF_5130 = _chopconf(31, *_CLASSIC, _SYNC, _MRES, _intpol("intpol"), _DEDGE, _SHORT_TO_GROUND)
CHOPCONF_5160 = _chopconf(
    32,
    _CHM,
    _TBL,
    *_HIGH_SPEED,
    Field("tpfd", 4, "passive fast decay, against resonance at mid speeds; 0 off", unit="128 tCLK", lsb=20),
    _MRES,
    _intpol("intpol"),
    _DEDGE,
    _SHORT_TO_GROUND,
    flag(31, "diss2vs", "a short to the supply is not looked for"),
    reset=0x10410150,
)
"""tbl resets to 2, or as burnt in otp_TBL."""

COOLCONF = _driver(0x6D, "COOLCONF", 25, W, "CoolStep and StallGuard").having(
    Field("semin", 4, "SG_RESULT below this raises the current; 0 switches CoolStep off", unit="32", lsb=0),
    choice(5, "seup", 2, "steps up of the current each time", {0: "1", 1: "2", 2: "4", 3: "8"}),
    Field("semax", 4, "SG_RESULT this far above semin lowers the current", unit="32, plus 32", lsb=8),
    choice(13, "sedn", 2, "values of SG_RESULT for each step down", {0: "32", 1: "8", 2: "2", 3: "1"}),
    choice(15, "seimin", 1, "least current, of IRUN", {0: "1/2", 1: "1/4"}),
    Field("sgt", 7, "level of StallGuard: higher is less sensitive", signed=True, lsb=16),
    choice(24, "sfilt", 1, "SG_RESULT as measured", {0: "each full step", 1: "mean of four full steps"}),
)


def dcctrl(time_bits: int, sg_lsb: int, source: str = VENDOR) -> Register:
    """DCCTRL: 10 bits of DC_TIME and DC_SG from bit 16, with two axes 8 bits and from bit 8."""
    return _driver(0x6E, "DCCTRL", sg_lsb + 8, W, "how DcStep commutates", source=source).having(
        Field("DC_TIME", time_bits, "longest time that current is let in", unit=CLOCKS, lsb=0),
        Field("DC_SG", 8, "shortest time that is no lost step; 0 does not look", unit="16 tCLK", lsb=sg_lsb),
    )


def _drv_status(*more: Field) -> Register:
    return _driver.reading(0x6F, "DRV_STATUS", 32, "load, current and faults of the driver now").having(
        Field("SG_RESULT", 10, "StallGuard's value: the less, the more load; 0 at a stall", lsb=0),
        *more,
        state(15, "fsactive", "full steps now"),
        Field("CS_ACTUAL", 5, "current scale now", unit="1/32, plus 1/32", lsb=16),
        state(24, "StallGuard", "a stall"),
        state(25, "ot", "too hot: the driver is off"),
        state(26, "otpw", "warning of overtemperature"),
        state(27, "s2ga", "short to ground at phase A: the driver is off"),
        state(28, "s2gb", "short to ground at phase B: the driver is off"),
        state(29, "ola", "no load at phase A; tells nothing at rest and at high speed"),
        state(30, "olb", "no load at phase B; tells nothing at rest and at high speed"),
        state(31, "stst", "the motor stands"),
    )


DRV_STATUS = _drv_status()
DRV_STATUS_5160 = _drv_status(
    state(12, "s2vsa", "short to the supply at phase A: the driver is off"),
    state(13, "s2vsb", "short to the supply at phase B: the driver is off"),
    state(14, "stealth", "StealthChop now"),
)

# --- StealthChop --------------------------------------------------------------------------------

_FREQUENCY = choice(
    16, "pwm_freq", 2, "frequency of the PWM, of fCLK", {0: "2/1024", 1: "2/683", 2: "2/512", 3: "2/410"}
)
_AUTOSCALE = flag(18, "pwm_autoscale", "the current is regulated by what is measured")
_FREEWHEEL = choice(
    20,
    "freewheel",
    2,
    "at rest, with IHOLD = 0",
    {0: "normal", 1: "free", 2: "coils shorted, low side", 3: "coils shorted, high side"},
)


def _pwmconf(address: int, width: int, reset: int, *fields: Field) -> Register:
    return _pwm(address, "PWMCONF", width, W, "StealthChop", reset=reset).having(*fields)


_AMPLITUDE = (
    Field("PWM_AMPL", 8, "amplitude; with pwm_autoscale the limit when StealthChop takes over", lsb=0),
    Field("PWM_GRAD", 8, "amplitude that velocity adds; with pwm_autoscale the greatest change a half wave", lsb=8),
)
PWM_5072 = (
    _pwmconf(0x10, 22, 0, *_AMPLITUDE, _FREQUENCY, _AUTOSCALE, _FREEWHEEL),
    _pwm.reading(0x11, "PWM_STATUS", 8, "amplitude now, at most 255"),
)
PWM_5130 = (
    _pwmconf(
        0x70,
        22,
        0x50480,
        *_AMPLITUDE,
        _FREQUENCY,
        _AUTOSCALE,
        flag(19, "pwm_symmetric", "both sides of a PWM period are alike"),
        _FREEWHEEL,
    ),
    _pwm.reading(0x71, "PWM_SCALE", 8, "amplitude now, at most 255"),
)
PWM_5160 = (
    _pwmconf(
        0x70,
        32,
        0xC40C001E,
        Field("PWM_OFS", 8, "amplitude at rest; where pwm_autoscale begins", lsb=0),
        Field("PWM_GRAD", 8, "amplitude that velocity adds; where pwm_autograd begins", lsb=8),
        _FREQUENCY,
        _AUTOSCALE,
        flag(19, "pwm_autograd", "PWM_GRAD is found by itself, in motion"),
        _FREEWHEEL,
        Field("PWM_REG", 4, "greatest change of the amplitude a half wave, with pwm_autoscale", unit="1/2", lsb=24),
        Field("PWM_LIM", 4, "limit of the amplitude when StealthChop takes over again", lsb=28),
    ),
    _pwm.reading(0x71, "PWM_SCALE", 25, "amplitude now, and what the regulation adds to it").having(
        Field("PWM_SCALE_SUM", 8, "amplitude now", lsb=0),
        Field("PWM_SCALE_AUTO", 9, "what pwm_autoscale adds", signed=True, range=(-255, 255), lsb=16),
    ),
    _pwm.reading(0x72, "PWM_AUTO", 24, "what StealthChop has found by itself").having(
        Field("PWM_OFS_AUTO", 8, "amplitude at rest", lsb=0),
        Field("PWM_GRAD_AUTO", 8, "amplitude that velocity adds", lsb=16),
    ),
)
ENCM_CTRL = _driver(0x72, "ENCM_CTRL", 2, W, "commutation by the encoder: for the factory").having(
    flag(0, "inv", "the encoder counts the other way"),
    flag(1, "maxspeed", "steps are ignored"),
)
LOST_STEPS = _driver.reading(0x73, "LOST_STEPS", 20, "steps that DcStep left out, counted round", unit="steps")
