"""The last so many samples, in memory that never grows."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


class Ring:
    """Keeps the newest rows of time and columns: at most `capacity`, and none `span_s` [s] older than the newest.

    Rows are appended, and only when the end of the buffer is reached are those that are kept moved to its front. So a
    read is one slice, never two. The buffer grows with what is kept, a quarter at a time, up to an eighth more than
    `capacity`: after `span_s` of an even rate it has its length, and axes that rest take little.
    """

    FIRST, SPARE = 256, 8

    def __init__(self, columns: int, capacity: int, span_s: float = math.inf) -> None:
        if capacity < 1:
            raise ValueError(f"a ring keeps at least one row, not {capacity}")
        self.capacity = capacity
        self._span_s = span_s
        room = self._room(self.FIRST)
        self._time_s = np.empty(room)
        self._samples = np.empty((room, columns))
        self._start = 0
        self._end = 0

    def __len__(self) -> int:
        return self._end - self._start

    def append(self, time_s: FloatArray, samples: FloatArray) -> None:
        """Add rows, `time_s` [rows] and `samples` [rows, columns]; the oldest go."""
        if not len(time_s):
            return
        oldest_s = time_s[-1] - self._span_s
        first = max(int(np.searchsorted(time_s, oldest_s)), len(time_s) - self.capacity)
        time_s, samples, rows = time_s[first:], samples[first:], len(time_s) - first
        self._start = max(self._start, self._end - (self.capacity - rows))
        self._start += int(np.searchsorted(self._time_s[self._start : self._end], oldest_s))
        if self._end + rows > len(self._time_s):
            self._make_room(rows)
        self._time_s[self._end : self._end + rows] = time_s
        self._samples[self._end : self._end + rows] = samples
        self._end += rows

    def _make_room(self, rows: int) -> None:
        """Move what is kept to the front, of a longer buffer where it would be nearly full again."""
        keep, old = len(self), slice(self._start, self._end)
        time_s, samples = self._time_s, self._samples
        if keep + rows > len(time_s) * self.SPARE // (self.SPARE + 1):
            room = self._room((keep + rows) * 5 // 4)
            time_s, samples = np.empty(room), np.empty((room, samples.shape[1]))
        time_s[:keep], samples[:keep] = self._time_s[old], self._samples[old]
        self._time_s, self._samples, self._start, self._end = time_s, samples, 0, keep

    def _room(self, rows: int) -> int:
        """So many, or the most that it takes."""
        return min(rows, self.capacity + -(-self.capacity // self.SPARE))

    def since(self, from_s: float, columns: Sequence[int]) -> tuple[FloatArray, FloatArray]:
        """Copies of all rows at `from_s` [s] or later: time [rows], samples [rows, len(columns)]."""
        time_s = self._time_s[self._start : self._end]
        first = int(np.searchsorted(time_s, from_s))
        # those columns alone: all of them are 20 MB of a chip with many channels
        return time_s[first:].copy(), self._samples[self._start + first : self._end, list(columns)]
