"""What the TMC4361 sends to the motor driver: SPI output, currents, PWM, and the microstep table."""

from __future__ import annotations

from ..build import RW, R, Rows, W, choice, flag
from ..microstep_rows import mslut_rows
from ..model import Field
from .events import TMC24X, TMC26X
from .general import STEP_READY_AT_45
from .rows import CLOCKS, HEADERS, STEPPYR, TOM, TOM_STEPPYR, TOM_TBONE, TOM_TBONE_STEPPYR

_spi_output = Rows("spi output", STEPPYR)
_current = Rows("current", TOM_STEPPYR)
_pwm = Rows("pwm", HEADERS)
_closed_loop = Rows("closed loop", HEADERS)
_driver = Rows("driver", HEADERS)
_microsteps = Rows("microsteps", STEPPYR)

SCALE_UNIT = "1/256, plus 1/256"
NO_CHOPSYNC = "the emulated motor driver chops by itself"
NO_REPEATING = "the emulated chip sends a cover datagram once, and rests between questions by poll_block_exp"
ONE_DRIVER = "the emulated motor driver is reached whatever these bits say"

_FORMATS = {
    0: "off",
    1: "SPI DAC, values of full amplitude",
    2: "SPI DAC, absolute values, phase 0 is positive",
    3: "SPI DAC, absolute values, phase 0 is negative",
    4: "current scale",
    5: "both currents",
    6: "SPI DAC, current scale",
    8: "TMC23x",
    9: "TMC24x",
    10: "TMC26x and TMC389, SPI",
    11: "TMC26x, step/direction",
    12: "TMC2130, step/direction",
    13: "TMC2130, SPI",
    15: "cover datagrams only",
}
_NO_TMC = "no TMC motor driver"
_STEP_DIR = "TMC26x or TMC2130 by step/direction"

_SPI_OUT_CONF = _spi_output(0x04, "SPI_OUT_CONF", 32, RW, "kind of motor driver, and the timing of its SPI").having(
    choice(0, "spi_output_format", 4, "what is connected to the SPI output", _FORMATS),
    Field(
        "ssi_out_mtime",
        20,
        "monoflop time",
        unit=CLOCKS,
        lsb=4,
        when="serial encoder output",
    ),
    Field("mixed_decay", 2, "phases with mixed decay", lsb=4, when=TMC24X),
    Field("stdby_on_stall_for_24x", 1, "a stall switches to standby", lsb=6, when=TMC24X, behaviour=ONE_DRIVER),
    Field(
        "stall_flag_instead_of_uv_en",
        1,
        "STATUS bit 24 shows a stall, not undervoltage",
        lsb=7,
        when=TMC24X,
    ),
    Field("stall_load_limit", 3, "a load value below it is a stall", lsb=8, when=TMC24X),
    Field("pwm_phase_shft_en", 1, "phases are chopped in turn", lsb=11, when=TMC24X, behaviour=NO_CHOPSYNC),
    Field(
        "auto_double_chopsync",
        1,
        "chopper clock doubles at standstill (STEPPYR: double_freq_at_stdby)",
        lsb=12,
        when=TMC24X,
    ),
    Field("three_phase_stepper_en", 1, "three-phase motor at a TMC389", lsb=4, when=TMC26X, behaviour=ONE_DRIVER),
    Field("scale_val_transfer_en", 1, "current scales are sent to the driver", lsb=5, when=_STEP_DIR),
    Field("disable_polling", 1, "the driver is not asked for its status", lsb=6, when=_STEP_DIR),
    Field(
        "poll_block_mult",
        6,
        "rest between two questions to the driver, as the original chip's header has it",
        lsb=7,
        when=f"{_STEP_DIR} (PY4361)",
        behaviour=NO_REPEATING,
    ),
    Field(
        "autorepeat_cover_en", 1, "cover datagrams repeat", lsb=7, when=f"{TMC26X} (TMC4361A)", behaviour=NO_REPEATING
    ),
    Field("poll_block_exp", 4, "rest between two questions, as a power of 2", lsb=8, when=f"{TMC26X} (TMC4361A)"),
    Field(
        "cover_done_only_for_cover",
        1,
        "COVER_DONE means cover datagrams only",
        lsb=12,
        when=f"{TMC26X} (TMC4361A)",
    ),
    Field("sck_low_before_csn", 1, "clock before chip select", lsb=4, when=_NO_TMC, behaviour=ONE_DRIVER),
    Field("new_out_bit_at_rise", 1, "clock edge of new bits", lsb=5, when=_NO_TMC, behaviour=ONE_DRIVER),
    Field("dac_cmd_length", 5, "bits of a DAC command", lsb=7, when="SPI DAC"),
    Field("cover_data_length", 7, "bits of a cover datagram, up to 64; 0 for those of TMC drivers", lsb=13),
    Field("spi_out_low_time", 4, "low time of the clock", unit=CLOCKS, lsb=20),
    Field("spi_out_high_time", 4, "high time of the clock", unit=CLOCKS, lsb=24),
    Field("spi_out_block_time", 4, "rest between datagrams", unit=CLOCKS, lsb=28),
    source=TOM_TBONE_STEPPYR,
)

_CLOSED_LOOP_SCALE = "closed_loop_scale_en"

_CURRENT_ROWS = (
    _current(0x05, "CURRENT_CONF", 32, RW, "which current scales apply, and the PWM amplitude").having(
        flag(0, "hold_current_scale_en", "HOLD_SCALE_VAL at standstill"),
        flag(1, "drive_current_scale_en", "DRV1_SCALE_VAL in motion"),
        flag(2, "boost_current_on_acc_en", "BOOST_SCALE_VAL while the speed rises"),
        flag(3, "boost_current_on_dec_en", "BOOST_SCALE_VAL while the speed falls"),
        flag(4, "boost_current_after_start_en", "BOOST_SCALE_VAL for BOOST_TIME after a start"),
        flag(5, "sec_drive_current_scale_en", "DRV2_SCALE_VAL above VDRV_SCALE_LIMIT"),
        flag(6, "freewheeling_en", "no current after FREEWHEEL_DELAY at standstill"),
        flag(7, "closed_loop_scale_en", "closed loop sets the scale by the deviation"),
        flag(8, "pwm_scale_en", "the PWM amplitude rises with the speed"),
        Field("pwm_ampl", 16, "PWM amplitude at standstill, plus 1", unit="1/2^17", lsb=16),
    ),
    _current(0x06, "SCALE_VALUES", 32, RW, "current scales of the situations that CURRENT_CONF enables").having(
        Field("boost_scale_val", 8, "while boosted", unit=SCALE_UNIT, lsb=0),
        Field("drv1_scale_val", 8, "in motion", unit=SCALE_UNIT, lsb=8),
        Field("drv2_scale_val", 8, "in motion above VDRV_SCALE_LIMIT", unit=SCALE_UNIT, lsb=16),
        Field("hold_scale_val", 8, "at standstill", unit=SCALE_UNIT, lsb=24),
        Field("cl_imin", 8, "least scale", unit=SCALE_UNIT, lsb=0, when=_CLOSED_LOOP_SCALE),
        Field("cl_imax", 8, "greatest scale", unit=SCALE_UNIT, lsb=8, when=_CLOSED_LOOP_SCALE),
        Field("cl_start_up", 8, "deviation from which the scale rises", lsb=16, when=_CLOSED_LOOP_SCALE),
        Field("cl_start_dn", 8, "deviation from which it falls; 0 for CL_BETA", lsb=24, when=_CLOSED_LOOP_SCALE),
        reset=0xFFFFFFFF,
        source=f"{TOM_STEPPYR}; OLDC (reset)",
    ),
    _current(0x17, "VDRV_SCALE_LIMIT", 24, RW, "speed above which DRV2_SCALE_VAL applies", unit="pps"),
    _pwm(0x17, "PWM_VMAX", 24, RW, "speed at which the PWM amplitude is full").having(
        unit="pps", when="pwm_out_en", source=f"{HEADERS} (unit inferred)"
    ),
    _current(0x18, "UP_SCALE_DELAY", 24, RW, "time that each step of a rising scale takes", unit=CLOCKS),
    _closed_loop(0x18, "CL_UPSCALE_DELAY", 24, RW, "time that each step of a rising scale takes in closed loop").having(
        unit=CLOCKS, when=_CLOSED_LOOP_SCALE, source=f"{STEPPYR} (time of one step inferred)"
    ),
    _current(0x19, "HOLD_SCALE_DELAY", 24, RW, "time that each step down to HOLD_SCALE_VAL takes", unit=CLOCKS),
    _closed_loop(
        0x19, "CL_DNSCALE_DELAY", 24, RW, "time that each step of a falling scale takes in closed loop"
    ).having(unit=CLOCKS, when=_CLOSED_LOOP_SCALE, source=f"{STEPPYR} (time of one step inferred)"),
    _current(0x1A, "DRV_SCALE_DELAY", 24, RW, "time that each step of a scale takes in motion", unit=CLOCKS),
    _current(0x1B, "BOOST_TIME", 24, RW, "how long a start boosts the current").having(
        unit=CLOCKS, source=f"{TOM_STEPPYR} (STEPPYR: 32 bits)"
    ),
    _current(0x16, "FREEWHEEL_DELAY", 32, RW, "time at standstill until the motor is without current", unit=CLOCKS),
    _current(0x7C, "SCALE_PARAM", 9, R, "current scale that applies now").having(
        unit=SCALE_UNIT, reset=None, volatile=True, source=HEADERS
    ),
)

_DRIVER_ROWS = (
    _driver(
        0x0A, "STEP_CONF", 24, RW, "microsteps and full steps of the motor; driver flags that make a MOTOR_EV"
    ).having(
        choice(0, "mstep_per_fs", 4, "microsteps a full step", {n: str(256 >> n) for n in range(9)}, range=(0, 8)),
        Field("fs_per_rev", 12, "full steps a revolution of the motor", unit="full steps", lsb=4),
        *(Field(name, 1, f"MOTOR_EV for {name}", lsb=bit) for name, bit in (("OT", 17), ("OTPW", 18))),
        *(Field(name, 1, f"MOTOR_EV for {name}", lsb=bit) for name, bit in (("OLA", 21), ("OLB", 22))),
        *(
            Field(name, 1, f"MOTOR_EV for {name}", lsb=bit, when=TMC26X)
            for name, bit in (("SG", 16), ("S2GA", 19), ("S2GB", 20), ("STST", 23))
        ),
        *(
            Field(name, 1, f"MOTOR_EV for {name}", lsb=bit, when=TMC24X)
            for name, bit in (("UV_SF", 16), ("OCA", 19), ("OCB", 20), ("OCHS", 23))
        ),
        reset=0xFB0C80,
        source=f"{TOM_TBONE_STEPPYR}; CAMILLE (reset)",
    ),
    _spi_output(0x1D, "SPI_SWITCH_VEL", 24, RW, "speed at which automatic_cover sends its datagrams").having(
        unit="pps", behaviour="the emulated driver keeps one configuration at all speeds"
    ),
    _spi_output(0x1D, "DAC_ADDR", 32, RW, "what is sent to a DAC before the currents").having(
        Field("DAC_ADDR_A", 16, "before CURRENTA_SPI", lsb=0),
        Field("DAC_ADDR_B", 16, "before CURRENTB_SPI", lsb=16),
        when="SPI DAC",
    ),
    _pwm(0x1F, "PWM_FREQ", 16, RW, "period of the PWM", source=f"DS-TMC4361 1.3.4; {TOM}; OLDC (reset)").having(
        unit=CLOCKS, reset=0x280
    ),
    _spi_output(0x1F, "CHOPSYNC_DIV", 12, RW, "period of the chopper clock").having(
        unit=CLOCKS, reset=0x280, when="chopSync with TMC23x or TMC24x", source=f"{HEADERS}; API (96..818)"
    ),
    _driver(0x60, "FS_VEL", 24, W, "speed from which full steps are used, if fs_en").having(
        unit="pps", source=f"{STEPPYR} (STEPPYR: 32 bits)"
    ),
    _driver(0x60, "DC_VEL", 24, W, "speed from which dcStep may slow the motor down").having(
        unit="pps", when="dcstep_mode is on", source=STEPPYR
    ),
    _driver(0x61, "DC_TIME___DC_SG___DC_BLKTIME", 32, W, "times of dcStep", behaviour=STEP_READY_AT_45).having(
        Field("DC_TIME", 8, "longest PWM on time before commutation", unit=CLOCKS, lsb=0),
        Field("DC_SG", 8, "on time below which a step is taken for lost", unit="16 tCLK", lsb=8),
        Field("DC_BLKTIME", 16, "blank time after a full step", unit=CLOCKS, lsb=16),
    ),
    _driver(0x62, "DC_LSPTM", 32, W, "time of a full step at low speed").having(
        unit=CLOCKS, reset=0xFFFFFF, when="dcstep_mode is on"
    ),
    _driver(0x67, "VSTALL_LIMIT", 24, W, "speed above which stop_on_stall acts", unit="pps"),
    _spi_output(
        0x6C, "COVER_LOW", 32, W, "lower half of a datagram for the motor driver; writing it sends both halves"
    ).having(source=TOM_TBONE_STEPPYR),
    _spi_output(0x6C, "POLLING_STATUS", 32, R, "latest status of the motor driver").having(
        reset=None, volatile=True, source="STEPPYR; TMC4361A"
    ),
    _spi_output(
        0x6D, "COVER_HIGH", 32, W, "upper half of a datagram for the motor driver: write it before COVER_LOW"
    ).having(source=TOM_TBONE),
    _spi_output(0x6D, "POLLING_REG", 32, R, "what else a TMC2130 answers to polling; its fields are not known").having(
        reset=None, volatile=True, source=HEADERS, behaviour="reads 0"
    ),
    _spi_output(0x6E, "COVER_DRV_LOW", 32, R, "lower half of the driver's answer to a cover datagram", volatile=True),
    _spi_output(0x6F, "COVER_DRV_HIGH", 32, R, "upper half of the driver's answer to a cover datagram").having(
        volatile=True, source=HEADERS
    ),
)

_MICROSTEP_ROWS = (
    *mslut_rows(0x70, STEPPYR, f"{STEPPYR} (fields as in the TMC5130's data sheet)"),
    _microsteps(0x79, "MSCNT", 10, R, "place in the microstep table now", unit="1/1024 electrical turn", volatile=True),
    _microsteps(0x79, "MSOFFSET", 10, W, "offset of the place in the microstep table").having(
        unit="1/1024 electrical turn", write_note="counts with PWM output only; cannot be read back"
    ),
    _microsteps(0x7A, "CURRENTA_B", 25, R, "both values of the microstep table now, before scaling").having(
        Field("CURRENTA", 9, "phase A: sine", signed=True, lsb=0),
        Field("CURRENTB", 9, "phase B: cosine", signed=True, lsb=16),
        reset=0xF70000,
        volatile=True,
        source=f"{HEADERS}; OLDC (reset)",
    ),
    _microsteps(0x7B, "CURRENTA_B_SPI", 25, R, "both values after scaling, as sent to the driver").having(
        Field("CURRENTA_SPI", 9, "phase A", signed=True, lsb=0),
        Field("CURRENTB_SPI", 9, "phase B", signed=True, lsb=16),
        reset=0xF70000,
        volatile=True,
        source=f"{HEADERS}; OLDC (reset)",
    ),
    _microsteps(
        0x7E, "START_SIN___START_SIN90_120___DAC_OFFSET", 32, W, "values of the wave at its zero crossing and its peak"
    ).having(
        Field("START_SIN", 8, "value at place 0", lsb=0),
        Field("START_SIN90_120", 8, "value of phase B at place 0", lsb=16),
        Field("DAC_OFFSET", 8, "added for a DAC", lsb=24),
        reset=0xF70000,
    ),
)

OUTPUT_ROWS = (_SPI_OUT_CONF, *_CURRENT_ROWS, *_DRIVER_ROWS, *_MICROSTEP_ROWS)
