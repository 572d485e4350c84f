"""Registers and RAM words of the TMC428, three axes.

An address is the datagram's upper seven bits: RRS as bit 6, then the 6-bit address, so 0x00..0x3F
are registers and 0x40..0x7F the on-chip RAM (data sheet, Table 7-1). "DS-TMC428" in a source stands for
the TMC428 data sheet v2.05; "TMC429 v2.06" for that of its successor, where DS-TMC428 gives no bit
positions (its Tables 7-2 and 9-1 draw them).
"""

from __future__ import annotations

from dataclasses import replace

from ..build import RW, R, Rows, W, choice, flag
from ..model import Access, Field, Register, RegisterTable
from .roles import ACCELERATION_UNIT, VELOCITY_UNIT, divider_fields, interrupt_fields, reference_fields

_motion = Rows("motion", "DS-TMC428")
_current = Rows("current", "DS-TMC428")
_interrupts = Rows("interrupts", "DS-TMC428")
_switches = Rows("switches", "DS-TMC428")
_driver_chain = Rows("driver chain", "DS-TMC428")
_global = Rows("global", "DS-TMC428")
_driver_chain_ram = Rows("driver chain RAM", "DS-TMC428")
_microstep_table_ram = Rows("microstep table RAM", "DS-TMC428")

AXES = 3
RAM_CHAIN = 0x40
"""First of the 32 RAM words of the driver chain configuration."""
RAM_TABLE = 0x60
"""First of the 32 RAM words of the microstep table."""

CURRENT_SCALES = {0: "100 %", **{eighth: f"{eighth * 12.5:g} %" for eighth in range(1, 8)}}
MICROSTEPS = {usrs: f"{1 << usrs} microsteps" if usrs else "full step" for usrs in range(7)}

_SIGNALS = (
    "DAC_A_0 DAC_A_1 DAC_A_2 DAC_A_3 DAC_A_4 DAC_A_5 PH_A FD_A",
    "DAC_B_0 DAC_B_1 DAC_B_2 DAC_B_3 DAC_B_4 DAC_B_5 PH_B FD_B",
    "Zero One Direction Step",
)
SIGNAL_CODES = dict(enumerate(" ".join(_SIGNALS).split()))
"""Primary signal codes (DS-TMC428 Table 11-1); 0x14..0x1F are unused and send 1."""


def _axis_registers(base: int) -> tuple[Register, ...]:
    """Those of the axis whose addresses begin at `base`."""
    return (
        _motion(
            base | 0x0,
            "x_target",
            24,
            RW,
            "where the motor goes in RAMP_MODE and SOFT_MODE; stay within 2^23 of x_actual",
        ).having(signed=True, unit="microsteps", source="DS-TMC428 8.1"),
        _motion(base | 0x1, "x_actual", 24, RW, "where the motor is; may be overwritten to set a reference").having(
            signed=True, unit="microsteps", volatile=True, source="DS-TMC428 8.2"
        ),
        _motion(
            base | 0x2,
            "v_min",
            11,
            RW,
            "speed at or below which the motor may stop dead at its target; at least 1 reaches every target",
        ).having(unit=VELOCITY_UNIT, source="DS-TMC428 8.3"),
        _motion(base | 0x3, "v_max", 11, RW, "speed limit", unit=VELOCITY_UNIT, source="DS-TMC428 8.4"),
        _motion(
            base | 0x4,
            "v_target",
            12,
            RW,
            "wanted velocity: yours in VELOCITY_MODE, the ramp generator's in RAMP_MODE and SOFT_MODE",
        ).having(
            signed=True,
            range=(-2047, 2047),
            unit=VELOCITY_UNIT,
            volatile=True,
            write_note="kept in VELOCITY_MODE; the ramp generator overwrites it in RAMP_MODE and SOFT_MODE",
            source="DS-TMC428 8.5",
        ),
        _motion(
            base | 0x5, "v_actual", 12, Access.RW_IF, "present velocity, without its eight hidden fraction bits"
        ).having(
            signed=True,
            range=(-2047, 2047),
            unit=VELOCITY_UNIT,
            volatile=True,
            write_note="only in HOLD_MODE; writing 0 there stops at once",
            source="DS-TMC428 8.6",
        ),
        _motion(
            base | 0x6, "a_max", 11, RW, "acceleration limit; 0 leaves the motor unable to change its speed"
        ).having(unit=ACCELERATION_UNIT, source="DS-TMC428 8.7"),
        _motion(base | 0x7, "a_actual", 12, R, "acceleration now applied, smoothed for reading").having(
            signed=True, unit=ACCELERATION_UNIT, volatile=True, source="DS-TMC428 8.8"
        ),
        _current(base | 0x8, "is_agtat_is_aleat_is_v0_a_threshold", 23, RW, "coil current by phase of the ramp").having(
            Field(
                "a_threshold",
                11,
                "acceleration above which is_agtat applies; compared signed, so keep it at most 1023",
                unit=ACCELERATION_UNIT,
                lsb=0,
            ),
            choice(12, "is_v0", 3, "current at rest", CURRENT_SCALES, unit="1/8"),
            choice(16, "is_aleat", 3, "current at or below a_threshold", CURRENT_SCALES, unit="1/8"),
            choice(20, "is_agtat", 3, "current above a_threshold", CURRENT_SCALES, unit="1/8"),
            source="DS-TMC428 8.9",
        ),
        _motion(
            base | 0x9,
            "pmul_pdiv",
            16,
            RW,
            "p = (128 + pmul) / 2^(3 + pdiv): speed asked for per microstep of distance left",
        ).having(
            Field("pdiv", 4, "exponent of the divisor", range=(0, 13), lsb=0),
            Field("pmul", 7, "mantissa less its fixed leading one (p_mul - 128)", lsb=8),
            Field("pmul_msb_one", 1, "the mantissa's leading one, fixed", reset=1, lsb=15, access=R),
            reset=0x8000,
            source="DS-TMC428 8.10; TMC429 v2.06, p. 21 (bit 15)",
        ),
        _motion(base | 0xA, "lp_ref_conf_rm", 17, RW, "ramp mode and what the switches do").having(
            *reference_fields(upper_case=False), source="DS-TMC428 8.12, Tables 8-3 to 8-5"
        ),
        _interrupts(
            base | 0xB,
            "interrupt_mask_interrupt_flags",
            16,
            RW,
            "what happened, and what is watched for; a flag whose mask is off stays 0",
        ).having(*interrupt_fields(upper_case=True), volatile=True, source="DS-TMC428 8.13, Tables 8-6 and 8-7"),
        _motion(base | 0xC, "pulse_div_ramp_div_usrs", 16, RW, "clock dividers and microstep resolution").having(
            choice(0, "usrs", 3, "microsteps per full step, 2^usrs", MICROSTEPS, range=(0, 6)),
            *divider_fields(upper_case=False),
            write_note="change pulse_div in RAMP_MODE only, elsewhere it may force a microstep",
            source="DS-TMC428 8.14, Table 8-8",
        ),
        _switches(
            base | 0xD, "dx_ref_tolerance", 12, RW, "distance around position zero where switches do not stop the motor"
        ).having(unit="microsteps", source="DS-TMC428 8.15; TMC429 v2.06, p. 21 (width)"),
        _switches(
            base | 0xE, "x_latched", 24, Access.RW_IF, "x_actual at the last change of the reference switch while armed"
        ).having(
            signed=True,
            unit="microsteps",
            volatile=True,
            write_note="any write arms the latch and sets lp; the value itself cannot be written",
            source="DS-TMC428 8.16",
        ),
    )


def _global_registers() -> tuple[Register, ...]:
    rearms = "any write re-arms the capture of the next reply of the chain"
    return (
        _driver_chain(
            0x30, "datagram_low_word", 24, Access.RW_IF, "last 24 bits that came back from the driver chain"
        ).having(volatile=True, write_note=rearms, source="DS-TMC428 9.1"),
        _driver_chain(
            0x31, "datagram_high_word", 24, Access.RW_IF, "the 24 bits that came back before those of datagram_low_word"
        ).having(volatile=True, write_note=rearms, source="DS-TMC428 9.1"),
        _driver_chain(
            0x32, "cover_pos_cover_len", 24, RW, "which bits of the next datagram to the chain are covered"
        ).having(
            Field("cover_len", 5, "how many bits are covered", unit="bits", range=(0, 24), lsb=0),
            Field("cover_pos", 6, "first covered bit, counted from 0", unit="bits", lsb=8),
            Field("cw", 1, "a cover datagram waits to be sent", lsb=23, access=R),
            volatile=True,
            write_note="cover_pos reads back as cover_pos + 1",
            source="DS-TMC428 9.2; TMC429 v2.06, p. 21 (bits)",
        ),
        _driver_chain(
            0x33,
            "cover_datagram",
            24,
            RW,
            "bits sent to the chain once, over those of the next datagram; writing sends",
        ).having(source="DS-TMC428 9.3"),
        _global(0x38, "power_down", 24, W, "any write stops the chip's clocks until the next datagram begins").having(
            reset=None, source="DS-TMC428 9.5"
        ),
        _switches(0x3E, "l3_r3_l2_r2_l1_r1", 6, R, "switch states as the chip sees them").having(
            *(
                choice(
                    2 * (motor - 1) + (side == "l"),
                    f"{side}{motor}",
                    1,
                    f"{'left' if side == 'l' else 'right'} switch of motor {motor}",
                    {0: "inactive", 1: "active"},
                    access=R,
                    reset=None,
                )
                for motor in (1, 2, 3)
                for side in ("r", "l")
            ),
            reset=None,
            volatile=True,
            source="DS-TMC428 9.6; TMC429 v2.06, p. 21 (bits)",
        ),
        _global(
            0x3F,
            "stepper_motor_global_parameter_register",
            22,
            RW,
            "driver chain timing and polarities, and how the switch inputs are shared out",
        ).having(
            choice(
                0,
                "LSMD",
                2,
                "last stepper motor driver: drivers in the chain minus one",
                {0: "1 driver", 1: "2 drivers", 2: "3 drivers"},
                range=(0, 2),
            ),
            choice(2, "polarity_nscs_s", 1, "chip select of the chain", {0: "low active", 1: "high active"}),
            choice(3, "polarity_sck_s", 1, "clock of the chain", {0: "as drawn", 1: "inverted"}),
            choice(4, "polarity_PH_AB", 1, "phase bits; turns the motor round", {0: "as is", 1: "inverted"}),
            choice(5, "polarity_FD", 1, "fast decay bits", {0: "high active", 1: "low active"}),
            choice(6, "polarity_DAC_AB", 1, "DAC bits", {0: "high active", 1: "low active"}),
            choice(7, "csCommonIndividual", 1, "chip selects", {0: "one, common", 1: "three, individual"}),
            Field(
                "clk2_div",
                8,
                "clock divider of the chain, fCLK / (2 * (clk2_div + 1)); 7 suits TMC236 and its family",
                range=(7, 255),
                reset=15,
                lsb=8,
            ),
            flag(
                16,
                "continuous_update",
                "datagrams go out at rest too: needed for multiplexed switches and current at rest",
            ),
            flag(20, "refmux", "a 74HC157 multiplexes six switches; mot1r is then ignored"),
            choice(21, "mot1r", 1, "what REF3 is", {0: "left of motor 3", 1: "right of motor 1"}),
            reset=0xF00,
            source="DS-TMC428 9.7, Tables 9-1 to 9-3; TMC429 v2.06, p. 45 (bits)",
        ),
    )


def _chain_words() -> tuple[Register, ...]:
    def half(parity: int, word: int, lsb: int) -> tuple[Field, Field]:
        cell = 2 * word + parity
        return (
            choice(
                lsb,
                f"signal_code_{parity}",
                5,
                f"signal sent at position {cell} of the chain's datagram",
                SIGNAL_CODES,
                reset=None,
            ),
            choice(
                lsb + 5,
                f"NxM_{parity}",
                1,
                "next motor: the bits after this one belong to the next driver",
                {0: "same driver", 1: "next driver"},
                reset=None,
            ),
        )

    return tuple(
        _driver_chain_ram(
            RAM_CHAIN | word,
            f"chain_conf_{word:02d}",
            14,
            RW,
            f"driver chain configuration, positions {2 * word} and {2 * word + 1}; random after power-on",
        ).having(*half(0, word, 0) + half(1, word, 8), reset=None, source="DS-TMC428 Tables 10-1 and 11-1")
        for word in range(32)
    )


def _table_words() -> tuple[Register, ...]:
    return tuple(
        _microstep_table_ram(
            RAM_TABLE | word,
            f"lut_{word:02d}",
            14,
            RW,
            f"microstep table, entries {2 * word} and {2 * word + 1}; random after power-on",
        ).having(
            Field("y_even", 6, f"entry {2 * word}", unit="DAC counts", lsb=0, reset=None),
            Field("y_odd", 6, f"entry {2 * word + 1}", unit="DAC counts", lsb=8, reset=None),
            reset=None,
            source="DS-TMC428 Tables 10-1 and 12-1",
        )
        for word in range(32)
    )


TMC428 = RegisterTable(
    "tmc428",
    (
        *(replace(register, axis=axis) for axis in range(AXES) for register in _axis_registers(axis << 4)),
        *_global_registers(),
        *_chain_words(),
        *_table_words(),
    ),
)
