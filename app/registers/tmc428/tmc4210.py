"""Registers of the TMC4210: one axis, step/direction output.

"DS-TMC4210" in a source stands for the TMC4210 data sheet v1.03. What that document leaves open about
bits is taken from the data sheet of the TMC429, which shares the core, and says so.
"""

from __future__ import annotations

import re
from dataclasses import replace

from ..build import RW, R, Rows, W, choice, flag
from ..model import Access, Field, Register, RegisterTable
from .roles import INVERTED, divider_fields, interrupt_fields, position_compare, reference_fields
from .tmc428 import TMC428

_motion = Rows("motion", "DS-TMC4210")
_step_dir = Rows("step/dir", "DS-TMC4210")
_global = Rows("global", "DS-TMC4210")
_switches = Rows("switches", "DS-TMC4210")

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
    _motion(
        0x01,
        "X_ACTUAL",
        24,
        Access.RW_IF,
        "where the motor is; overwrite it in velocity_mode or hold_mode, else the motor drives off",
    ).having(
        signed=True,
        unit="microsteps",
        volatile=True,
        write_note="works in every mode, but in ramp_mode and soft_mode the motor then drives to X_TARGET",
        source="DS-TMC4210 6.1.2, 2.4",
    ),
    _motion(
        0x09, "PMUL_PDIV", 16, RW, "p = PMUL / 2^(3 + PDIV): speed asked for per microstep of distance left"
    ).having(
        Field("PDIV", 4, "exponent of the divisor", range=(0, 13), lsb=0),
        Field("PMUL", 8, "mantissa with its fixed leading one", range=(128, 255), reset=128, lsb=8),
        reset=0x8000,
        source="DS-TMC4210 6.1.9",
    ),
    _motion(0x0A, "lp_REF_CONF_RAMP_MODE", 17, RW, "ramp mode and what the switches do").having(
        *reference_fields(upper_case=True),
        source="DS-TMC4210 5.3, 6.1 (register table); TMC429 v2.06, p. 34 (bits)",
    ),
    _motion(0x0C, "PULSE_DIV_RAMP_DIV", 16, RW, "clock dividers", source="DS-TMC4210 5.3, 6.1 (register table)").having(
        *divider_fields(upper_case=True), write_note="change PULSE_DIV in ramp_mode only"
    ),
    _motion(0x0F, "USTEP_COUNT_4210", 8, RW, "pointer of the internal microstep sequencer").having(
        unit="sequencer steps", volatile=True, source="DS-TMC4210 6.1 (register table)"
    ),
)

_GLOBAL_REGISTERS = (
    _step_dir(
        0x34, "IF_CONFIGURATION_4210", 9, RW, "step/direction output and switch inputs; set en_sd before use"
    ).having(
        choice(0, "inv_ref", 1, "switch inputs", {0: "high active", 1: "low active"}),
        Field(
            "sdo_int",
            1,
            "makes the output pin an interrupt only and so blocks reading: keep 0",
            range=(0, 0),
            lsb=1,
        ),
        choice(2, "step_half", 1, "step output", {0: "a pulse a step", 1: "an edge a step"}),
        choice(3, "inv_stp", 1, "step output level", INVERTED),
        choice(4, "inv_dir", 1, "direction output level", INVERTED),
        flag(5, "en_sd", "step/direction interface"),
        choice(
            6,
            "pos_comp_sel",
            2,
            "motor whose position is compared",
            {0: "motor 1", 1: "motor 2 (absent)", 2: "motor 3 (absent)", 3: "off"},
        ),
        flag(8, "en_refr", "right switch inputs of a TMC429; without effect here"),
        source="DS-TMC4210 1.4, 5.3; TMC429 v2.06, p. 42 (bits)",
    ),
    *position_compare(
        "POS_COMP_4210",
        "DS-TMC4210 5.3; TMC429 v2.06, p. 43 (access, sign)",
        "POS_COMP_INT_4210",
        "DS-TMC4210 5.3; TMC429 v2.06, p. 21",
    ),
    _global(0x38, "POWER_DOWN", 24, W, "any write stops the chip's clocks until the next datagram begins").having(
        reset=None, source="DS-TMC4210 5.3"
    ),
    _global(0x39, "TYPE_VERSION_4210", 24, R, "what chip this is", source="DS-TMC4210 5.3").having(
        reset=TYPE_VERSION, values={TYPE_VERSION: "TMC4210 / TMC429"}
    ),
    _switches(0x3E, "REFERENCE_SWITCHES", 4, R, "input states").having(
        choice(0, "r_r", 1, "right switch; only with mot1r", {0: "inactive", 1: "active"}, access=R, reset=None),
        choice(1, "r_l", 1, "left switch", {0: "inactive", 1: "active"}, access=R, reset=None),
        choice(3, "gp_in", 1, "general purpose input", {0: "low", 1: "high"}, access=R, reset=None),
        reset=None,
        volatile=True,
        source="DS-TMC4210 5.2.2.2, 5.3",
    ),
    _global(
        0x3F, "STEPPER_MOTOR_GLOBAL_PARAMETER_REGISTER", 22, RW, "step pulse length and the right switch input"
    ).having(
        Field("STPDIV_4210", 4, "step pulse length, 16 * (1 + STPDIV) clocks", unit="16 tCLK", reset=15, lsb=8),
        flag(21, "mot1r", "REF_R is the right switch"),
        reset=0xF00,
        source="DS-TMC4210 5.3; TMC429 v2.06, p. 21, 53 (bits)",
    ),
)

_ROWS = (*(replace(row, axis=0) for row in _AXIS_REGISTERS), *_GLOBAL_REGISTERS)
TMC4210 = RegisterTable("tmc4210", tuple(sorted(_ROWS, key=lambda row: row.address)))
