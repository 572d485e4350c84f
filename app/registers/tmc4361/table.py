"""Registers of the TMC4361: one axis, 40-bit datagrams, 7-bit addresses, 32 data bits.

At many addresses a reading and a writing reach different registers, and some words mean something
else with another driver, encoder or regulation: `RegisterTable.at` and `when` tell them apart. Where
the rows' sources come from stands in `rows`; by subject they are in the files beside this one.
"""

from __future__ import annotations

from ..model import RegisterTable
from .events import EVENT_ROWS
from .feedback import FEEDBACK_ROWS
from .general import CLOCK_HZ_DEFAULT, CLOCK_HZ_MAX, CLOCK_HZ_MIN, GENERAL_ROWS
from .motion import RAMP_ROWS, REFERENCE_ROWS
from .output import OUTPUT_ROWS
from .rows import AXIS
from .start import START_ROWS

AXES = 1

TMC4361 = RegisterTable(
    "tmc4361",
    tuple(
        row.completed(AXIS)
        for row in sorted(
            (*GENERAL_ROWS, *REFERENCE_ROWS, *START_ROWS, *OUTPUT_ROWS, *FEEDBACK_ROWS, *EVENT_ROWS, *RAMP_ROWS),
            key=lambda row: row.address,
        )
    ),
)

__all__ = ["AXES", "CLOCK_HZ_DEFAULT", "CLOCK_HZ_MAX", "CLOCK_HZ_MIN", "TMC4361"]
