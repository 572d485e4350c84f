"""Registers and RAM words of the TMC429: those of the TMC428, whose place it takes, and a step/direction interface.

"DS-TMC429" in a source stands for the TMC429 data sheet Rev. 2.06. Names are spelled as the TMC428's are, which that
sheet's first edition does too: what is written for one chip is understood by the other.
"""

from __future__ import annotations

from dataclasses import replace

from ..build import RW, R, Rows, choice, flag
from ..model import Field, Register, RegisterTable
from . import tmc428
from .roles import INVERTED, position_compare
from .tmc4210 import TYPE_VERSION

_motion = Rows("motion", "DS-TMC429")
_step_dir = Rows("step/dir", "DS-TMC429")
_global = Rows("global", "DS-TMC429")

AXES = tmc428.AXES
_AXIS_SECTIONS = {
    **{index: f"8.1.{index + 1}" for index in range(16)},
    0xA: "8.1.11, p. 33 (bits)",
    0xB: "8.1.12, p. 36 (bits)",
    0xC: "8.1.13, 7.3 (bits; p. 22 gives usrs two, 8.1.13.3 three)",
}
"""By the low four bits of the address."""
_GLOBAL_SECTIONS = {
    0x30: "8.2.1",
    0x31: "8.2.1",
    0x32: "8.2.2, 7.3 (bits)",
    0x33: "8.2.3",
    0x38: "8.2.4.3",
    0x3E: "8.2.4.5, 7.3 (bits)",
    0x3F: "8.2.5, 7.3 (bits)",
}


def _taken_over(row: Register) -> Register:
    """A row of the TMC428, as the TMC429's sheet tells it."""
    if row.address >= tmc428.RAM_CHAIN:
        table = row.address >= tmc428.RAM_TABLE
        help_ = row.help.replace("random after power-on", "a chain of TMC23x and a sine after power-on")
        return replace(row, help=help_, source=f"DS-TMC429 {'11.5' if table else '11.4'}, 1.5.5 (power-on)")
    section = _AXIS_SECTIONS[row.address & 0xF] if row.axis is not None else _GLOBAL_SECTIONS[row.address]
    row = replace(row, source=f"DS-TMC429 {section}")
    if row.address != 0x3F:
        return row
    stpdiv = Field(
        "STPDIV_429",
        4,
        "step pulse length, 16 * (1 + STPDIV_429) clocks; the low bits of clk2_div",
        unit="16 tCLK",
        lsb=8,
        when="en_sd = 1",
    )
    return replace(row, fields=(*row.fields, replace(stpdiv, reset=15)))


def _pointer(axis: int) -> Register:
    return _motion(
        axis << 4 | 0xF,
        "ustep_count_429",
        8,
        RW,
        "pointer of the internal microstep sequencer, 256 places to four full steps",
    ).having(
        unit="sequencer steps",
        axis=axis,
        volatile=True,
        source="DS-TMC429 8.1.16 (calls it read only; 8.1 and p. 22 read and write)",
    )


_INTERFACE = (
    _step_dir(
        0x34,
        "if_configuration_429",
        9,
        RW,
        "step/direction output and switch inputs; after power-on the motors are driven by SPI",
    ).having(
        choice(0, "inv_ref", 1, "all switch inputs", {0: "high active", 1: "low active"}),
        flag(
            1,
            "sdo_int",
            "makes the pin nINT_SDO_C an interrupt only; another pin, SDOZ_C, is read by then",
            behaviour="the emulated chip is read by SDOZ_C",
        ),
        choice(2, "step_half", 1, "step outputs", {0: "a pulse a step", 1: "an edge a step"}),
        choice(3, "inv_stp", 1, "levels of the step outputs", INVERTED),
        choice(4, "inv_dir", 1, "levels of the direction outputs; turns the motors round", INVERTED),
        choice(5, "en_sd", 1, "how motors are driven", {0: "SPI driver chain", 1: "step/direction"}),
        choice(
            6,
            "pos_comp_sel",
            2,
            "motor whose position is compared",
            {0: "motor 1", 1: "motor 2", 2: "motor 3", 3: "off"},
        ),
        flag(8, "en_refr", "inputs REFR1 to REFR3 as right switches"),
        source="DS-TMC429 8.2.4",
    ),
    *position_compare("pos_comp_429", "DS-TMC429 8.2.4.1", "pos_comp_int_429", "DS-TMC429 8.2.4.2, 7.3 (bits)"),
    _global(0x39, "type_version_429", 24, R, "what chip this is; a TMC4210 says the same").having(
        reset=TYPE_VERSION, values={TYPE_VERSION: "TMC429 version 1.01"}, source="DS-TMC429 8.2.4.4"
    ),
)

_ROWS = (*map(_taken_over, tmc428.TMC428), *map(_pointer, range(AXES)), *_INTERFACE)
TMC429 = RegisterTable("tmc429", tuple(sorted(_ROWS, key=lambda row: row.address)))
