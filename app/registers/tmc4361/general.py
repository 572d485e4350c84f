"""General configuration, input filters, step/direction pins and clocks of the TMC4361."""

from __future__ import annotations

from ..model import Access, Field, Register
from .rows import CLOCKS, HEADERS, LOW_HIGH, OFF_ON, TOM, TOM_STEPPYR, TOM_TBONE, TOM_TBONE_STEPPYR

CLOCK_HZ_DEFAULT = 16_000_000
CLOCK_HZ_MIN = 4_194_304
CLOCK_HZ_MAX = 32_000_000
"""Lowest and highest fCLK [Hz] (DS-TMC4361 8.2.3; in words "4.2 MHz up to 32 MHz"; later revisions say 30 MHz)."""

RESET_CODE = 0x525354
"""What RESET_REG takes for a reset: "RST"."""

PINS = "pins and their drivers are not emulated"
NO_DCSTEP = "the emulated motor driver has no dcStep"
NO_LEVELS = "the emulated pulses at STPIN are clean, and tell their direction themselves"
NO_ENCODER_OUTPUT = "nothing listens to the emulated serial encoder output"

_SAMPLE_RATES = {n: f"fCLK / {1 << n}" for n in range(8)}
_LENGTHS = {0: "no filtering"} | {n: f"{n + 1} equal samples" for n in range(1, 8)}


def _filter_group(suffix: str, lsb: int, pins: str) -> tuple[Field, ...]:
    return (
        Field(f"sr_{suffix}", 3, f"sample rate for {pins}", lsb=lsb, values=_SAMPLE_RATES),
        Field(f"filt_l_{suffix}", 3, f"equal samples that make a new level at {pins}", lsb=lsb + 4, values=_LENGTHS),
        Field(
            f"sd_filt{lsb // 8}",
            1,
            f"the filter of {pins} also serves STPIN and DIRIN",
            lsb=lsb + 7,
            values=OFF_ON,
            behaviour=NO_LEVELS,
        ),
    )


GENERAL_ROWS = (
    Register(
        "GENERAL_CONF",
        32,
        "units of ramps, step and direction pins, encoder interface, interrupt pin",
        address=0x00,
        reset=0x6020,
        group="general",
        source=f"DS-TMC4361 8, 8.1, 8.2.3 (bits 5:1); {TOM_TBONE_STEPPYR}; CAMILLE (reset)",
        fields=(
            Field(
                "use_astart_and_vstart",
                1,
                "an S-ramp with a VSTART begins with ASTART instead of AMAX",
                lsb=0,
                values=OFF_ON,
            ),
            Field(
                "direct_acc_val_en",
                1,
                "unit of AMAX, DMAX, ASTART, DFINAL, DSTOP",
                lsb=1,
                values={0: "1/4 pps^2", 1: "fCLK^2 / 2^37"},
            ),
            Field("direct_bow_val_en", 1, "unit of BOW1 to BOW4", lsb=2, values={0: "1 pps^3", 1: "fCLK^3 / 2^53"}),
            Field("step_inactive_pol", 1, "level of STPOUT between steps", lsb=3, values={0: "low", 1: "high"}),
            Field("toggle_step", 1, "what a step is at STPOUT", lsb=4, values={0: "a pulse", 1: "an edge"}),
            Field("pol_dir_out", 1, "level of DIROUT for the negative direction", lsb=5, values={0: "low", 1: "high"}),
            Field(
                "sdin_mode",
                2,
                "where steps come from",
                lsb=6,
                values={
                    0: "the ramp generator",
                    1: "STPIN, rising edges",
                    2: "STPIN, falling edges",
                    3: "STPIN, both edges",
                },
            ),
            Field(
                "pol_dir_in",
                1,
                "level of DIRIN for the negative direction",
                lsb=8,
                values={0: "low", 1: "high"},
                behaviour=NO_LEVELS,
            ),
            Field("sd_indirect_control", 1, "steps at STPIN move XTARGET, and the ramp follows", lsb=9, values=OFF_ON),
            Field(
                "serial_enc_in_mode",
                2,
                "kind of encoder",
                lsb=10,
                values={0: "incremental ABN", 1: "SSI", 2: "reserved", 3: "SPI"},
            ),
            Field(
                "diff_enc_in_disable",
                1,
                "encoder lines",
                lsb=12,
                values={0: "differential", 1: "single ended"},
                behaviour=PINS,
            ),
            Field(
                "stdby_clk_pin_assignment",
                2,
                "what the pin STDBY_CLK shows",
                lsb=13,
                values={0: "standby, low active", 1: "standby, high active", 2: "chopSync clock", 3: "fCLK"},
                behaviour=PINS,
            ),
            Field("intr_pol", 1, "level of an active INTR", lsb=15, values=LOW_HIGH),
            Field("invert_pol_target_reached", 1, "inverts the pin TARGET_REACHED", lsb=16, values=OFF_ON),
            Field("clk_gating_en", 1, "lets CLK_GATING_REG stop the chip's clocks", lsb=17, values=OFF_ON),
            Field("clk_gating_stdby_en", 1, "stops the clocks after the standby delay", lsb=18, values=OFF_ON),
            Field("fs_en", 1, "full steps above FS_VEL", lsb=19, values=OFF_ON),
            Field("fs_sdout", 1, "full steps also at STPOUT", lsb=20, values=OFF_ON),
            Field("dcstep_mode", 2, "dcStep, by kind of motor driver; 0 is off", lsb=21, behaviour=NO_DCSTEP),
            Field("pwm_out_en", 1, "STPOUT and DIROUT give PWM of both phases", lsb=23, values=OFF_ON),
            Field(
                "serial_enc_out_enable",
                1,
                "the driver's SPI pins give encoder data instead",
                lsb=24,
                values=OFF_ON,
                behaviour=NO_ENCODER_OUTPUT,
            ),
            Field(
                "serial_enc_out_diff_disable",
                1,
                "lines of the serial encoder output",
                lsb=25,
                values={0: "differential", 1: "single ended"},
                behaviour=NO_ENCODER_OUTPUT,
            ),
            Field(
                "automatic_direct_sdin_switch_off",
                1,
                "the ramp that takes over from STPIN begins with VSTART and ASTART",
                lsb=26,
                values=OFF_ON,
            ),
            Field(
                "circular_cnt_as_xlatch",
                1,
                "what a reading at 0x36 gives",
                lsb=27,
                values={0: "X_LATCH", 1: "REV_CNT"},
            ),
            Field("reverse_motor_dir", 1, "the microstep table is read backwards", lsb=28, values=OFF_ON),
            Field(
                "intr_tr_pu_pd_en",
                1,
                "pull resistors at INTR and TARGET_REACHED, for wired lines",
                lsb=29,
                values=OFF_ON,
                behaviour=PINS,
            ),
            Field(
                "intr_as_wired_and",
                1,
                "how INTR is wired with pull resistors",
                lsb=30,
                values={0: "wired or", 1: "wired and"},
                behaviour=PINS,
            ),
            Field(
                "tr_as_wired_and",
                1,
                "how TARGET_REACHED is wired with pull resistors",
                lsb=31,
                values={0: "wired or", 1: "wired and"},
                behaviour=PINS,
            ),
        ),
    ),
    Register(
        "INPUT_FILT_CONF",
        32,
        "sample rate and length of the digital filter of each input group",
        address=0x03,
        group="filters",
        source=f"DS-TMC4361 6, 6.1.1, 6.1.2; {TOM_TBONE_STEPPYR} (bits)",
        fields=(
            *_filter_group("enc_in", 0, "the encoder pins"),
            *_filter_group("ref", 8, "STOPL, HOME_REF and STOPR"),
            *_filter_group("s", 16, "START"),
            *_filter_group("enc_out", 24, "the clock of the serial encoder output"),
        ),
    ),
    Register(
        "STP_LENGTH_ADD___DIR_SETUP_TIME",
        32,
        "length of a step pulse, and rest after a change of direction",
        unit=CLOCKS,
        address=0x10,
        group="step/dir",
        source=f"DS-TMC4361 8, 8.1; {TOM} (OLDC's table resets it to 0x00040001: open)",
        fields=(
            Field("STP_LENGTH_ADD", 16, "a step pulse lasts one clock more than this", unit=CLOCKS, lsb=0),
            Field("DIR_SETUP_TIME", 16, "no step for so long after DIROUT changed", unit=CLOCKS, lsb=16),
        ),
    ),
    Register(
        "GEAR_RATIO",
        32,
        "internal steps for each step at STPIN; negative turns the direction round",
        signed=True,
        unit="1/2^24",
        address=0x12,
        reset=0x1000000,
        group="step/dir",
        source=TOM_TBONE_STEPPYR,
    ),
    Register(
        "CLK_GATING_DELAY",
        32,
        "time from the request until the clocks stop",
        unit=CLOCKS,
        address=0x14,
        group="clock",
        source=f"{HEADERS} (unit inferred)",
    ),
    Register(
        "STDBY_DELAY",
        32,
        "time at standstill until standby",
        unit=CLOCKS,
        address=0x15,
        group="clock",
        source=TOM_STEPPYR,
    ),
    Register(
        "CLK_FREQ",
        25,
        "clock at CLK_EXT: all velocities and accelerations are reckoned with it",
        range=(CLOCK_HZ_MIN, CLOCK_HZ_MAX),
        unit="Hz",
        address=0x31,
        reset=CLOCK_HZ_DEFAULT,
        group="clock",
        source=f"DS-TMC4361 1.4, 8, 8.2.3; {TOM_TBONE_STEPPYR}; OLDC (reset)",
    ),
    Register(
        "RESET_CLK_GATING",
        32,
        "stops the chip's clocks, or resets the chip",
        address=0x4F,
        group="clock",
        volatile=True,
        source="TOM4361; STEPPYR; TMC4361A",
        fields=(
            Field("CLK_GATING_REG", 3, "7 stops the clocks, if clk_gating_en", lsb=0),
            Field("RESET_REG", 24, "0x525354 (RST) resets the chip", lsb=8, values={RESET_CODE: "reset"}),
        ),
    ),
    Register(
        "VERSION_NO",
        4,
        "version of the chip",
        address=0x7F,
        access=Access.R,
        reset=None,
        group="general",
        source=TOM,
    ),
)

START_TIME_ROWS = (
    Register(
        "START_OUT_ADD",
        32,
        "a pulse at START lasts one clock more than this",
        unit=CLOCKS,
        address=0x11,
        group="start",
        source=TOM_TBONE,
    ),
    Register(
        "START_DELAY",
        32,
        "time from a trigger to the start that it causes",
        unit=CLOCKS,
        address=0x13,
        group="start",
        source=f"{TOM_TBONE} (unit inferred)",
    ),
)
