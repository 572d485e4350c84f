"""Fewer points of a long measurement, and no peak hidden: of each stretch its lowest and its highest sample."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def extremes(time_s: FloatArray, values: FloatArray, points: int) -> tuple[FloatArray, FloatArray]:
    """At most about `points` of the samples `values` [rows] at `time_s` [rows], in their order: (times, values).

    The samples are cut into stretches of equal count. Of each the lowest and the highest stay, at their own times, and
    a NaN where one is missing, so that a gap stays a gap. Few enough samples are returned as they are. Raises
    ValueError for fewer than 8 points, or arrays of different lengths.
    """
    if points < 8:
        raise ValueError(f"at least 8 points, not {points}")
    if time_s.shape != values.shape or time_s.ndim != 1:
        raise ValueError(f"as many times as values, not {time_s.shape} and {values.shape}")
    rows = len(time_s)
    if rows <= points:
        return time_s, values
    starts = np.linspace(0, rows, points // 3 + 1).astype(np.intp)[:-1]  # three of each stretch at the most
    missing = np.isnan(values)
    lowest = np.where(missing, np.inf, values)
    highest = np.where(missing, -np.inf, values)
    chosen = np.zeros(rows, dtype=bool)
    chosen[_places(lowest, np.minimum.reduceat(lowest, starts), starts)] = True
    chosen[_places(highest, np.maximum.reduceat(highest, starts), starts)] = True
    if missing.any():
        chosen &= ~missing
        chosen[_places(missing, np.maximum.reduceat(missing, starts), starts, only=True)] = True
    return time_s[chosen], values[chosen]


def _places(
    values: NDArray[np.generic], wanted: NDArray[np.generic], starts: NDArray[np.intp], *, only: bool | None = None
) -> NDArray[np.intp]:
    """Of each stretch the first row where `values` is `wanted`; with `only`, of those stretches that want it."""
    lengths = np.diff(starts, append=len(values))
    rows = np.flatnonzero(values == np.repeat(wanted, lengths))
    stretch = np.searchsorted(starts, rows, side="right") - 1
    first = np.concatenate(([True], np.diff(stretch) > 0)) if len(rows) else np.empty(0, dtype=bool)
    rows, stretch = rows[first], stretch[first]
    return rows if only is None else rows[wanted[stretch] == only]
