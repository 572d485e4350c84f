"""Configuration, status and pins of the whole chip: addresses 0x00 to 0x0C of the TMC5xxx."""

from __future__ import annotations

from ..model import Access, Field, Register
from .rows import (
    CLOCKS,
    LOW_HIGH,
    MICROSTEPS,
    MODE_RAMP,
    MODE_STEP_DIR,
    OPEN_PUSH,
    VENDOR,
    clearing,
    flag,
    reading,
    state,
)

GROUP = "general"
_BIT_TIMES = {
    code: f"{times} bit times"
    for code, times in zip(range(0, 16, 2), ("8", *(f"{n}*8" for n in range(3, 17, 2))), strict=True)
}


def _gconf(width: int, reset: int, *fields: Field) -> Register:
    return Register(
        "GCONF",
        width,
        "what the chip is set to do",
        address=0x00,
        reset=reset,
        fields=fields,
        group=GROUP,
        source=VENDOR,
    )


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
    Field("diag0_int_pushpull", 1, "driver of the pin DIAG0, or of the interrupt on it", lsb=12, values=OPEN_PUSH),
    Field(
        "diag1_poscomp_pushpull", 1, "driver of the pin DIAG1, or of position compare on it", lsb=13, values=OPEN_PUSH
    ),
    Field(
        "small_hysteresis",
        1,
        "hysteresis of the step frequency that TSTEP is compared with",
        lsb=14,
        values={0: "1/16", 1: "1/32"},
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
    Field(
        "faststandstill",
        1,
        "time without steps after which the motor counts as standing",
        unit=CLOCKS,
        lsb=1,
        values={0: "2^20", 1: "2^18"},
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
    return clearing(
        "GSTAT",
        width,
        "what has happened to the chip",
        0x01,
        GROUP,
        write_clears,
        fields,
    )


GSTAT_5130 = _gstat(3, *_GSTAT_ONE)
GSTAT_5160 = _gstat(3, *_GSTAT_ONE, write_clears=True)
IFCNT = reading("IFCNT", 8, "UART writes that arrived with a right CRC, counted round", 0x02, GROUP, unit="writes")


def nodeconf(source: str = VENDOR) -> Register:
    """NODECONF, which the vendor's headers call SLAVECONF."""
    return Register(
        "NODECONF",
        12,
        "address and patience of the UART; SLAVECONF in the vendor's headers",
        address=0x03,
        access=Access.W,
        group=GROUP,
        source=source,
        fields=(
            Field("NODEADDR", 8, "address of this chip on the line, plus 1 with NEXTADDR high", range=(0, 253), lsb=0),
            _send_delay(8),
        ),
    )


def _send_delay(lsb: int) -> Field:
    return Field(
        "SENDDELAY", 4, "rest before an answer; an odd code is as the even one below", lsb=lsb, values=_BIT_TIMES
    )


def _ioin(enable: str, index: str) -> Register:
    names = ("REFL_STEP", "REFR_DIR", "ENCB_DCEN_CFG4", "ENCA_DCIN_CFG5", enable, index)
    return reading(
        "IOIN",
        32,
        "levels of the pins, and the chip's version",
        0x04,
        GROUP,
        fields=(
            *(Field(name, 1, f"pin {name}", lsb=n, values=LOW_HIGH) for n, name in enumerate(names)),
            Field(
                "SD_MODE",
                1,
                "pin SD_MODE: what moves the motor",
                lsb=6,
                values={0: "ramp generator", 1: "step and direction"},
            ),
            Field("SWCOMP_IN", 1, "comparator of the UART's pins SWN and SWP", lsb=7, values=LOW_HIGH),
            Field("VERSION", 8, "version of the silicon", lsb=24),
        ),
    )


IOIN_5130 = _ioin("DRV_ENN_CFG6", "ENC_N_DCO")
IOIN_5160 = _ioin("DRV_ENN", "ENC_N_DCO_CFG6")
OUTPUT_PIN = Register(
    "OUTPUT",
    1,
    "level of the pin that tells the next chip on a UART its address",
    address=0x04,
    access=Access.W,
    reset=0x1,
    group=GROUP,
    source=VENDOR,
    fields=(
        Field(
            "OUTPUT_PIN_POLARITY", 1, "level of SDO_CFG0 (NEXTADDR of the next chip) with UART", lsb=0, values=LOW_HIGH
        ),
    ),
)
X_COMPARE = Register(
    "X_COMPARE",
    32,
    "position that gives a pulse when XACTUAL is there; the vendor's headers read it unsigned",
    signed=True,
    unit=MICROSTEPS,
    address=0x05,
    access=Access.W,
    group=GROUP,
    source=VENDOR,
)
OTP_5160 = (
    Register(
        "OTP_PROG",
        16,
        "burns one bit of the chip's memory, once and for all",
        address=0x06,
        access=Access.W,
        reset=None,
        group=GROUP,
        source=VENDOR,
        fields=(
            Field("OTPBIT", 3, "which bit", lsb=0),
            Field("OTPBYTE", 2, "which byte: stays 0", lsb=4),
            Field("OTPMAGIC", 8, "anything but the key does nothing", lsb=8, values={0xBD: "burn"}),
        ),
    ),
    Register(
        "OTP_READ",
        8,
        "what is burnt into the chip",
        address=0x07,
        access=Access.R,
        reset=None,
        group=GROUP,
        source=VENDOR,
        fields=(
            Field("OTP_FCLKTRIM", 5, "trim of the internal clock, from the factory", lsb=0),
            Field("otp_S2_LEVEL", 1, "levels of short detection after a reset", lsb=5, values={0: "6", 1: "12"}),
            Field("otp_BBM", 1, "BBMCLKS after a reset", lsb=6, values={0: "4", 1: "2"}),
            Field("otp_TBL", 1, "TBL after a reset", lsb=7, values={0: "2", 1: "1"}),
        ),
    ),
    Register(
        "FACTORY_CONF",
        5,
        "trim of the internal clock; after a reset as burnt",
        address=0x08,
        reset=None,
        group=GROUP,
        source=VENDOR,
        fields=(Field("FCLKTRIM", 5, "0 is slowest, 31 fastest", lsb=0),),
    ),
    Register(
        "SHORT_CONF",
        19,
        "when a current through a MOSFET is a short; another reset with otp_S2_LEVEL burnt",
        address=0x09,
        access=Access.W,
        reset=0x10606,
        group=GROUP,
        source=VENDOR,
        fields=(
            Field("S2VS_LEVEL", 4, "level of the low side; higher is less sensitive", range=(4, 15), lsb=0),
            Field("S2G_LEVEL", 4, "level of the high side; higher is less sensitive", range=(2, 15), lsb=8),
            Field(
                "SHORTFILTER",
                2,
                "how long a spike may last",
                lsb=16,
                values={0: "100 ns", 1: "1 us", 2: "2 us", 3: "3 us"},
            ),
            Field("shortdelay", 1, "rest before the high side is watched", lsb=18, values={0: "750 ns", 1: "1500 ns"}),
        ),
    ),
    Register(
        "DRV_CONF",
        22,
        "how the gates of the MOSFETs are driven; another reset with otp_BBM burnt, API has 0x00080400",
        address=0x0A,
        access=Access.W,
        reset=0x400,
        group=GROUP,
        source=VENDOR,
        fields=(
            Field("BBMTIME", 5, "break before make, from 100 ns (0) to 375 ns (24)", range=(0, 24), lsb=0),
            Field("BBMCLKS", 4, "break before make counted in clocks; the longer of both holds", unit=CLOCKS, lsb=8),
            Field(
                "OTSELECT",
                2,
                "temperature at which the driver shuts down",
                lsb=16,
                values={0: "150 degC", 1: "143 degC", 2: "136 degC", 3: "120 degC"},
            ),
            Field(
                "DRVSTRENGTH",
                2,
                "current into the gates",
                lsb=18,
                values={0: "weak", 1: "weak, medium above the temperature warning", 2: "medium", 3: "strong"},
            ),
            Field(
                "FILT_ISENSE",
                2,
                "filter of the measured current",
                lsb=20,
                values={0: "100 ns", 1: "200 ns", 2: "300 ns", 3: "400 ns"},
            ),
        ),
    ),
)
CURRENT_5160 = (
    Register(
        "GLOBAL_SCALER",
        8,
        "scales all motor currents; 0 stands for 256, and 1 to 31 must not be",
        unit="1/256",
        address=0x0B,
        access=Access.W,
        group="current",
        source=VENDOR,
    ),
    reading(
        "OFFSET_READ",
        16,
        "what the calibration of the current comparators found",
        0x0C,
        "current",
        fields=(
            Field("OFFSET_READ_B", 8, "offset of phase B", signed=True, lsb=0),
            Field("OFFSET_READ_A", 8, "offset of phase A", signed=True, lsb=8),
        ),
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
TEST_SEL = Register(
    "TEST_SEL",
    4,
    "for the factory; SLAVECONF in the vendor's headers",
    address=0x03,
    access=Access.W,
    group=GROUP,
    source=VENDOR,
    fields=(_TEST_SEL,),
)
SLAVECONF = Register(
    "SLAVECONF",
    8,
    "patience of the UART, which knows no addresses",
    address=0x03,
    access=Access.W,
    group=GROUP,
    source=VENDOR,
    fields=(_TEST_SEL, _send_delay(4)),
)


def _input(*fields: Field) -> Register:
    return reading(
        "INPUT",
        32,
        "levels of the pins, and the chip's version",
        0x04,
        GROUP,
        fields=(*fields, Field("VERSION", 8, "version of the silicon", lsb=24)),
    )


def _pin(lsb: int, field: str, pin: str) -> Field:
    return Field(field, 1, f"pin {pin}", lsb=lsb, values=LOW_HIGH)


_PINS = (*(_pin(n, f"io{n}_in", f"IO{n}") for n in range(4)), _pin(4, "iop_in", "IOP"), _pin(5, "ion_in", "ION"))
INPUT_5031 = _input(_pin(7, "DRV_ENN", "DRV_ENN"))
INPUT_5062 = _input(*_PINS, _pin(7, "DRV_ENN", "DRV_ENN"))
INPUT_5072 = _input(
    *_PINS,
    _pin(6, "nextaddr_in", "NEXTADDR"),
    _pin(7, "drv_enn_in", "DRV_ENN"),
    Field("sw_comp_in", 1, "comparator of the UART's pins", lsb=8, values={0: "ION above IOP", 1: "IOP above ION"}),
)


def _output(levels: int, directions: int) -> Register:
    return Register(
        "OUTPUT",
        8 + directions,
        "levels and directions of the pins IO0 and up",
        address=0x04,
        access=Access.W,
        group=GROUP,
        source=VENDOR,
        fields=(
            *(Field(f"io{n}_out", 1, f"level of IO{n} as an output", lsb=n, values=LOW_HIGH) for n in range(levels)),
            *(
                Field(f"ioddr{n}", 1, f"direction of IO{n}", lsb=8 + n, values={0: "input", 1: "output"})
                for n in range(directions)
            ),
        ),
    )


OUTPUT_5062 = _output(4, 4)
OUTPUT_5072 = _output(3, 3)
