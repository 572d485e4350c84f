"""Registers of the TMC4210: one axis, step/direction output.

"DS-TMC4210" in a source stands for the TMC4210 data sheet v1.03. What that document leaves open about
bits is taken from the data sheet of the TMC429, which shares the core, and says so.
"""

from __future__ import annotations

import re
from dataclasses import replace

from ..model import Access, Field, Register, RegisterTable
from .roles import INVERTED, OFF_ON, divider_fields, interrupt_fields, position_compare, reference_fields
from .tmc428 import TMC428

AXES = 1
TYPE_VERSION = 0x429101

_SECTIONS = {
    0x0: "6.1.1, 2.4",
    0x2: "6.1.3",
    0x3: "6.1.4",
    0x4: "6.1.5",
    0x5: "6.1.6",
    0x6: "6.1.7",
    0x7: "2.4, 6.1.8 (the table of 6.1 calls it 11 bits unsigned)",
    0xB: "6.1 (register table); TMC429 v2.06, p. 36 (bits)",
    0xD: "5.3, 6.1 (register table)",
    0xE: "5.3, 6.1 (register table)",
}
"""Rows of an axis that are the TMC428's but for their spelling, by address."""


def _spelled(text: str) -> str:
    """As this data sheet spells it: modes in lower case, registers in upper case."""
    text = re.sub(r"(RAMP|SOFT|VELOCITY|HOLD)_MODE", lambda mode: mode[0].lower(), text)
    return text.replace("x_actual", "X_ACTUAL")


def _taken_over(row: Register) -> Register:
    return replace(
        row,
        name=row.name.upper(),
        help=_spelled(row.help),
        write_note=_spelled(row.write_note),
        source=f"DS-TMC4210 {_SECTIONS[row.address]}",
        fields=interrupt_fields(upper_case=False) if row.fields else (),
    )


_AXIS_REGISTERS = (
    *(_taken_over(row) for row in TMC428 if row.axis == 0 and row.address in _SECTIONS),
    Register(
        "X_ACTUAL",
        24,
        "where the motor is; overwrite it in velocity_mode or hold_mode, else the motor drives off",
        signed=True,
        unit="microsteps",
        address=0x01,
        axis=0,
        access=Access.RW_IF,
        volatile=True,
        write_note="works in every mode, but in ramp_mode and soft_mode the motor then drives to X_TARGET",
        source="DS-TMC4210 6.1.2, 2.4",
    ),
    Register(
        "PMUL_PDIV",
        16,
        "p = PMUL / 2^(3 + PDIV): speed asked for per microstep of distance left",
        reset=0x8000,
        address=0x09,
        axis=0,
        source="DS-TMC4210 6.1.9",
        fields=(
            Field("PDIV", 4, "exponent of the divisor", range=(0, 13), lsb=0),
            Field("PMUL", 8, "mantissa with its fixed leading one", range=(128, 255), reset=128, lsb=8),
        ),
    ),
    Register(
        "lp_REF_CONF_RAMP_MODE",
        17,
        "ramp mode and what the switches do",
        address=0x0A,
        axis=0,
        source="DS-TMC4210 5.3, 6.1 (register table); TMC429 v2.06, p. 34 (bits)",
        fields=reference_fields(upper_case=True),
    ),
    Register(
        "PULSE_DIV_RAMP_DIV",
        16,
        "clock dividers",
        address=0x0C,
        axis=0,
        write_note="change PULSE_DIV in ramp_mode only",
        source="DS-TMC4210 5.3, 6.1 (register table)",
        fields=divider_fields(upper_case=True),
    ),
    Register(
        "USTEP_COUNT_4210",
        8,
        "pointer of the internal microstep sequencer",
        unit="sequencer steps",
        address=0x0F,
        axis=0,
        volatile=True,
        source="DS-TMC4210 6.1 (register table)",
    ),
)

_GLOBAL_REGISTERS = (
    Register(
        "IF_CONFIGURATION_4210",
        9,
        "step/direction output and switch inputs; set en_sd before use",
        address=0x34,
        group="step/dir",
        source="DS-TMC4210 1.4, 5.3; TMC429 v2.06, p. 42 (bits)",
        fields=(
            Field("inv_ref", 1, "switch inputs", values={0: "high active", 1: "low active"}, lsb=0),
            Field(
                "sdo_int",
                1,
                "makes the output pin an interrupt only and so blocks reading: keep 0",
                range=(0, 0),
                lsb=1,
            ),
            Field("step_half", 1, "step output", values={0: "a pulse a step", 1: "an edge a step"}, lsb=2),
            Field("inv_stp", 1, "step output level", values=INVERTED, lsb=3),
            Field("inv_dir", 1, "direction output level", values=INVERTED, lsb=4),
            Field("en_sd", 1, "step/direction interface", values=OFF_ON, lsb=5),
            Field(
                "pos_comp_sel",
                2,
                "motor whose position is compared",
                values={0: "motor 1", 1: "motor 2 (absent)", 2: "motor 3 (absent)", 3: "off"},
                lsb=6,
            ),
            Field("en_refr", 1, "right switch inputs of a TMC429; without effect here", values=OFF_ON, lsb=8),
        ),
    ),
    *position_compare(
        "POS_COMP_4210",
        "DS-TMC4210 5.3; TMC429 v2.06, p. 43 (access, sign)",
        "POS_COMP_INT_4210",
        "DS-TMC4210 5.3; TMC429 v2.06, p. 21",
    ),
    Register(
        "POWER_DOWN",
        24,
        "any write stops the chip's clocks until the next datagram begins",
        address=0x38,
        access=Access.W,
        reset=None,
        group="global",
        source="DS-TMC4210 5.3",
    ),
    Register(
        "TYPE_VERSION_4210",
        24,
        "what chip this is",
        address=0x39,
        access=Access.R,
        reset=TYPE_VERSION,
        values={TYPE_VERSION: "TMC4210 / TMC429"},
        group="global",
        source="DS-TMC4210 5.3",
    ),
    Register(
        "REFERENCE_SWITCHES",
        4,
        "input states",
        address=0x3E,
        access=Access.R,
        reset=None,
        group="switches",
        volatile=True,
        source="DS-TMC4210 5.2.2.2, 5.3",
        fields=(
            Field(
                "r_r",
                1,
                "right switch; only with mot1r",
                values={0: "inactive", 1: "active"},
                lsb=0,
                access=Access.R,
                reset=None,
            ),
            Field("r_l", 1, "left switch", values={0: "inactive", 1: "active"}, lsb=1, access=Access.R, reset=None),
            Field(
                "gp_in", 1, "general purpose input", values={0: "low", 1: "high"}, lsb=3, access=Access.R, reset=None
            ),
        ),
    ),
    Register(
        "STEPPER_MOTOR_GLOBAL_PARAMETER_REGISTER",
        22,
        "step pulse length and the right switch input",
        reset=0xF00,
        address=0x3F,
        group="global",
        source="DS-TMC4210 5.3; TMC429 v2.06, p. 21, 53 (bits)",
        fields=(
            Field("STPDIV_4210", 4, "step pulse length, 16 * (1 + STPDIV) clocks", unit="16 tCLK", reset=15, lsb=8),
            Field("mot1r", 1, "REF_R is the right switch", values=OFF_ON, lsb=21),
        ),
    ),
)

TMC4210 = RegisterTable("tmc4210", tuple(sorted(_AXIS_REGISTERS + _GLOBAL_REGISTERS, key=lambda row: row.address)))
