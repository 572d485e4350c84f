"""Registers and RAM words of the TMC428, three axes.

An address is the datagram's upper seven bits: RRS as bit 6, then the 6-bit address, so 0x00..0x3F
are registers and 0x40..0x7F the on-chip RAM (data sheet, Table 7-1). "DS-TMC428" in a source stands for
the TMC428 data sheet v2.05; "TMC429 v2.06" for that of its successor, where DS-TMC428 gives no bit
positions (its Tables 7-2 and 9-1 draw them).
"""

from __future__ import annotations

from ..model import Access, Field, Register, RegisterTable
from .roles import ACCELERATION_UNIT, OFF_ON, VELOCITY_UNIT, divider_fields, interrupt_fields, reference_fields

AXES = 3
RAM_CHAIN = 0x40
"""First of the 32 RAM words of the driver chain configuration."""
RAM_TABLE = 0x60
"""First of the 32 RAM words of the microstep table."""

CURRENT_SCALES = {0: "100 %", **{eighth: f"{eighth * 12.5:g} %" for eighth in range(1, 8)}}
MICROSTEPS = {usrs: f"{1 << usrs} microsteps" if usrs else "full step" for usrs in range(7)}

SIGNAL_CODES = {
    0x00: "DAC_A_0",
    0x01: "DAC_A_1",
    0x02: "DAC_A_2",
    0x03: "DAC_A_3",
    0x04: "DAC_A_4",
    0x05: "DAC_A_5",
    0x06: "PH_A",
    0x07: "FD_A",
    0x08: "DAC_B_0",
    0x09: "DAC_B_1",
    0x0A: "DAC_B_2",
    0x0B: "DAC_B_3",
    0x0C: "DAC_B_4",
    0x0D: "DAC_B_5",
    0x0E: "PH_B",
    0x0F: "FD_B",
    0x10: "Zero",
    0x11: "One",
    0x12: "Direction",
    0x13: "Step",
}
"""Primary signal codes (DS-TMC428 Table 11-1); 0x14..0x1F are unused and send 1."""


def _axis_registers(axis: int) -> tuple[Register, ...]:
    base = axis << 4
    return (
        Register(
            "x_target",
            24,
            "where the motor goes in RAMP_MODE and SOFT_MODE; stay within 2^23 of x_actual",
            signed=True,
            unit="microsteps",
            address=base | 0x0,
            axis=axis,
            source="DS-TMC428 8.1",
        ),
        Register(
            "x_actual",
            24,
            "where the motor is; may be overwritten to set a reference",
            signed=True,
            unit="microsteps",
            address=base | 0x1,
            axis=axis,
            volatile=True,
            source="DS-TMC428 8.2",
        ),
        Register(
            "v_min",
            11,
            "speed at or below which the motor may stop dead at its target; at least 1 reaches every target",
            unit=VELOCITY_UNIT,
            address=base | 0x2,
            axis=axis,
            source="DS-TMC428 8.3",
        ),
        Register(
            "v_max",
            11,
            "speed limit",
            unit=VELOCITY_UNIT,
            address=base | 0x3,
            axis=axis,
            source="DS-TMC428 8.4",
        ),
        Register(
            "v_target",
            12,
            "wanted velocity: yours in VELOCITY_MODE, the ramp generator's in RAMP_MODE and SOFT_MODE",
            signed=True,
            range=(-2047, 2047),
            unit=VELOCITY_UNIT,
            address=base | 0x4,
            axis=axis,
            volatile=True,
            write_note="kept in VELOCITY_MODE; the ramp generator overwrites it in RAMP_MODE and SOFT_MODE",
            source="DS-TMC428 8.5",
        ),
        Register(
            "v_actual",
            12,
            "present velocity, without its eight hidden fraction bits",
            signed=True,
            range=(-2047, 2047),
            unit=VELOCITY_UNIT,
            address=base | 0x5,
            axis=axis,
            access=Access.RW_IF,
            volatile=True,
            write_note="only in HOLD_MODE; writing 0 there stops at once",
            source="DS-TMC428 8.6",
        ),
        Register(
            "a_max",
            11,
            "acceleration limit; 0 leaves the motor unable to change its speed",
            unit=ACCELERATION_UNIT,
            address=base | 0x6,
            axis=axis,
            source="DS-TMC428 8.7",
        ),
        Register(
            "a_actual",
            12,
            "acceleration now applied, smoothed for reading",
            signed=True,
            unit=ACCELERATION_UNIT,
            address=base | 0x7,
            axis=axis,
            access=Access.R,
            volatile=True,
            source="DS-TMC428 8.8",
        ),
        Register(
            "is_agtat_is_aleat_is_v0_a_threshold",
            23,
            "coil current by phase of the ramp",
            address=base | 0x8,
            axis=axis,
            group="current",
            source="DS-TMC428 8.9",
            fields=(
                Field(
                    "a_threshold",
                    11,
                    "acceleration above which is_agtat applies; compared signed, so keep it at most 1023",
                    unit=ACCELERATION_UNIT,
                    lsb=0,
                ),
                Field("is_v0", 3, "current at rest", unit="1/8", values=CURRENT_SCALES, lsb=12),
                Field("is_aleat", 3, "current at or below a_threshold", unit="1/8", values=CURRENT_SCALES, lsb=16),
                Field("is_agtat", 3, "current above a_threshold", unit="1/8", values=CURRENT_SCALES, lsb=20),
            ),
        ),
        Register(
            "pmul_pdiv",
            16,
            "p = (128 + pmul) / 2^(3 + pdiv): speed asked for per microstep of distance left",
            reset=0x8000,
            address=base | 0x9,
            axis=axis,
            source="DS-TMC428 8.10; TMC429 v2.06, p. 21 (bit 15)",
            fields=(
                Field("pdiv", 4, "exponent of the divisor", range=(0, 13), lsb=0),
                Field("pmul", 7, "mantissa less its fixed leading one (p_mul - 128)", lsb=8),
                Field("pmul_msb_one", 1, "the mantissa's leading one, fixed", reset=1, lsb=15, access=Access.R),
            ),
        ),
        Register(
            "lp_ref_conf_rm",
            17,
            "ramp mode and what the switches do",
            address=base | 0xA,
            axis=axis,
            source="DS-TMC428 8.12, Tables 8-3 to 8-5",
            fields=reference_fields(upper_case=False),
        ),
        Register(
            "interrupt_mask_interrupt_flags",
            16,
            "what happened, and what is watched for; a flag whose mask is off stays 0",
            address=base | 0xB,
            axis=axis,
            group="interrupts",
            volatile=True,
            source="DS-TMC428 8.13, Tables 8-6 and 8-7",
            fields=interrupt_fields(upper_case=True),
        ),
        Register(
            "pulse_div_ramp_div_usrs",
            16,
            "clock dividers and microstep resolution",
            address=base | 0xC,
            axis=axis,
            write_note="change pulse_div in RAMP_MODE only, elsewhere it may force a microstep",
            source="DS-TMC428 8.14, Table 8-8",
            fields=(
                Field("usrs", 3, "microsteps per full step, 2^usrs", range=(0, 6), values=MICROSTEPS, lsb=0),
                *divider_fields(upper_case=False),
            ),
        ),
        Register(
            "dx_ref_tolerance",
            12,
            "distance around position zero where switches do not stop the motor",
            unit="microsteps",
            address=base | 0xD,
            axis=axis,
            group="switches",
            source="DS-TMC428 8.15; TMC429 v2.06, p. 21 (width)",
        ),
        Register(
            "x_latched",
            24,
            "x_actual at the last change of the reference switch while armed",
            signed=True,
            unit="microsteps",
            address=base | 0xE,
            axis=axis,
            access=Access.RW_IF,
            group="switches",
            volatile=True,
            write_note="any write arms the latch and sets lp; the value itself cannot be written",
            source="DS-TMC428 8.16",
        ),
    )


def _global_registers() -> tuple[Register, ...]:
    rearms = "any write re-arms the capture of the next reply of the chain"
    return (
        Register(
            "datagram_low_word",
            24,
            "last 24 bits that came back from the driver chain",
            address=0x30,
            access=Access.RW_IF,
            group="driver chain",
            volatile=True,
            write_note=rearms,
            source="DS-TMC428 9.1",
        ),
        Register(
            "datagram_high_word",
            24,
            "the 24 bits that came back before those of datagram_low_word",
            address=0x31,
            access=Access.RW_IF,
            group="driver chain",
            volatile=True,
            write_note=rearms,
            source="DS-TMC428 9.1",
        ),
        Register(
            "cover_pos_cover_len",
            24,
            "which bits of the next datagram to the chain are covered",
            address=0x32,
            group="driver chain",
            volatile=True,
            write_note="cover_pos reads back as cover_pos + 1",
            source="DS-TMC428 9.2; TMC429 v2.06, p. 21 (bits)",
            fields=(
                Field("cover_len", 5, "how many bits are covered", unit="bits", range=(0, 24), lsb=0),
                Field("cover_pos", 6, "first covered bit, counted from 0", unit="bits", lsb=8),
                Field("cw", 1, "a cover datagram waits to be sent", lsb=23, access=Access.R),
            ),
        ),
        Register(
            "cover_datagram",
            24,
            "bits sent to the chain once, over those of the next datagram; writing sends",
            address=0x33,
            group="driver chain",
            source="DS-TMC428 9.3",
        ),
        Register(
            "power_down",
            24,
            "any write stops the chip's clocks until the next datagram begins",
            address=0x38,
            access=Access.W,
            reset=None,
            group="global",
            source="DS-TMC428 9.5",
        ),
        Register(
            "l3_r3_l2_r2_l1_r1",
            6,
            "switch states as the chip sees them",
            address=0x3E,
            access=Access.R,
            reset=None,
            group="switches",
            volatile=True,
            source="DS-TMC428 9.6; TMC429 v2.06, p. 21 (bits)",
            fields=tuple(
                Field(
                    f"{side}{motor}",
                    1,
                    f"{'left' if side == 'l' else 'right'} switch of motor {motor}",
                    values={0: "inactive", 1: "active"},
                    lsb=2 * (motor - 1) + (side == "l"),
                    access=Access.R,
                    reset=None,
                )
                for motor in (1, 2, 3)
                for side in ("r", "l")
            ),
        ),
        Register(
            "stepper_motor_global_parameter_register",
            22,
            "driver chain timing and polarities, and how the switch inputs are shared out",
            reset=0xF00,
            address=0x3F,
            group="global",
            source="DS-TMC428 9.7, Tables 9-1 to 9-3; TMC429 v2.06, p. 45 (bits)",
            fields=(
                Field(
                    "LSMD",
                    2,
                    "last stepper motor driver: drivers in the chain minus one",
                    range=(0, 2),
                    values={0: "1 driver", 1: "2 drivers", 2: "3 drivers"},
                    lsb=0,
                ),
                Field(
                    "polarity_nscs_s", 1, "chip select of the chain", values={0: "low active", 1: "high active"}, lsb=2
                ),
                Field("polarity_sck_s", 1, "clock of the chain", values={0: "as drawn", 1: "inverted"}, lsb=3),
                Field(
                    "polarity_PH_AB", 1, "phase bits; turns the motor round", values={0: "as is", 1: "inverted"}, lsb=4
                ),
                Field("polarity_FD", 1, "fast decay bits", values={0: "high active", 1: "low active"}, lsb=5),
                Field("polarity_DAC_AB", 1, "DAC bits", values={0: "high active", 1: "low active"}, lsb=6),
                Field(
                    "csCommonIndividual", 1, "chip selects", values={0: "one, common", 1: "three, individual"}, lsb=7
                ),
                Field(
                    "clk2_div",
                    8,
                    "clock divider of the chain, fCLK / (2 * (clk2_div + 1)); 7 suits TMC236 and its family",
                    range=(7, 255),
                    reset=15,
                    lsb=8,
                ),
                Field(
                    "continuous_update",
                    1,
                    "datagrams go out at rest too: needed for multiplexed switches and current at rest",
                    values=OFF_ON,
                    lsb=16,
                ),
                Field("refmux", 1, "a 74HC157 multiplexes six switches; mot1r is then ignored", values=OFF_ON, lsb=20),
                Field("mot1r", 1, "what REF3 is", values={0: "left of motor 3", 1: "right of motor 1"}, lsb=21),
            ),
        ),
    )


def _chain_words() -> tuple[Register, ...]:
    def half(parity: int, word: int, lsb: int) -> tuple[Field, Field]:
        cell = 2 * word + parity
        return (
            Field(
                f"signal_code_{parity}",
                5,
                f"signal sent at position {cell} of the chain's datagram",
                values=SIGNAL_CODES,
                lsb=lsb,
                reset=None,
            ),
            Field(
                f"NxM_{parity}",
                1,
                "next motor: the bits after this one belong to the next driver",
                values={0: "same driver", 1: "next driver"},
                lsb=lsb + 5,
                reset=None,
            ),
        )

    return tuple(
        Register(
            f"chain_conf_{word:02d}",
            14,
            f"driver chain configuration, positions {2 * word} and {2 * word + 1}; random after power-on",
            address=RAM_CHAIN | word,
            reset=None,
            group="driver chain RAM",
            source="DS-TMC428 Tables 10-1 and 11-1",
            fields=half(0, word, 0) + half(1, word, 8),
        )
        for word in range(32)
    )


def _table_words() -> tuple[Register, ...]:
    return tuple(
        Register(
            f"lut_{word:02d}",
            14,
            f"microstep table, entries {2 * word} and {2 * word + 1}; random after power-on",
            address=RAM_TABLE | word,
            reset=None,
            group="microstep table RAM",
            source="DS-TMC428 Tables 10-1 and 12-1",
            fields=(
                Field("y_even", 6, f"entry {2 * word}", unit="DAC counts", lsb=0, reset=None),
                Field("y_odd", 6, f"entry {2 * word + 1}", unit="DAC counts", lsb=8, reset=None),
            ),
        )
        for word in range(32)
    )


TMC428 = RegisterTable(
    "tmc428",
    (
        *(register for axis in range(AXES) for register in _axis_registers(axis)),
        *_global_registers(),
        *_chain_words(),
        *_table_words(),
    ),
)
