"""Which threshold tells a stall from a free run: by the least load value of each run, free ones and those into a stop.

A stall is told by the first value at or below a level, so of a run its least value alone counts. Free runs are to
stay above the level, runs into the stop to come to it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...telemetry.sampling import FloatArray
from .scale import Scale

APART = 2.0
"""How many standard deviations of the least values a level has to be from their mean, on either side, to be tried: of
a normal one once in 44 is beyond that. What holds, the proof tells."""
CENTRE = 0.2
"""Share of the gap between free runs and stalls that a level keeps from its ends."""
FILTERED = 4
"""Values that the filter takes the mean of: four full steps."""
LEAST_SPREAD = 1.0
"""Of least values [counts]: they are whole numbers."""


@dataclass(frozen=True, slots=True)
class Run:
    """One run: load values as they would be at threshold 0, and the speeds that they were measured at [pps]."""

    values: FloatArray
    speeds_pps: FloatArray

    def least(self, above_pps: float, filtered: bool) -> float | None:
        """The least value at `above_pps` or more, of the means of four with the filter; None of none."""
        values = self.values[self.speeds_pps >= above_pps]
        if filtered:
            whole = len(values) // FILTERED * FILTERED
            values = values[:whole].reshape(-1, FILTERED).mean(axis=1)
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
    """A setting: at which of the speeds, from the first to the last, it tells a stall, and how sure that looks."""

    first: int
    last: int
    filtered: bool
    threshold: int
    apart: float
    """Standard deviations to the nearest of free runs and stalls."""


def roc(free: FloatArray, stops: FloatArray) -> list[tuple[float, float, float]]:
    """(level, share of free runs with a false stall, share of stalls missed) for each level that makes a difference."""
    levels = np.unique(np.concatenate((free, stops)))
    return [(float(level), float((free <= level).mean()), float((stops > level).mean())) for level in levels]


def apart(free: FloatArray, stops: FloatArray, level: float) -> float:
    """How far `level` is from both, in their standard deviations; negative where it lies on the wrong side of one."""
    if len(free) < 2 or len(stops) < 2:
        return float("-inf")
    gap = float(free.min() - stops.max())
    from_free = (float(free.mean()) - level) / max(float(free.std(ddof=1)), LEAST_SPREAD)
    from_stops = (level - float(stops.mean())) / max(float(stops.std(ddof=1)), LEAST_SPREAD)
    if gap <= 0 or not stops.max() + CENTRE * gap <= level <= free.min() - CENTRE * gap:
        return min(from_free, from_stops, 0.0)
    return min(from_free, from_stops)


def choices(measured: Sequence[Measured], scale: Scale, armed_share: float) -> Iterator[Choice]:
    """Settings that look as if they did it, the one for the most speeds first; without the filter before with it.

    measured : by rising speed
    armed_share : of the least speed, from which on a stall counts
    """
    count = len(measured)
    for wide in range(count, 0, -1):
        found = [
            best
            for filtered in (False, True)
            for first in range(count - wide + 1)
            if (best := _best(measured, first, first + wide - 1, scale, armed_share, filtered)) is not None
        ]
        yield from sorted(found, key=lambda one: (one.filtered, -one.apart))


def _best(
    measured: Sequence[Measured], first: int, last: int, scale: Scale, armed_share: float, filtered: bool
) -> Choice | None:
    above_pps = armed_share * measured[first].speed_pps
    pairs = [one.least(above_pps, filtered) for one in measured[first : last + 1]]
    rated = [
        (min(apart(free, stops, scale.level(threshold)) for free, stops in pairs), threshold)
        for threshold in range(scale.low, scale.high + 1)
    ]
    far, threshold = max(rated)
    return Choice(first, last, filtered, threshold, far) if far >= APART else None
