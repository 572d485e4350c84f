"""How the TMC428 walks through its microstep table: indices, signs, phase and fast-decay bits.

Source: DS-TMC428 12.1, Tables 12-3 and 12-4. A counter of the full wave, 0..255, moves by 2^(6 - usrs)
with each microstep. Its quarter mirrors and signs the table: sine for phase A, cosine for phase B.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..driver_chain.ram_words import CELL_MAX, whole_number
from .datagrams import checked_values

WAVE_POSITIONS = 256
"""Positions of the full-wave counter in one electrical period (four full steps)."""
QUARTER = 64
USRS_MAX = 6


@dataclass(frozen=True, slots=True)
class SequencerStep:
    """What the drivers see after one microstep, before any of the chip's polarity bits.

    `wave_index` is the full-wave counter 0..255, `quadrant` 1..4, `index_a` and `index_b` the table
    entries that are read, `current_a` and `current_b` the signed currents [DAC counts, -63..63],
    `ph_*` 1 for a positive current, `fd_*` 1 while the current of the phase falls.
    """

    step: int
    wave_index: int
    quadrant: int
    index_a: int
    index_b: int
    current_a: int
    current_b: int
    ph_a: int
    ph_b: int
    fd_a: int
    fd_b: int


def table_index(wave_index: int) -> int:
    """The table entry 0..63 that the sine reads at a full-wave position (any int, taken modulo 256).

    The peak would be entry 64, which the table does not have: the chip reads 63 there (Table 12-4).
    """
    within = wave_index % (2 * QUARTER)
    return min(within if within <= QUARTER else 2 * QUARTER - within, CELL_MAX)


def increment(usrs: int) -> int:
    """Full-wave positions per microstep, 64 for a full step down to 1. Raises ValueError outside 0..6."""
    return QUARTER >> whole_number("usrs", usrs, 0, USRS_MAX)


def step_through(values: Sequence[int], usrs: int, start: int = 0) -> tuple[SequencerStep, ...]:
    """One electrical period in positive direction: 4 * 2^usrs steps, the first at `start`.

    `start` (0..255) is where the full-wave counter stands: 0 after power-on, anything after the
    resolution was changed under way. In the other direction the same steps come in reverse.

    With usrs = 0 the currents are those of Table 12-4 (one phase on at a time). A full-step driver
    that takes only the phase bits keeps both phases on instead, which is what 8.14 speaks of.

    Raises ValueError for a bad table, usrs outside 0..6, or start outside 0..255.
    """
    table = checked_values(values)
    width = increment(usrs)
    first = whole_number("start", start, 0, WAVE_POSITIONS - 1)
    return tuple(_step(step, (first + step * width) % WAVE_POSITIONS, table) for step in range(WAVE_POSITIONS // width))


def _step(step: int, wave_index: int, table: tuple[int, ...]) -> SequencerStep:
    quadrant = wave_index // QUARTER
    ph_a = int(quadrant in (0, 1))
    ph_b = int(quadrant in (0, 3))
    index_a = table_index(wave_index)
    index_b = table_index(wave_index + QUARTER)
    return SequencerStep(
        step=step,
        wave_index=wave_index,
        quadrant=quadrant + 1,
        index_a=index_a,
        index_b=index_b,
        current_a=table[index_a] if ph_a else -table[index_a],
        current_b=table[index_b] if ph_b else -table[index_b],
        ph_a=ph_a,
        ph_b=ph_b,
        fd_a=quadrant % 2,
        fd_b=1 - quadrant % 2,
    )
