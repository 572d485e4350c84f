"""Statistics of a part of a measurement, by which two of them are compared."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BAND = 0.02
"""Settled is what stays within this share of the way of where it ends."""


@dataclass(frozen=True, slots=True)
class Statistics:
    """Of the samples that are there. Overshoot and settling are those of a step: None where the values go nowhere.

    peak : the value farthest from 0, with its sign
    overshoot : how far beyond its last value it went, in the direction of the step [unit of the channel]
    settling_s : from the first sample until it stays within 2 % of the step of its last value [s]
    """

    samples: int
    missing: int
    minimum: float | None
    maximum: float | None
    mean: float | None
    rms: float | None
    peak: float | None
    first: float | None
    last: float | None
    overshoot: float | None
    settling_s: float | None


Piece = tuple[FloatArray, FloatArray]
"""Times [rows, s] and columns [channels, rows] of a part of a measurement."""


def statistics(pieces: Callable[[], Iterable[Piece]], channels: int) -> list[Statistics]:
    """Statistics of each of `channels`; NaN is missing. All None where nothing is there.

    `pieces` gives the measurement part by part, in order, and anew with each call: it is gone through twice, so that
    one which is longer than the memory has statistics as well.
    """
    sums = [_Sums() for _ in range(channels)]
    for _, columns in pieces():
        for one, values in zip(sums, columns, strict=True):
            one.add(values)
    steps = {number: _Step(one.first, one.last) for number, one in enumerate(sums) if one.is_step}
    if steps:
        for time_s, columns in pieces():
            for number, step in steps.items():
                step.add(time_s, columns[number])
    return [one.statistics(steps.get(number)) for number, one in enumerate(sums)]


class _Sums:
    """What one pass over a channel tells."""

    def __init__(self) -> None:
        self.samples = self.missing = 0
        self.first = self.last = self._peak = math.nan
        self._low, self._high = math.inf, -math.inf
        self._sum = self._squares = 0.0

    def add(self, values: FloatArray) -> None:
        known = values[np.isfinite(values)]
        self.missing += len(values) - len(known)
        if not len(known):
            return
        if not self.samples:
            self.first = self._peak = float(known[0])
        self.samples += len(known)
        self.last = float(known[-1])
        self._low, self._high = min(self._low, float(known.min())), max(self._high, float(known.max()))
        self._sum += float(known.sum())
        self._squares += float(np.dot(known, known))
        peak = float(known[np.abs(known).argmax()])
        if abs(peak) > abs(self._peak):
            self._peak = peak

    @property
    def is_step(self) -> bool:
        """Whether it ends elsewhere than it began; noise around one place has neither overshoot nor settling time."""
        return self.samples > 0 and abs(self.last - self.first) > 0.5 * (self._high - self._low)

    def statistics(self, step: _Step | None) -> Statistics:
        if not self.samples:
            return Statistics(0, self.missing, *[None] * 9)
        return Statistics(
            samples=self.samples,
            missing=self.missing,
            minimum=self._low,
            maximum=self._high,
            mean=self._sum / self.samples,
            rms=math.sqrt(self._squares / self.samples),
            peak=self._peak,
            first=self.first,
            last=self.last,
            overshoot=step.overshoot if step else None,
            settling_s=step.settling_s if step else None,
        )


class _Step:
    """A channel on its way from `first` to `last`."""

    def __init__(self, first: float, last: float) -> None:
        self._last, self._step = last, last - first
        self.overshoot = 0.0
        self._began_s = self._settled_s = math.nan
        self._outside = False
        """Whether the latest sample was outside of the band."""

    def add(self, time_s: FloatArray, values: FloatArray) -> None:
        there = np.isfinite(values)
        away, at_s = values[there] - self._last, time_s[there]
        if not len(away):
            return
        if math.isnan(self._began_s):
            self._began_s = self._settled_s = float(at_s[0])
        elif self._outside:
            self._settled_s = float(at_s[0])
        self.overshoot = max(self.overshoot, float((away * math.copysign(1.0, self._step)).max()))
        outside = np.flatnonzero(np.abs(away) > BAND * abs(self._step))
        self._outside = len(outside) > 0 and int(outside[-1]) == len(away) - 1
        if len(outside):
            self._settled_s = float(at_s[min(outside[-1] + 1, len(at_s) - 1)])

    @property
    def settling_s(self) -> float:
        """From the first sample until it stays in the band [s]."""
        return self._settled_s - self._began_s
