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


@dataclass(frozen=True, slots=True)
class Match:
    """How far a measurement has to be shifted to lie on another one.

    offset_s : to be added to its times [s]
    correlation : -1 .. 1 of what then lies upon each other; negative: one is the other upside down
    """

    offset_s: float
    correlation: float


GRID_MAX = 1 << 16
OVERLAP = 0.5


def match_of(first_s: FloatArray, first: FloatArray, second_s: FloatArray, second: FloatArray) -> Match | None:
    """Where `second` [rows] at `second_s` [rows, s, rising] looks most like `first` [rows] at `first_s`; None where
    one of them does not change.

    Both are read off at even times; what is missing counts nowhere (Padfield 2012, Masked object registration in the
    Fourier domain). At least `OVERLAP` of the shorter one lies on the other.
    """
    if len(first_s) < 3 or len(second_s) < 3:
        return None
    span_s = max(float(first_s[-1] - first_s[0]), float(second_s[-1] - second_s[0]))
    step_s = max(min(usual_interval_s(first_s), usual_interval_s(second_s)), span_s / GRID_MAX)
    if step_s <= 0:
        return None
    grids = []
    for time_s, values in ((first_s, first), (second_s, second)):
        wanted_s = time_s[0] + step_s * np.arange(int((time_s[-1] - time_s[0]) / step_s + 1.001))
        read = at_times(time_s, values, np.minimum(wanted_s, time_s[-1]), REACH * max(usual_interval_s(time_s), step_s))
        known = np.isfinite(read)
        if not known.any() or np.ptp(read[known]) == 0:
            return None
        scaled = (read - read[known].mean()) / read[known].std()
        grids.append((np.where(known, scaled, 0.0), known.astype(float)))
    (one, one_known), (two, two_known) = grids
    size = 1 << (len(one) + len(two) - 1).bit_length()
    a, a2, am = (np.fft.rfft(each, size) for each in (one, one * one, one_known))
    b, b2, bm = (np.conj(np.fft.rfft(each, size)) for each in (two, two * two, two_known))
    shared_rows = np.round(np.fft.irfft(am * bm, size))
    wide = shared_rows >= max(3.0, OVERLAP * min(one_known.sum(), two_known.sum()))
    count = np.maximum(shared_rows, 1.0)
    sum_a, sum_b = np.fft.irfft(a * bm, size), np.fft.irfft(am * b, size)
    spread_a = np.fft.irfft(a2 * bm, size) - sum_a**2 / count
    spread_b = np.fft.irfft(am * b2, size) - sum_b**2 / count
    found = wide & (spread_a > 1e-6 * count) & (spread_b > 1e-6 * count)
    if not found.any():
        return None
    shared = np.fft.irfft(a * b, size) - sum_a * sum_b / count
    r = np.where(found, shared / np.sqrt(np.where(found, spread_a * spread_b, 1.0)), 0.0)
    best = int(np.abs(r).argmax())
    left, top, right = (abs(float(r[(best + by) % size])) for by in (-1, 0, 1))
    bend = left - 2 * top + right
    within = 0.5 * (left - right) / bend if bend < 0 else 0.0
    lag = best - size if best >= len(one) else best
    offset_s = float(first_s[0] - second_s[0]) + (lag + within) * step_s
    return Match(offset_s, float(np.clip(r[best], -1.0, 1.0)))
