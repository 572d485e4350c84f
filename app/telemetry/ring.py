"""The last so many samples, in memory that never grows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


class Ring:
    """Keeps the newest `capacity` rows of time and columns.

    The buffer is an eighth longer than what it keeps: rows are appended, and only when the end is reached
    are they moved to the front. So a read is one slice, never two, and a row is copied some nine times while it is
    kept.
    """

    SPARE = 8

    def __init__(self, columns: int, capacity: int) -> None:
        if capacity < 1:
            raise ValueError(f"a ring keeps at least one row, not {capacity}")
        self.capacity = capacity
        room = capacity + -(-capacity // self.SPARE)
        self._time_s = np.empty(room)
        self._samples = np.empty((room, columns))
        self._start = 0
        self._end = 0

    def __len__(self) -> int:
        return self._end - self._start

    def append(self, time_s: FloatArray, samples: FloatArray) -> None:
        """Add rows, `time_s` [rows] and `samples` [rows, columns]; the oldest go where there is no room."""
        rows = len(time_s)
        if rows > self.capacity:
            time_s, samples, rows = time_s[-self.capacity :], samples[-self.capacity :], self.capacity
        if self._end + rows > len(self._time_s):
            keep = min(len(self), self.capacity - rows)
            self._time_s[:keep] = self._time_s[self._end - keep : self._end]
            self._samples[:keep] = self._samples[self._end - keep : self._end]
            self._start, self._end = 0, keep
        self._time_s[self._end : self._end + rows] = time_s
        self._samples[self._end : self._end + rows] = samples
        self._end += rows
        self._start = max(self._start, self._end - self.capacity)

    def since(self, from_s: float, columns: Sequence[int]) -> tuple[FloatArray, FloatArray]:
        """Copies of all rows at `from_s` [s] or later: time [rows], samples [rows, len(columns)]."""
        time_s = self._time_s[self._start : self._end]
        first = int(np.searchsorted(time_s, from_s))
        # those columns alone: all of them are 20 MB of a chip with many channels
        return time_s[first:].copy(), self._samples[self._start + first : self._end, list(columns)]
