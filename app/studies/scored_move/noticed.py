"""Moves that somebody makes, found in the samples of an axis: from rest to rest, one way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...telemetry.sampling import FloatArray
from ..moves import Sampled

POSITION, ENCODER, VELOCITY, LOAD = range(4)
"""Columns of the samples; the last one is there where the chip has a load value."""
BEFORE_S = 0.1
"""Of the rest before a move, so much is kept [s]."""
REST_S = 0.4
"""A move is over when the position has stood so long [s]."""
ENDS_S = 0.1
"""The last part of that, which tells where the shaft rests [s]."""
LONGEST_S = 60.0
"""A longer move is none that is scored: its samples are bounded by that [s]."""
LEAST_ROWS = 4


@dataclass(frozen=True, slots=True)
class NoticedMove:
    """One move. sampled, target : as of a move that was begun here; before : encoder less position at rest, before it
    [microsteps]; time_s, columns : all of its samples; stalled_at : where a stall ended it, None where none did"""

    sampled: Sampled
    target: int
    before: float
    time_s: FloatArray
    columns: FloatArray
    stalled_at: int | None = None


class MoveFinder:
    """Finds them as rows come. missed : moves that went to and fro without a rest, turned too long, or had gaps."""

    def __init__(self, columns: int, full_step: int) -> None:
        """`full_step` in microsteps: shorter moves are none."""
        self._full_step = full_step
        self._time_s: FloatArray = np.empty(0)
        self._columns: FloatArray = np.empty((columns, 0))
        self._whole = True
        self.missed = 0

    @property
    def moving(self) -> bool:
        """Whether one is under way."""
        return len(self._changes()) > 0

    def gap(self) -> None:
        """Samples are missing: what is under way cannot be scored."""
        self._whole = not self.moving

    def feed(self, time_s: FloatArray, columns: FloatArray) -> list[NoticedMove]:
        """Further rows, `columns` [columns, rows]; the moves that are over with them."""
        known = np.isfinite(columns[[POSITION, ENCODER]]).all(axis=0)
        self._time_s = np.concatenate((self._time_s, time_s[known]))
        self._columns = np.concatenate((self._columns, columns[:, known]), axis=1)
        found = []
        while len(changes := self._changes()):
            apart = np.flatnonzero(np.diff(self._time_s[changes]) > REST_S)
            last = int(changes[apart[0]] if len(apart) else changes[-1]) + 1
            if self._time_s[-1] - self._time_s[last] < REST_S:
                if self._time_s[-1] - self._time_s[changes[0]] > LONGEST_S:
                    self._whole = False
                    self._keep_from(len(self._time_s) - 2)
                break
            end = int(np.searchsorted(self._time_s, self._time_s[last] + REST_S))
            one = self._cut(int(changes[0]), last, end)
            found += [] if one is None else [one]
            self._whole = True
            self._keep_from(last)
        if not self.moving and len(self._time_s):
            self._keep_from(int(np.searchsorted(self._time_s, self._time_s[-1] - BEFORE_S)))
        return found

    def _changes(self) -> NDArray[np.intp]:
        """Rows after which the position is another."""
        return np.flatnonzero(np.diff(self._columns[POSITION]))

    def _keep_from(self, row: int) -> None:
        self._time_s, self._columns = self._time_s[row:], self._columns[:, row:]

    def _cut(self, first: int, last: int, end: int) -> NoticedMove | None:
        """The move between these rows of rest; None for what is none."""
        position = self._columns[POSITION]
        start, target = int(position[first]), int(position[last])
        velocity = self._columns[VELOCITY, first : last + 1]
        if not np.any(velocity[np.isfinite(velocity)]):
            return None  # the counter was set, and nothing moved
        steps = np.diff(position[first : last + 1])
        one_way = bool(np.all(steps >= 0) or np.all(steps <= 0))
        if not self._whole or not one_way or first == 0:
            self.missed += 1
            return None
        if abs(target - start) < self._full_step or last - first < LEAST_ROWS:
            return None
        begin = int(np.searchsorted(self._time_s, self._time_s[first] - BEFORE_S))
        time_s, columns = self._time_s[begin:end], self._columns[:, begin:end]
        off = columns[ENCODER] - columns[POSITION]
        at_rest = time_s >= time_s[-1] - ENDS_S
        began_s = float(self._time_s[first])
        sampled = Sampled(
            began_s,
            time_s - began_s,
            columns[POSITION],
            columns[ENCODER],
            start,
            float(np.median(off[at_rest])),
            columns[LOAD:].T,
        )
        return NoticedMove(sampled, target, float(np.median(off[: first - begin + 1])), time_s, columns)
