"""A recording as the twin shows it: the state of its axis at any of its times."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .shape import CHANNELS, AxisPose, Shape, Slips, look_of
from .watch import Watches

FloatArray = NDArray[np.float64]

WATCHED_ROWS = 20_000
"""A longer recording is thinned for what is watched over its whole length: what was lost in milliseconds is still
to be seen long after."""


class RecordedAxis:
    """The samples of one axis: `time_s` [rows], never falling, and columns by quantity [rows], NaN where missing."""

    def __init__(
        self,
        recording: str,
        shape: Shape,
        zero_s: float,
        time_s: FloatArray,
        columns: Mapping[str, FloatArray],
        rows: int | None = None,
    ) -> None:
        """`rows` are those of the recording, where these samples are not all of them."""
        self.recording = recording
        self.rows = len(time_s) if rows is None else rows
        self.zero_s = zero_s
        self._time_s = time_s
        self._columns = {name: column for name, column in columns.items() if name in CHANNELS}
        self.shape = replace(shape, channels=frozenset(self._columns))
        every = max(1, -(-len(time_s) // WATCHED_ROWS))
        watches = Watches()
        self._slips = watches.feed(
            self.shape, time_s[::every], {name: column[::every] for name, column in self._columns.items()}
        )
        self._travel = watches.travel(self.shape)

    @property
    def span_s(self) -> tuple[float, float]:
        """First and last time since the zero [s]; both 0 where nothing was recorded."""
        if not len(self._time_s):
            return 0.0, 0.0
        return float(self._time_s[0]) - self.zero_s, float(self._time_s[-1]) - self.zero_s

    def at(self, since_zero_s: float) -> AxisPose:
        """The latest sample at or before that time; before the first one nothing is known."""
        row = int(np.searchsorted(self._time_s, self.zero_s + since_zero_s + 1e-9, side="right")) - 1
        if row < 0:
            return AxisPose(travel=self._travel)
        at_s = float(self._time_s[row])
        values = {name: float(column[row]) for name, column in self._columns.items()}
        slips = next((slips for slips in reversed(self._slips) if (slips.last_s or 0.0) <= at_s), Slips())
        return look_of(self.shape, at_s, values, slips, self._travel)
