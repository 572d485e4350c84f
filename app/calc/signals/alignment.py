"""Measurements beside each other: one's samples at the other's times, and what lies between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
REACH = 2.5
"""Samples that lie farther apart than so many usual intervals have a gap between them."""


@dataclass(frozen=True, slots=True)
class Difference:
    """What one measurement is above another, in their unit. None where they have no time in common.

    samples : times at which both are known
    peak : the largest difference, with its sign, and `peak_at_s` its time [s]
    """

    samples: int
    peak: float | None
    peak_at_s: float | None
    mean: float | None
    rms: float | None


def usual_interval_s(time_s: FloatArray) -> float:
    """The median distance of two samples [s]; 0 where there are fewer than two."""
    return float(np.median(np.diff(time_s))) if len(time_s) > 1 else 0.0


def at_times(time_s: FloatArray, values: FloatArray, wanted_s: FloatArray, reach_s: float) -> FloatArray:
    """`values` [rows] at `time_s` [rows, s, rising] read off at `wanted_s` [any, s], in the shape of `wanted_s`.

    Between two samples along the straight line. NaN before the first and behind the last (nothing is extrapolated),
    where one of the two is missing, and where they lie farther apart than `reach_s` [s]. A time at which there is a
    sample gets that sample, whatever its neighbours are.
    """
    result = np.full(wanted_s.shape, np.nan)
    if not len(time_s):
        return result
    after = np.searchsorted(time_s, wanted_s, side="left")
    inside = after < len(time_s)
    after = np.minimum(after, len(time_s) - 1)
    exact = inside & (time_s[after] == wanted_s)
    between = inside & (after > 0) & ~exact
    before = np.maximum(after - 1, 0)
    span_s = time_s[after] - time_s[before]
    between &= (span_s <= reach_s) & (span_s > 0)
    share = np.divide(wanted_s - time_s[before], span_s, out=np.zeros_like(result), where=span_s > 0)
    line = values[before] + share * (values[after] - values[before])
    return np.where(exact, values[after], np.where(between, line, result))


def difference_of(time_s: FloatArray, difference: FloatArray) -> Difference:
    """Figures of `difference` [rows] at `time_s` [rows, s]; NaN does not count."""
    there = np.isfinite(difference)
    if not there.any():
        return Difference(0, None, None, None, None)
    known, at_s = difference[there], time_s[there]
    peak = int(np.abs(known).argmax())
    return Difference(
        len(known), float(known[peak]), float(at_s[peak]), float(known.mean()), float(np.sqrt(np.mean(known**2)))
    )
