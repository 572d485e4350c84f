"""General configuration, input filters, step/direction pins and clocks of the TMC4361."""

from __future__ import annotations

from ..build import RW, R, Rows, choice, flag
from ..model import Field
from .rows import CLOCKS, HEADERS, LOW_HIGH, TOM, TOM_STEPPYR, TOM_TBONE, TOM_TBONE_STEPPYR

_general = Rows("general", HEADERS)
_filters = Rows("filters", HEADERS)
_step_dir = Rows("step/dir", HEADERS)
_clock = Rows("clock", HEADERS)
_start = Rows("start", TOM_TBONE)

CLOCK_HZ_DEFAULT = 16_000_000
CLOCK_HZ_MIN = 4_194_304
CLOCK_HZ_MAX = 32_000_000
"""Lowest and highest fCLK [Hz] (DS-TMC4361 8.2.3; in words "4.2 MHz up to 32 MHz"; later revisions say 30 MHz)."""

RESET_CODE = 0x525354
"""What RESET_REG takes for a reset: "RST"."""

PINS = "pins and their drivers are not emulated"
STEP_READY_AT_45 = "the emulated motor driver is ready for a full step at 45 degrees of lag, whatever this says"
NO_LEVELS = "the emulated pulses at STPIN are clean, and tell their direction themselves"

_SAMPLE_RATES = {n: f"fCLK / {1 << n}" for n in range(8)}
_LENGTHS = {0: "no filtering"} | {n: f"{n + 1} equal samples" for n in range(1, 8)}


def _filter_group(suffix: str, lsb: int, pins: str) -> tuple[Field, ...]:
    return (
        choice(lsb, f"sr_{suffix}", 3, f"sample rate for {pins}", _SAMPLE_RATES),
        choice(lsb + 4, f"filt_l_{suffix}", 3, f"equal samples that make a new level at {pins}", _LENGTHS),
        flag(lsb + 7, f"sd_filt{lsb // 8}", f"the filter of {pins} also serves STPIN and DIRIN", behaviour=NO_LEVELS),
    )


GENERAL_ROWS = (
    _general(
        0x00, "GENERAL_CONF", 32, RW, "units of ramps, step and direction pins, encoder interface, interrupt pin"
    ).having(
        flag(0, "use_astart_and_vstart", "an S-ramp with a VSTART begins with ASTART instead of AMAX"),
        choice(
            1, "direct_acc_val_en", 1, "unit of AMAX, DMAX, ASTART, DFINAL, DSTOP", {0: "1/4 pps^2", 1: "fCLK^2 / 2^37"}
        ),
        choice(2, "direct_bow_val_en", 1, "unit of BOW1 to BOW4", {0: "1 pps^3", 1: "fCLK^3 / 2^53"}),
        choice(3, "step_inactive_pol", 1, "level of STPOUT between steps", {0: "low", 1: "high"}),
        choice(4, "toggle_step", 1, "what a step is at STPOUT", {0: "a pulse", 1: "an edge"}),
        choice(5, "pol_dir_out", 1, "level of DIROUT for the negative direction", {0: "low", 1: "high"}),
        choice(
            6,
            "sdin_mode",
            2,
            "where steps come from",
            {
                0: "the ramp generator",
                1: "STPIN, rising edges",
                2: "STPIN, falling edges",
                3: "STPIN, both edges",
            },
        ),
        choice(
            8, "pol_dir_in", 1, "level of DIRIN for the negative direction", {0: "low", 1: "high"}, behaviour=NO_LEVELS
        ),
        flag(9, "sd_indirect_control", "steps at STPIN move XTARGET, and the ramp follows"),
        choice(
            10, "serial_enc_in_mode", 2, "kind of encoder", {0: "incremental ABN", 1: "SSI", 2: "reserved", 3: "SPI"}
        ),
        choice(12, "diff_enc_in_disable", 1, "encoder lines", {0: "differential", 1: "single ended"}, behaviour=PINS),
        choice(
            13,
            "stdby_clk_pin_assignment",
            2,
            "what the pin STDBY_CLK shows",
            {0: "standby, low active", 1: "standby, high active", 2: "chopSync clock", 3: "fCLK"},
        ),
        choice(15, "intr_pol", 1, "level of an active INTR", LOW_HIGH),
        flag(16, "invert_pol_target_reached", "inverts the pin TARGET_REACHED"),
        flag(17, "clk_gating_en", "lets CLK_GATING_REG stop the chip's clocks"),
        flag(18, "clk_gating_stdby_en", "stops the clocks after the standby delay"),
        flag(19, "fs_en", "full steps above FS_VEL"),
        flag(20, "fs_sdout", "full steps also at STPOUT"),
        choice(
            21,
            "dcstep_mode",
            2,
            "dcStep: above DC_VEL the ramp waits for the motor",
            {0: "off", 1: "by kind of motor driver", 2: "STEP_READY of a TMC2130", 3: "STEP_READY found here, TMC26x"},
        ),
        flag(23, "pwm_out_en", "STPOUT and DIROUT give PWM of both phases"),
        flag(24, "serial_enc_out_enable", "the driver's SPI pins give encoder data instead"),
        choice(
            25,
            "serial_enc_out_diff_disable",
            1,
            "lines of the serial encoder output",
            {0: "differential", 1: "single ended"},
            behaviour=PINS,
        ),
        flag(
            26, "automatic_direct_sdin_switch_off", "the ramp that takes over from STPIN begins with VSTART and ASTART"
        ),
        choice(27, "circular_cnt_as_xlatch", 1, "what a reading at 0x36 gives", {0: "X_LATCH", 1: "REV_CNT"}),
        flag(28, "reverse_motor_dir", "the microstep table is read backwards"),
        flag(29, "intr_tr_pu_pd_en", "pull resistors at INTR and TARGET_REACHED, for wired lines", behaviour=PINS),
        choice(
            30,
            "intr_as_wired_and",
            1,
            "how INTR is wired with pull resistors",
            {0: "wired or", 1: "wired and"},
            behaviour=PINS,
        ),
        choice(
            31,
            "tr_as_wired_and",
            1,
            "how TARGET_REACHED is wired with pull resistors",
            {0: "wired or", 1: "wired and"},
            behaviour=PINS,
        ),
        reset=0x6020,
        source=f"DS-TMC4361 8, 8.1, 8.2.3 (bits 5:1); {TOM_TBONE_STEPPYR}; CAMILLE (reset)",
    ),
    _filters(
        0x03, "INPUT_FILT_CONF", 32, RW, "sample rate and length of the digital filter of each input group"
    ).having(
        *_filter_group("enc_in", 0, "the encoder pins"),
        *_filter_group("ref", 8, "STOPL, HOME_REF and STOPR"),
        *_filter_group("s", 16, "START"),
        *_filter_group("enc_out", 24, "the clock of the serial encoder output"),
        source=f"DS-TMC4361 6, 6.1.1, 6.1.2; {TOM_TBONE_STEPPYR} (bits)",
    ),
    _step_dir(
        0x10, "STP_LENGTH_ADD___DIR_SETUP_TIME", 32, RW, "length of a step pulse, and rest after a change of direction"
    ).having(
        Field("STP_LENGTH_ADD", 16, "a step pulse lasts one clock more than this", unit=CLOCKS, lsb=0),
        Field("DIR_SETUP_TIME", 16, "no step for so long after DIROUT changed", unit=CLOCKS, lsb=16),
        unit=CLOCKS,
        source=f"DS-TMC4361 8, 8.1; {TOM} (OLDC's table resets it to 0x00040001: open)",
    ),
    _step_dir(
        0x12, "GEAR_RATIO", 32, RW, "internal steps for each step at STPIN; negative turns the direction round"
    ).having(signed=True, unit="1/2^24", reset=0x1000000, source=TOM_TBONE_STEPPYR),
    _clock(0x14, "CLK_GATING_DELAY", 32, RW, "time from the request until the clocks stop").having(
        unit=CLOCKS, source=f"{HEADERS} (unit inferred)"
    ),
    _clock(0x15, "STDBY_DELAY", 32, RW, "time at standstill until standby", unit=CLOCKS, source=TOM_STEPPYR),
    _clock(0x31, "CLK_FREQ", 25, RW, "clock at CLK_EXT: all velocities and accelerations are reckoned with it").having(
        range=(CLOCK_HZ_MIN, CLOCK_HZ_MAX),
        unit="Hz",
        reset=CLOCK_HZ_DEFAULT,
        source=f"DS-TMC4361 1.4, 8, 8.2.3; {TOM_TBONE_STEPPYR}; OLDC (reset)",
    ),
    _clock(0x4F, "RESET_CLK_GATING", 32, RW, "stops the chip's clocks, or resets the chip").having(
        Field("CLK_GATING_REG", 3, "7 stops the clocks, if clk_gating_en", lsb=0),
        choice(8, "RESET_REG", 24, "0x525354 (RST) resets the chip", {RESET_CODE: "reset"}),
        volatile=True,
        source="TOM4361; STEPPYR; TMC4361A",
    ),
    _general(0x7F, "VERSION_NO", 4, R, "version of the chip", reset=None, source=TOM),
)

START_TIME_ROWS = (
    _start(0x11, "START_OUT_ADD", 32, RW, "a pulse at START lasts one clock more than this", unit=CLOCKS),
    _start(0x13, "START_DELAY", 32, RW, "time from a trigger to the start that it causes").having(
        unit=CLOCKS, source=f"{TOM_TBONE} (unit inferred)"
    ),
)
