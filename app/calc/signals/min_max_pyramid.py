"""Min/max pyramid: a long measurement as segments, each with its lowest and its highest sample, so that no peak hides.

Segments are made of rows, and longer ones of shorter ones: once the rows were looked at in short segments, every
plot of any part is put together from these, without the rows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
S = TypeVar("S", np.float64, np.bool_)


@dataclass(frozen=True, slots=True)
class MinMaxSegments:
    """Consecutive segments.

    start_s : [segments], time of the first row of each [s]; never falling
    low, high : [channels, segments], the extremes; NaN where nothing is there
    low_s, high_s : [channels, segments], when they were [s]; the first time where there were several
    missing : [channels, segments], whether a sample is missing
    """

    start_s: FloatArray
    low: FloatArray
    high: FloatArray
    low_s: FloatArray
    high_s: FloatArray
    missing: BoolArray

    def __len__(self) -> int:
        return len(self.start_s)

    @classmethod
    def of_rows(cls, time_s: FloatArray, columns: FloatArray) -> MinMaxSegments:
        """Each row of `time_s` [rows] and `columns` [channels, rows] as a segment of its own; NaN is missing."""
        at_s = np.broadcast_to(time_s, columns.shape)
        return cls(time_s, columns, columns, at_s, at_s, np.isnan(columns))

    @classmethod
    def chained(cls, parts: Sequence[MinMaxSegments]) -> MinMaxSegments:
        """Several, one behind the other."""
        return cls(
            np.concatenate([part.start_s for part in parts]),
            np.concatenate([part.low for part in parts], axis=1),
            np.concatenate([part.high for part in parts], axis=1),
            np.concatenate([part.low_s for part in parts], axis=1),
            np.concatenate([part.high_s for part in parts], axis=1),
            np.concatenate([part.missing for part in parts], axis=1),
        )

    def part(self, first: int, last: int) -> MinMaxSegments:
        """From number `first` up to `last`, without it."""
        return MinMaxSegments(
            self.start_s[first:last],
            self.low[:, first:last],
            self.high[:, first:last],
            self.low_s[:, first:last],
            self.high_s[:, first:last],
            self.missing[:, first:last],
        )

    def joined(self, size: int) -> MinMaxSegments:
        """Each `size` of them as one; the last may be shorter."""
        if size < 1:
            raise ValueError(f"at least one segment becomes one, not {size}")
        if size == 1 or not len(self):
            return self
        low, low_s = _best(self.low, self.low_s, size, 1.0)
        high, high_s = _best(self.high, self.high_s, size, -1.0)
        missing = np.asarray(_folded(self.missing, size, False).any(axis=2))
        return MinMaxSegments(self.start_s[::size], low, high, low_s, high_s, missing)

    def line(self) -> tuple[FloatArray, FloatArray]:
        """As points on one time axis for all channels: `time_s` [points] and `columns` [channels, points].

        A segment is two points, at its beginning and half-way to the next: its extremes in the order in which they
        were; a third one where a sample is missing: NaN for the channels concerned, the second again for the others.
        A single row is a single point.
        """
        first_low = self.low_s <= self.high_s
        first, second = np.where(first_low, self.low, self.high), np.where(first_low, self.high, self.low)
        next_s = np.append(self.start_s[1:], self.start_s[-1:])
        half_s = self.start_s + (next_s - self.start_s) / 2
        third = np.where(self.missing, np.nan, second)
        columns = np.stack((first, second, third), axis=2).reshape(len(self.low), -1)
        time_s = np.stack((self.start_s, half_s, half_s), axis=1).ravel()
        wanted = np.ones(len(time_s), dtype=bool)
        wanted[1::3] = (self.low_s != self.high_s).any(axis=0)
        wanted[2::3] = (self.missing & ~np.isnan(first)).any(axis=0)
        return time_s[wanted], columns[:, wanted]

    def points(self, channel: int) -> tuple[FloatArray, FloatArray]:
        """One channel as points at the samples' own times: (times, values); NaN where one is missing."""
        low, high = self.low[channel], self.high[channel]
        first_low = self.low_s[channel] <= self.high_s[channel]
        first_s = np.where(first_low, self.low_s[channel], self.high_s[channel])
        second_s = np.where(first_low, self.high_s[channel], self.low_s[channel])
        first, second = np.where(first_low, low, high), np.where(first_low, high, low)
        there, missing = ~np.isnan(low), self.missing[channel]
        time_s = np.stack((first_s, second_s, np.where(there, second_s, self.start_s)), axis=1).ravel()
        values = np.stack((first, second, np.full(len(low), np.nan)), axis=1).ravel()
        wanted = np.stack((there, there & (first_s < second_s), missing), axis=1).ravel()
        return time_s[wanted], values[wanted]


def size_for(segments: int, wanted: int) -> int:
    """How many have to become one so that at most `wanted` are left."""
    return max(1, -(-segments // max(1, wanted)))


def _best(values: FloatArray, at_s: FloatArray, size: int, sign: float) -> tuple[FloatArray, FloatArray]:
    """Of each `size` the lowest (`sign` 1) or highest (-1), and its time."""
    folded = _folded(np.where(np.isnan(values), np.inf, sign * values), size, np.inf)
    where = folded.argmin(axis=2, keepdims=True)
    best = np.take_along_axis(folded, where, axis=2)[:, :, 0]
    best_s = np.take_along_axis(_folded(at_s, size, np.nan), where, axis=2)[:, :, 0]
    return np.where(np.isposinf(best), np.nan, sign * best), best_s


def _folded(values: NDArray[S], size: int, fill: float) -> NDArray[S]:
    """[channels, segments] as [channels, longer segments, size], filled up at the end."""
    channels, count = values.shape
    rest = -count % size
    if rest:
        values = np.concatenate((values, np.full((channels, rest), fill, dtype=values.dtype)), axis=1)
    return values.reshape(channels, -1, size)
