"""Rows of the TMC5240 that its sisters do not have so: eight points, current measured inside, StallGuard4, an ADC.

All of its registers can be read back (API, table of access). Sources: FIELDS-TMC5240, API, PY. Where FIELDS-TMC5240
contradicts itself (V2 as a distance from VMAX, A2 and D2 as between V1 and V2), A2 and D2 are followed.
"""

from __future__ import annotations

from dataclasses import replace

from ..build import RW, R, Rows, W, choice, flag, state
from ..model import Field, Register
from . import driver, general, motion
from .rows import (
    ACCELERATION_UNIT,
    CLOCKS,
    LOW_HIGH,
    MICROSTEPS,
    VELOCITY_UNIT,
    VENDOR,
    VENDOR_RESET,
    clearing,
)

SUPPLY_UNIT, INPUT_UNIT, TEMPERATURE_UNIT = "9.732 mV", "0.3052 mV", "1/7.7 degC"
VERSION = 0x40
MONITOR = "monitor"
_general = Rows(general.GROUP, VENDOR)
_current = Rows("current", VENDOR)
_ramp = Rows("ramp", VENDOR)
_switches = Rows("switches", VENDOR)
_monitor = Rows(MONITOR, VENDOR)
_driver = Rows(driver.DRIVER, VENDOR)
KLIPPER = f"{VENDOR}; KLIPPER (unit)"


NO_DCSTEP = "the emulated chip has no DcStep: whether the silicon has it is not known"


def _readable(*rows: Register) -> tuple[Register, ...]:
    """Rows of the sisters, which can only write some of them."""
    return tuple(replace(row, access=RW) if row.access is W else row for row in rows)


# --- the whole chip -----------------------------------------------------------------------------

_GCONF = tuple(part for part in general.GCONF_5160.fields if 1 <= part.lsb <= 16 and part.lsb not in (7, 8, 11))
_PINS = ("REFL_STEP", "REFR_DIR", "ENCB_CFG4", "ENCA_CFG5", "DRV_ENN", "ENCN_CFG6", "UART_EN")
_COMPARATORS = (
    (8, "COMP_A", "comparator of the chopper, phase A"),
    (9, "COMP_B", "comparator of the chopper, phase B"),
    (10, "COMP_A1_A2", "comparator of StallGuard4, phase A"),
    (11, "COMP_B1_B2", "comparator of StallGuard4, phase B"),
    (12, "OUTPUT", "level of SDO_CFG0, the address of the next chip on a UART"),
)
_IOIN = (
    *(choice(lsb, name, 1, f"pin {name}", LOW_HIGH) for lsb, name in enumerate(_PINS)),
    *(choice(lsb, name, 1, help_, LOW_HIGH) for lsb, name, help_ in _COMPARATORS),
    state(13, "EXT_RES_DET", "a resistor between IREF and ground was seen"),
    choice(14, "EXT_CLK", 1, "where the clock comes from", {0: "inside", 1: "outside"}),
    state(15, "ADC_ERR", "the ADC does not work"),
    Field("SILICON_RV", 3, "revision of the silicon", lsb=16),
    Field("VERSION", 8, "version of the chip", lsb=24),
)
CHIP = (
    _general(0x00, "GCONF", 21, RW, "what the chip is set to do").having(
        *_GCONF,
        flag(7, "diag0_stall_step", "DIAG0 shows a stall or gives steps"),
        flag(8, "diag1_stall_dir", "DIAG1 shows a stall or gives the direction"),
        Field("length_step_pulse", 4, "length of a step pulse; 0: each step changes the level", unit=CLOCKS, lsb=17),
        reset=0x8,
        source=f"{VENDOR}; {VENDOR_RESET}",
    ),
    clearing(general.GROUP, 0x01, "GSTAT", 5, "what has happened to the chip", write_clears=True).having(
        *general.GSTAT_5160.fields,
        state(3, "register_reset", "all registers are as after power-on"),
        state(4, "vm_uvlo", "the motor supply was too low"),
    ),
    general.IFCNT,
    *_readable(general.nodeconf(f"{VENDOR}; the levels of SCK and SDI add 0 to 3")),
    _general.reading(
        0x04, "IOIN", 32, "levels of the pins, and the chip's version; INP_OUT in the vendor's headers"
    ).having(*_IOIN),
    replace(
        general.OUTPUT_PIN,
        width=13,
        reset=1 << 12,
        fields=tuple(replace(part, lsb=12) for part in general.OUTPUT_PIN.fields),
        write_note="reads back as IOIN.OUTPUT",
    ),
)
AXIS = (
    *_readable(general.X_COMPARE),
    _general(
        0x06,
        "X_COMPARE_REPEAT",
        24,
        RW,
        "distance after which X_COMPARE counts again, both ways; less than 2: only once",
    ).having(unit=MICROSTEPS, source="API; PY has OTP_PROG here"),
    _current(0x0A, "DRV_CONF", 12, RW, "range of the motor current, and how the bridges switch").having(
        choice(
            0,
            "CURRENT_RANGE",
            2,
            "greatest peak current; with another resistor than 12 kOhm at IREF less",
            {0: "1 A", 1: "2 A", 2: "3 A", 3: "3 A"},
        ),
        choice(
            4, "SLOPE_CONTROL", 2, "slope of the bridges", {0: "100 V/us", 1: "200 V/us", 2: "400 V/us", 3: "800 V/us"}
        ),
        Field("BBM_CLKS", 4, "break before make counted in clocks", unit=CLOCKS, lsb=8),
        reset=0x20,
        source=f"{VENDOR}; {VENDOR_RESET}; PRUNT; KLIPPER; in BBM_CLKS: API alone",
    ),
    *_readable(general.CURRENT_5160[0]),
    _current(0x10, "IHOLD_IRUN", 28, RW, "motor current in motion and at rest").having(
        *motion.ihold_irun(0x10).fields,
        Field("IRUNDELAY", 4, "time for each step up to IRUN; 0 at once", unit="512 tCLK", lsb=24),
        reset=0x04011F08,
        source=f"{VENDOR}; reset inferred from drivers that restore it",
    ),
    *_readable(
        *motion.time_threshold_rows(0xA, "delay from standstill to the lower current; StealthChop needs 2 or more")
    ),
)

# --- ramp ---------------------------------------------------------------------------------------

_WIDE = {"A1", "AMAX", "DMAX", "D1"}
_HELP = {
    "AMAX": "acceleration from V2 (without it V1) to VMAX; in velocity modes the only slope, up and down",
    "DMAX": "deceleration from VMAX to V2, without it to V1",
}


def _ramp_row(row: Register) -> Register:
    if row.name in _WIDE:
        row = replace(row, width=18, reset=10 if row.name == "D1" else 0, help=_HELP.get(row.name, row.help))
    return row


def _acceleration(name: str, address: int, help_: str, reset: int = 0) -> Register:
    return _ramp(address, name, 18, RW, help_, reset=reset, unit=ACCELERATION_UNIT)


RAMP = (
    *_readable(*(_ramp_row(row) for row in motion.ramp_rows(vstop_reset=10))),
    _ramp(
        0x29,
        "TVMAX",
        16,
        RW,
        "least time at constant velocity between speeding up and braking while positioning; in velocity modes 0",
    ).having(unit="512 tCLK"),
    _ramp(0x2E, "V2", 20, RW, "velocity between the two upper slopes each way; 0 leaves A2 and D2 out").having(
        unit=VELOCITY_UNIT
    ),
    _acceleration("A2", 0x2F, "acceleration from V1 to V2"),
    _acceleration("D2", 0x30, "deceleration from V2 to V1; never 0 while positioning, not even with V2 = 0", 10),
    _ramp.reading(0x31, "AACTUAL", 24, "acceleration now", unit=ACCELERATION_UNIT, signed=True),
    *_readable(replace(motion.VDCMIN, behaviour=NO_DCSTEP)),
    _switches(0x34, "SW_MODE", 15, RW, motion.SW_MODE.help).having(
        *motion.SW_MODE.fields,
        flag(12, "en_virtual_stop_l", "VIRTUAL_STOP_L stops motion to the left"),
        flag(13, "en_virtual_stop_r", "VIRTUAL_STOP_R stops motion to the right"),
        choice(14, "virtual_stop_enc", 1, "what the virtual stops look at", {0: "XACTUAL", 1: "X_ENC"}),
    ),
    replace(
        motion.ramp_stat(write_clears=True),
        width=16,
        fields=(
            *motion.ramp_stat(write_clears=True).fields,
            state(14, "status_virtual_stop_l", "the left virtual stop is active", access=R),
            state(15, "status_virtual_stop_r", "the right virtual stop is active", access=R),
        ),
    ),
    motion.XLATCH,
    *_readable(*motion.ENCODER_5160),
    _switches(0x3E, "VIRTUAL_STOP_L", 32, RW, "position at and below which motion to the left is stopped").having(
        unit=MICROSTEPS, signed=True
    ),
    _switches(0x3F, "VIRTUAL_STOP_R", 32, RW, "position at and above which motion to the right is stopped").having(
        unit=MICROSTEPS, signed=True
    ),
)

# --- measured -----------------------------------------------------------------------------------

ADC = (
    _monitor.reading(0x50, "ADC_VSUPPLY_AIN", 29, "voltages of the motor supply and of the pin AIN").having(
        Field("ADC_VSUPPLY", 13, "motor supply", unit=SUPPLY_UNIT, lsb=0),
        Field("ADC_AIN", 13, "pin AIN", unit=INPUT_UNIT, lsb=16),
        source=f"{KLIPPER}; EVAL-5240 takes 9.766 mV for the supply",
    ),
    _monitor.reading(0x51, "ADC_TEMP", 13, "temperature of the chip: 2038 is 0 degC").having(
        unit=TEMPERATURE_UNIT, source=f"{KLIPPER}; EVAL-5240"
    ),
    _monitor(0x52, "OTW_OV_VTH", 29, RW, "from which temperature and supply on the chip warns").having(
        Field("OVERVOLTAGE_VTH", 13, "supply at which the output OV is set", unit=SUPPLY_UNIT, lsb=0),
        Field(
            "OVERTEMPPREWARNING_VTH", 13, "ADC_TEMP at which otpw is set: 2038 is 0 degC", unit=TEMPERATURE_UNIT, lsb=16
        ),
        reset=0x0B920F25,
        source=f"{KLIPPER}; {VENDOR_RESET}",
    ),
)

# --- driver -------------------------------------------------------------------------------------

_START = driver.table_rows("START_SIN90")[-1]
_PWMCONF, _PWM_SCALE, _PWM_AUTO = driver.PWM_5160
DRIVER = (
    *_readable(*driver.table_rows("START_SIN90")[:-1]),
    *_readable(
        replace(
            _START,
            width=32,
            fields=(
                *_START.fields,
                Field("OFFSET_SIN90", 8, "microsteps by which phase A is ahead of 256", signed=True, lsb=24),
            ),
        )
    ),
    *driver.PLACE_ROWS,
    replace(
        driver.CHOPCONF_5160,
        fields=(*driver.CHOPCONF_5160.fields, driver.RANDOM),
        source=f"{VENDOR}; rndtf: API alone; reset inferred: as a TMC5160",
    ),
    *_readable(driver.COOLCONF, replace(driver.dcctrl(10, 16), behaviour=NO_DCSTEP)),
    driver.DRV_STATUS_5160,
    *_readable(
        replace(
            _PWMCONF,
            fields=(
                *_PWMCONF.fields,
                flag(22, "pwm_meas_sd_enable", "current is measured in slow decay too: lower currents are regulated"),
                flag(23, "pwm_dis_reg_stst", "no regulation at rest with less than the run current"),
            ),
            source=f"{VENDOR}; reset: FIELDS-TMC5240 (API has bit 22 set)",
        )
    ),
    replace(
        _PWM_SCALE,
        fields=(
            Field("PWM_SCALE_SUM", 10, "amplitude now, with two bits more than elsewhere", lsb=0),
            _PWM_SCALE.fields[1],
        ),
    ),
    _PWM_AUTO,
    _driver(0x74, "SG4_THRS", 10, RW, "StallGuard4, which measures load with StealthChop").having(
        Field("SG4_THRS", 8, "a stall at SG4_RESULT of twice this or less", unit="2", lsb=0),
        flag(8, "sg4_filt_en", "SG4_RESULT is the mean of four measurements"),
        flag(9, "sg_angle_offset", "the phase is kept where StealthChop gives way to SpreadCycle"),
    ),
    _driver.reading(0x75, "SG4_RESULT", 10, "StallGuard4's value: the less, the more load").having(
        source=f"{VENDOR}; bits 0 and 9 are always 0"
    ),
    _driver.reading(
        0x76, "SG4_IND", 32, "the latest measurements of StallGuard4; without the filter the first alone"
    ).having(*tuple(Field(f"SG4_IND_{n}", 8, f"measurement {n}", unit="2", lsb=8 * n) for n in range(4))),
)
