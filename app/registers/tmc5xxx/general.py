"""Configuration, status and pins of the whole chip: addresses 0x00 to 0x0C of the TMC5xxx."""

from __future__ import annotations

from ..build import RW, R, Rows, W, choice, flag, state
from ..model import Field, Register
from .rows import (
    CLOCKS,
    LOW_HIGH,
    MICROSTEPS,
    MODE_RAMP,
    MODE_STEP_DIR,
    OPEN_PUSH,
    VENDOR,
    clearing,
)

GROUP = "general"
_general = Rows(GROUP, VENDOR)
_current = Rows("current", VENDOR)
_BIT_TIMES = {
    code: f"{times} bit times"
    for code, times in zip(range(0, 16, 2), ("8", *(f"{n}*8" for n in range(3, 17, 2))), strict=True)
}


def _gconf(width: int, reset: int, *fields: Field) -> Register:
    return _general(0x00, "GCONF", width, RW, "what the chip is set to do", reset=reset).having(*fields)


# --- one axis -----------------------------------------------------------------------------------

_DIAGNOSTICS = (
    flag(4, "shaft", "the motor turns the other way"),
    flag(5, "diag0_error", "DIAG0 shows errors of the driver"),
    flag(6, "diag0_otpw", "DIAG0 shows the warning of overtemperature"),
    flag(7, "diag0_stall", "DIAG0 shows a stall", when=MODE_STEP_DIR),
    flag(7, "diag0_step", "DIAG0 gives steps", when=MODE_RAMP),
    flag(8, "diag1_stall", "DIAG1 shows a stall", when=MODE_STEP_DIR),
    flag(8, "diag1_dir", "DIAG1 gives the direction", when=MODE_RAMP),
    flag(9, "diag1_index", "DIAG1 shows place 0 of the microstep table"),
    flag(10, "diag1_onstate", "DIAG1 shows that the chopper lets current in"),
    flag(11, "diag1_steps_skipped", "DIAG1 changes with each step that DcStep leaves out"),
    choice(12, "diag0_int_pushpull", 1, "driver of the pin DIAG0, or of the interrupt on it", OPEN_PUSH),
    choice(13, "diag1_poscomp_pushpull", 1, "driver of the pin DIAG1, or of position compare on it", OPEN_PUSH),
    choice(
        14,
        "small_hysteresis",
        1,
        "hysteresis of the step frequency that TSTEP is compared with",
        {0: "1/16", 1: "1/32"},
    ),
    flag(15, "stop_enable", "the pin ENCA_DCIN stops the motor at once while it is high"),
    flag(16, "direct_mode", "XTARGET sets both coil currents instead of a position"),
    flag(17, "test_mode", "for the factory: stays off"),
)
GCONF_5130 = _gconf(
    18,
    0x0,
    flag(0, "I_scale_analog", "the voltage at AIN scales the motor current"),
    flag(1, "internal_Rsense", "current is measured inside the chip, without sense resistors"),
    flag(2, "en_pwm_mode", "StealthChop where the velocity allows it"),
    flag(3, "enc_commutation", "the encoder commutates the motor: for the factory, stays off"),
    *_DIAGNOSTICS,
)
GCONF_5160 = _gconf(
    18,
    0x8,
    flag(0, "recalibrate", "measures the offsets of the current comparators again while the driver is off"),
    choice(
        1,
        "faststandstill",
        1,
        "time without steps after which the motor counts as standing",
        {0: "2^20", 1: "2^18"},
        unit=CLOCKS,
    ),
    flag(2, "en_pwm_mode", "StealthChop where the velocity allows it"),
    flag(3, "multistep_filt", "filters the steps that StealthChop sees"),
    *_DIAGNOSTICS,
)
_GSTAT_ONE = (
    state(0, "reset", "the chip has been reset: all registers are as after power-on"),
    state(1, "drv_err", "the driver has shut down: overtemperature or a short; DRV_STATUS tells which"),
    state(2, "uv_cp", "the charge pump has too little voltage, and the driver is off"),
)


def _gstat(width: int, *fields: Field, write_clears: bool = False) -> Register:
    return clearing(GROUP, 0x01, "GSTAT", width, "what has happened to the chip", write_clears).having(*fields)


GSTAT_5130 = _gstat(3, *_GSTAT_ONE)
GSTAT_5160 = _gstat(3, *_GSTAT_ONE, write_clears=True)
IFCNT = _general.reading(0x02, "IFCNT", 8, "UART writes that arrived with a right CRC, counted round").having(
    unit="writes"
)


def nodeconf(source: str = VENDOR) -> Register:
    """NODECONF, which the vendor's headers call SLAVECONF."""
    return _general(
        0x03, "NODECONF", 12, W, "address and patience of the UART; SLAVECONF in the vendor's headers"
    ).having(
        Field("NODEADDR", 8, "address of this chip on the line, plus 1 with NEXTADDR high", range=(0, 253), lsb=0),
        _send_delay(8),
        source=source,
    )


def _send_delay(lsb: int) -> Field:
    return choice(lsb, "SENDDELAY", 4, "rest before an answer; an odd code is as the even one below", _BIT_TIMES)


def _ioin(enable: str, index: str) -> Register:
    names = ("REFL_STEP", "REFR_DIR", "ENCB_DCEN_CFG4", "ENCA_DCIN_CFG5", enable, index)
    return _general.reading(0x04, "IOIN", 32, "levels of the pins, and the chip's version").having(
        *(choice(n, name, 1, f"pin {name}", LOW_HIGH) for n, name in enumerate(names)),
        choice(6, "SD_MODE", 1, "pin SD_MODE: what moves the motor", {0: "ramp generator", 1: "step and direction"}),
        choice(7, "SWCOMP_IN", 1, "comparator of the UART's pins SWN and SWP", LOW_HIGH),
        Field("VERSION", 8, "version of the silicon", lsb=24),
    )


IOIN_5130 = _ioin("DRV_ENN_CFG6", "ENC_N_DCO")
IOIN_5160 = _ioin("DRV_ENN", "ENC_N_DCO_CFG6")
OUTPUT_PIN = _general(0x04, "OUTPUT", 1, W, "level of the pin that tells the next chip on a UART its address").having(
    choice(0, "OUTPUT_PIN_POLARITY", 1, "level of SDO_CFG0 (NEXTADDR of the next chip) with UART", LOW_HIGH), reset=0x1
)
X_COMPARE = _general(
    0x05, "X_COMPARE", 32, W, "position that gives a pulse when XACTUAL is there; the vendor's headers read it unsigned"
).having(signed=True, unit=MICROSTEPS)
OTP_5160 = (
    _general(0x06, "OTP_PROG", 16, W, "burns one bit of the chip's memory, once and for all", reset=None).having(
        Field("OTPBIT", 3, "which bit", lsb=0),
        Field("OTPBYTE", 2, "which byte: stays 0", lsb=4),
        choice(8, "OTPMAGIC", 8, "anything but the key does nothing", {0xBD: "burn"}),
    ),
    _general(0x07, "OTP_READ", 8, R, "what is burnt into the chip", reset=None).having(
        Field("OTP_FCLKTRIM", 5, "trim of the internal clock, from the factory", lsb=0),
        choice(5, "otp_S2_LEVEL", 1, "levels of short detection after a reset", {0: "6", 1: "12"}),
        choice(6, "otp_BBM", 1, "BBMCLKS after a reset", {0: "4", 1: "2"}),
        choice(7, "otp_TBL", 1, "TBL after a reset", {0: "2", 1: "1"}),
    ),
    _general(0x08, "FACTORY_CONF", 5, RW, "trim of the internal clock; after a reset as burnt", reset=None).having(
        Field("FCLKTRIM", 5, "0 is slowest, 31 fastest", lsb=0)
    ),
    _general(
        0x09, "SHORT_CONF", 19, W, "when a current through a MOSFET is a short; another reset with otp_S2_LEVEL burnt"
    ).having(
        Field("S2VS_LEVEL", 4, "level of the low side; higher is less sensitive", range=(4, 15), lsb=0),
        Field("S2G_LEVEL", 4, "level of the high side; higher is less sensitive", range=(2, 15), lsb=8),
        choice(16, "SHORTFILTER", 2, "how long a spike may last", {0: "100 ns", 1: "1 us", 2: "2 us", 3: "3 us"}),
        choice(18, "shortdelay", 1, "rest before the high side is watched", {0: "750 ns", 1: "1500 ns"}),
        reset=0x10606,
    ),
    _general(
        0x0A,
        "DRV_CONF",
        22,
        W,
        "how the gates of the MOSFETs are driven; another reset with otp_BBM burnt, API has 0x00080400",
    ).having(
        Field("BBMTIME", 5, "break before make, from 100 ns (0) to 375 ns (24)", range=(0, 24), lsb=0),
        Field("BBMCLKS", 4, "break before make counted in clocks; the longer of both holds", unit=CLOCKS, lsb=8),
        choice(
            16,
            "OTSELECT",
            2,
            "temperature at which the driver shuts down",
            {0: "150 degC", 1: "143 degC", 2: "136 degC", 3: "120 degC"},
        ),
        choice(
            18,
            "DRVSTRENGTH",
            2,
            "current into the gates",
            {0: "weak", 1: "weak, medium above the temperature warning", 2: "medium", 3: "strong"},
        ),
        choice(
            20, "FILT_ISENSE", 2, "filter of the measured current", {0: "100 ns", 1: "200 ns", 2: "300 ns", 3: "400 ns"}
        ),
        reset=0x400,
    ),
)
CURRENT_5160 = (
    _current(
        0x0B, "GLOBAL_SCALER", 8, W, "scales all motor currents; 0 stands for 256, and 1 to 31 must not be"
    ).having(unit="1/256"),
    _current.reading(0x0C, "OFFSET_READ", 16, "what the calibration of the current comparators found").having(
        Field("OFFSET_READ_B", 8, "offset of phase B", signed=True, lsb=0),
        Field("OFFSET_READ_A", 8, "offset of phase A", signed=True, lsb=8),
    ),
)

# --- two axes -----------------------------------------------------------------------------------

_DUAL_DIRECTIONS = (
    flag(7, "test_mode", "for the factory: stays off"),
    flag(8, "shaft1", "motor 1 turns the other way"),
    flag(9, "shaft2", "motor 2 turns the other way"),
    flag(10, "lock_gconf", "no write changes GCONF any more, until a reset"),
)
_ENCODER_PINS = (
    flag(4, "enc1_refsel", "the index channel of encoder 1 comes from REFL1"),
    flag(5, "enc2_enable", "encoder 2 counts, on the pins REFR1 and REFR2"),
    flag(6, "enc2_refsel", "the index channel of encoder 2 comes from REFL2"),
)
_POSCMP = flag(3, "poscmp_enable", "position compare and interrupt leave by the pins of encoder 1, which is off then")
GCONF_5031 = _gconf(
    11, 0, flag(3, "poscmp_enable", "position compare and interrupt leave by PP and INT"), *_DUAL_DIRECTIONS
)
GCONF_5062 = _gconf(11, 0, _POSCMP, *_ENCODER_PINS, *_DUAL_DIRECTIONS)
GCONF_5072 = _gconf(
    12,
    0,
    flag(0, "single_driver", "both drivers side by side for one motor of twice the current"),
    flag(1, "stepdir1_enable", "motor 1 by step and direction"),
    flag(2, "stepdir2_enable", "motor 2 by step and direction"),
    _POSCMP,
    *_ENCODER_PINS,
    *_DUAL_DIRECTIONS,
    flag(11, "dc_sync", "DcStep slows both motors down together"),
)
GSTAT_DUAL = _gstat(
    4,
    state(0, "reset", "the chip has been reset: all registers are as after power-on"),
    state(1, "drv_err1", "driver 1 has shut down: overtemperature or a short; DRV_STATUS tells which"),
    state(2, "drv_err2", "driver 2 has shut down; the vendor's headers leave it out"),
    state(3, "uv_cp", "the charge pump has too little voltage, and the drivers are off"),
)
_TEST_SEL = Field("TEST_SEL", 4, "output for the factory: stays 0", lsb=0)
TEST_SEL = _general(0x03, "TEST_SEL", 4, W, "for the factory; SLAVECONF in the vendor's headers").having(_TEST_SEL)
SLAVECONF = _general(0x03, "SLAVECONF", 8, W, "patience of the UART, which knows no addresses").having(
    _TEST_SEL, _send_delay(4)
)


def _input(*fields: Field) -> Register:
    return _general.reading(0x04, "INPUT", 32, "levels of the pins, and the chip's version").having(
        *fields, Field("VERSION", 8, "version of the silicon", lsb=24)
    )


def _pin(lsb: int, field: str, pin: str) -> Field:
    return choice(lsb, field, 1, f"pin {pin}", LOW_HIGH)


_PINS = (*(_pin(n, f"io{n}_in", f"IO{n}") for n in range(4)), _pin(4, "iop_in", "IOP"), _pin(5, "ion_in", "ION"))
INPUT_5031 = _input(_pin(7, "DRV_ENN", "DRV_ENN"))
INPUT_5062 = _input(*_PINS, _pin(7, "DRV_ENN", "DRV_ENN"))
INPUT_5072 = _input(
    *_PINS,
    _pin(6, "nextaddr_in", "NEXTADDR"),
    _pin(7, "drv_enn_in", "DRV_ENN"),
    choice(8, "sw_comp_in", 1, "comparator of the UART's pins", {0: "ION above IOP", 1: "IOP above ION"}),
)


def _output(levels: int, directions: int) -> Register:
    return _general(0x04, "OUTPUT", 8 + directions, W, "levels and directions of the pins IO0 and up").having(
        *(choice(n, f"io{n}_out", 1, f"level of IO{n} as an output", LOW_HIGH) for n in range(levels)),
        *(choice(8 + n, f"ioddr{n}", 1, f"direction of IO{n}", {0: "input", 1: "output"}) for n in range(directions)),
    )


OUTPUT_5062 = _output(4, 4)
OUTPUT_5072 = _output(3, 3)
