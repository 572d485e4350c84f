"""What one TMCL module is: whoever speaks to one, or plays one, asks this instead of its name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from ..model import Register, RegisterTable, Space

Counting = Literal["unit mode", "dividers"]
"""What speeds and accelerations count in: pps or units of a SixPoint ramp generator, by parameter 255; or units of a
TMC429 by its two dividers, parameters 153 and 154."""


@dataclass(frozen=True, slots=True)
class TmclModule:
    """A module of the family: its parameters, and what of its firmware others do otherwise."""

    number: int
    """What it calls itself in the answer to command 136."""
    firmware: str
    """The version that the table follows, as that answer has it: "1.44"."""
    table: RegisterTable
    clock_hz: float
    """Of the motion controller that is inside [Hz]."""
    counting: Counting = "unit mode"
    axes: int = 1
    position_bits: int = 32
    """Width of the position counter."""
    stores_axis: bool = False
    """Whether STAP and RSAP keep axis parameters in its EEPROM; what is kept is in force after power-on."""

    @property
    def version(self) -> tuple[int, int]:
        """Major and minor number of the firmware."""
        major, minor = self.firmware.split(".")
        return int(major), int(minor)

    def rows(self, space: Space) -> Mapping[int, Register]:
        """Its parameters of one space, by number."""
        return MappingProxyType({row.address: row for row in self.table if row.space is space})
