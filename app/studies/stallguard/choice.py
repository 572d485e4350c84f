"""Which threshold tells a stall from a free run: by the least load value of each run, free ones and those into a stop.

A stall is told by the first value at or below a level, so of a run its least value alone counts. Free runs are to
stay above the level, runs into the stop to come to it. The rate of false stalls rises with the level and that of
missed ones falls: a level that gets one of them wrong rules out all beyond it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...telemetry.sampling import FloatArray
from ..proof import rate_shown
from .scale import Scale

WELL_BELOW = 0.1
"""Share of the asked rate that is to be expected at the most where the middle of all such levels is taken."""
FILTERED = 4
"""Values that the filter puts together: of four full steps."""
LEAST_SPREAD = 1.0
"""Of least values [counts]: they are whole numbers."""


@dataclass(frozen=True, slots=True)
class Run:
    """One run: a load value a full step, as it would be at threshold 0, and the speeds it was measured at [pps]."""

    values: FloatArray
    speeds_pps: FloatArray

    def least(self, above_pps: float, filtered: bool) -> float | None:
        """The least level at which it is a stall, of values at `above_pps` or more; None without any.

        A value is cut at 0 before the filter takes the mean of four: that is 0 where all of them are.
        """
        values = self.values[self.speeds_pps >= above_pps]
        if filtered:
            whole = len(values) // FILTERED * FILTERED
            values = values[:whole].reshape(-1, FILTERED).max(axis=1)
        return float(values.min()) if len(values) else None


@dataclass(frozen=True, slots=True)
class Measured:
    """What was measured at one speed."""

    speed_rps: float
    speed_pps: float
    free: Sequence[Run]
    stops: Sequence[Run]

    def least(self, above_pps: float, filtered: bool) -> tuple[FloatArray, FloatArray]:
        """The least values of free runs and of runs into the stop."""
        free = [least for run in self.free if (least := run.least(above_pps, filtered)) is not None]
        stops = [least for run in self.stops if (least := run.least(0.0, filtered)) is not None]
        return np.asarray(free), np.asarray(stops)


@dataclass(frozen=True, slots=True)
class Choice:
    """Thresholds of which one may do it, at each of the speeds from the first to the last.

    thresholds : those that are left of it, by rising level
    threshold : the one to be tried
    rate : what it is expected to get wrong of its runs, false stalls or missed ones
    """

    first: int
    last: int
    filtered: bool
    thresholds: tuple[int, ...]
    threshold: int
    rate: float

    def without(self, *, false: bool) -> Choice | None:
        """After the threshold got too much wrong: the middle of what is left, so that half of it goes with each; None
        where nothing is. `false`: it was false stalls, else missed ones."""
        at = self.thresholds.index(self.threshold)
        left = self.thresholds[:at] if false else self.thresholds[at + 1 :]
        return replace(self, thresholds=left, threshold=left[len(left) // 2]) if left else None


@dataclass(frozen=True, slots=True)
class Alone:
    """The threshold that suits one speed best, and what it gets wrong of the runs by which it was chosen."""

    threshold: int
    filtered: bool
    false: int
    free_runs: int
    missed: int
    stops: int
    may_do: bool


def roc(free: FloatArray, stops: FloatArray) -> list[tuple[float, float, float]]:
    """(level, share of free runs with a false stall, share of stalls missed) for each level that makes a difference."""
    levels = np.unique(np.concatenate((free, stops)))
    return [(float(level), float((free <= level).mean()), float((stops > level).mean())) for level in levels]


def may_do(free: FloatArray, stops: FloatArray, level: float, rate_max: float) -> bool:
    """Whether these runs leave it open that a level gets fewer than `rate_max` wrong of either."""
    false, missed = int((free <= level).sum()), int((stops > level).sum())
    return rate_shown(false, len(free)) <= rate_max and rate_shown(missed, len(stops)) <= rate_max


def expected(free: FloatArray, stops: FloatArray, levels: FloatArray) -> FloatArray:
    """What each level gets wrong of further runs, false stalls or missed ones, whichever is more.

    By Student's t of one more run as if least values were normal: few runs tell less of its tail than many.
    """
    from scipy import stats

    def t_of(values: FloatArray) -> FloatArray:
        spread = max(float(values.std(ddof=1)), LEAST_SPREAD) * math.sqrt(1 + 1 / len(values))
        return np.asarray((levels - float(values.mean())) / spread, dtype=float)

    false = stats.t.cdf(t_of(free), len(free) - 1)
    missed = stats.t.sf(t_of(stops), len(stops) - 1)
    return np.asarray(np.maximum(false, missed), dtype=float)


def choices(measured: Sequence[Measured], scale: Scale, armed_share: float, rate_max: float) -> Iterator[Choice]:
    """Settings that may do it, those for the most speeds first; without the filter before with it.

    measured : by rising speed
    armed_share : of the least speed, from which on a stall counts
    rate_max : of false stalls and of missed ones
    """
    count = len(measured)
    for wide in range(count, 0, -1):
        found = [
            one
            for filtered in (False, True)
            for first in range(count - wide + 1)
            if (one := _choice(measured[first : first + wide], first, scale, armed_share, rate_max, filtered))
        ]
        yield from sorted(found, key=lambda one: (one.filtered, one.rate))


def alone(one: Measured, scale: Scale, armed_share: float, rate_max: float) -> Alone | None:
    """For one speed: what would be tried for it alone; where nothing may do it, what is expected to get least wrong.

    None where fewer than two runs of either kind tell anything.
    """
    first = next(choices([one], scale, armed_share, rate_max), None)
    found: list[tuple[float, bool, int]] = []
    for filtered in (False, True):
        free, stops = one.least(armed_share * one.speed_pps, filtered)
        if min(len(free), len(stops)) >= 2:
            thresholds = range(scale.low, scale.high + 1)
            rates = expected(free, stops, np.array([scale.level(threshold) for threshold in thresholds]))
            at = int(np.argmin(rates))
            found.append((float(rates[at]), filtered, thresholds[at]))
    if not found:
        return None
    _, filtered, threshold = min(found)
    if first is not None:
        filtered, threshold = first.filtered, first.threshold
    free, stops = one.least(armed_share * one.speed_pps, filtered)
    level = scale.level(threshold)
    return Alone(
        threshold=threshold,
        filtered=filtered,
        false=int((free <= level).sum()),
        free_runs=len(free),
        missed=int((stops > level).sum()),
        stops=len(stops),
        may_do=first is not None,
    )


def _choice(
    measured: Sequence[Measured], first: int, scale: Scale, armed_share: float, rate_max: float, filtered: bool
) -> Choice | None:
    pairs = [one.least(armed_share * measured[0].speed_pps, filtered) for one in measured]
    if any(len(runs) < 2 for pair in pairs for runs in pair):
        return None
    thresholds = [
        threshold
        for threshold in sorted(range(scale.low, scale.high + 1), key=scale.level)
        if all(may_do(*pair, scale.level(threshold), rate_max) for pair in pairs)
    ]
    if not thresholds:
        return None
    levels = np.array([scale.level(threshold) for threshold in thresholds])
    rates = np.max([expected(*pair, levels) for pair in pairs], axis=0)
    well = np.flatnonzero(rates <= WELL_BELOW * rate_max)
    at = int(well[len(well) // 2]) if len(well) else int(np.argmin(rates))
    return Choice(
        first, first + len(measured) - 1, filtered, tuple(thresholds), thresholds[at], round(float(rates[at]), 12)
    )
