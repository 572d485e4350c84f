"""The microstep sequencer: where in the wave a motor stands, and what its two coils then get.

The wave index runs 0..255 over four full steps (DS-TMC428 12.1, Tables 12-3 and 12-4).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

FULL_STEP_INCREMENT = 64
FULL_STEP_DAC = 63
"""Full stepping drives both coils with constant amplitude and needs no table (DS-TMC428 8.14 and 12)."""

_PHASES = ((1, 1, 0, 1), (1, 0, 1, 0), (0, 0, 0, 1), (0, 1, 1, 0))
"""PH_A, PH_B, FD_A, FD_B by quadrant (DS-TMC428 Table 12-3)."""


class Coils(NamedTuple):
    """Both coils as the sequencer wants them, before any polarity bit: DAC 0..63, phase and fast decay bits."""

    dac_a: int
    dac_b: int
    ph_a: int
    ph_b: int
    fd_a: int
    fd_b: int


def increment(usrs: int) -> int:
    """Width of a microstep in wave indices (DS-TMC428 Table 12-4). %111 is not specified: like %110 here."""
    return FULL_STEP_INCREMENT >> min(usrs, 6)


def table_index(wave: int) -> int:
    """Table entry behind wave index `wave` for the sine; the second and fourth quadrants run backwards.

    The turning points would be entry 64, which the table does not have: 63 stands in for it.
    """
    offset = wave & 63
    return min(64 - offset, 63) if wave & 64 else offset


def coils(wave: int, width: int, scale: int, table: Sequence[int]) -> Coils:
    """What the coils get at `wave` (0..255).

    `width` is the microstep's increment, `scale` the 3-bit current code (0 is 8/8, else eighths; DS-TMC428,
    Table 8-1), `table` the 64 entries of 6 bits. Scaling drops the fraction.
    """
    eighths = scale or 8
    if width == FULL_STEP_INCREMENT:
        sine = cosine = FULL_STEP_DAC
    else:
        sine, cosine = table[table_index(wave)], table[table_index(wave + 64 & 255)]
    return Coils(sine * eighths >> 3, cosine * eighths >> 3, *_PHASES[wave >> 6 & 3])
