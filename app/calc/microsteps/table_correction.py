"""A TMC428's table that makes up for a motor's angle error: by the shape sigma and offset, and entry by entry.

64 entries of 6 bits are a quarter of the wave (DS-TMC428 12): entries i and 64 - i make the angle at both their places,
and no others have a part in it. So each pair is chosen by itself, and the best of all tables is found.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..driver_chain.ram_words import CELL_MAX, CELLS
from .angle_correction import GRID, MotorError, added_angle, predicted, rms
from .sequencer import USRS_MAX, WAVE_POSITIONS, step_through
from .table import design_table

FloatArray = NDArray[np.float64]

TABLE_GRID: FloatArray = np.arange(WAVE_POSITIONS, dtype=np.float64) * (2 * math.pi / WAVE_POSITIONS)
"""The commanded angles of a period [rad]: of this table a place is where an entry is read."""
SIGMAS = tuple(round(-0.5 + 0.02 * step, 2) for step in range(51))
"""The range of the data sheet."""
OFFSETS = (0.0, 1.0, 2.0, 3.0, 4.0)
NEAR = 3
"""How far from the wanted current an entry is looked for [counts]."""
LENGTH_WEIGHT = 0.15
"""What the vector's length is off, as a share of it, counts as so much of its angle [rad]: 1 % as 0.09 degrees."""


@dataclass(frozen=True, slots=True)
class TableCorrection:
    """Tables, and what each is expected to leave; errors are root mean square [deg electrical].

    sine_deg : with the sine of the data sheet
    sigma, offset, shaped, shaped_deg : the best formula, its values, and what it leaves
    values, values_deg : the same entry by entry
    beyond_deg : what stays with the best table of any resolution
    """

    sine_deg: float
    sigma: float
    offset: float
    shaped: tuple[int, ...]
    shaped_deg: float
    values: tuple[int, ...]
    values_deg: float
    beyond_deg: float


def table_for(motor: MotorError) -> TableCorrection:
    """The tables for a motor whose own error is known. Raises TooUneven."""
    added = added_angle(motor)
    free = _nearest(TABLE_GRID + np.interp(TABLE_GRID, GRID, added, period=2 * math.pi))
    left, _, sigma, offset = min(
        (round(_left(motor, design_table(sigma, offset).values), 4), abs(sigma), sigma, offset)
        for sigma in SIGMAS
        for offset in OFFSETS
    )
    return TableCorrection(
        sine_deg=_left(motor, design_table().values),
        sigma=sigma,
        offset=offset,
        shaped=design_table(sigma, offset).values,
        shaped_deg=left,
        values=free,
        values_deg=_left(motor, free),
        beyond_deg=math.degrees(rms(predicted(motor, GRID + added))),
    )


def field_of_table(values: Sequence[int]) -> FloatArray:
    """The angle of the current's vector on `TABLE_GRID` [rad]. Raises ValueError for a bad table."""
    steps = step_through(values, USRS_MAX)
    off = np.arctan2([step.current_a for step in steps], [step.current_b for step in steps]) - TABLE_GRID
    return np.asarray(TABLE_GRID + (off + math.pi) % (2 * math.pi) - math.pi)


def _left(motor: MotorError, values: Sequence[int]) -> float:
    """[deg electrical], root mean square."""
    return math.degrees(rms(predicted(motor, field_of_table(values), TABLE_GRID)))


def _nearest(wanted: FloatArray) -> tuple[int, ...]:
    """The table whose vectors come nearest to angles on `TABLE_GRID`, and to the length of `CELL_MAX`."""
    half = CELLS // 2
    values = [0] * CELLS
    values[half] = round(CELL_MAX / math.sqrt(2))
    for place in range(1, half):
        low, high = (_candidates(CELL_MAX * shape(wanted[place])) for shape in (np.sin, np.cos))
        sine, cosine = np.meshgrid(low, high, indexing="ij")
        turned = np.arctan2(sine, cosine) - wanted[place]
        longer = np.hypot(sine, cosine) / CELL_MAX - 1
        best = np.unravel_index(int((turned**2 + (LENGTH_WEIGHT * longer) ** 2).argmin()), sine.shape)
        values[place], values[CELLS - place] = int(sine[best]), int(cosine[best])
    return tuple(values)


def _candidates(current: float) -> NDArray[np.int64]:
    near = round(current) + np.arange(-NEAR, NEAR + 1)
    return np.unique(np.clip(near, 0, CELL_MAX))
