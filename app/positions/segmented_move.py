"""A move of any length, in pieces that the counter can tell: what it wants next, and how it ended.

The chip always has a target at most a quarter of its counter's range away, and at every look of the service that target
is moved on, so that it never arrives anywhere but at the end (AN-001 2.1). What ends it early ends it for good: nothing
is sent again after a stop, a command of another client, or a failure of the link.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from ..calc.positions.extended import Counter, next_target, pieces
from .state import Pieces

How = Literal["under way", "arrived", "ended", "failed"]
RESTS = 2
"""At how many looks in a row the motor has to stand short of the target before that is told."""


class SegmentedMove:
    """One move. Positions are what the counter counts, without its end.

    `find` tells the target from where the axis stands; None where `target` is known from the start. Before it is
    asked the motor is stopped: a place within a turn is only that way reached without turning back.
    """

    def __init__(self, counter: Counter, start: int, target: int | None, find: Callable[[int], int] | None) -> None:
        self.counter = counter
        self.start = start
        self.target = target
        self._find = find
        self.how: How = "under way"
        self.message = ""
        self.warnings: list[str] = []
        self.written: int | None = None
        """What the chip's target register was told last."""
        self._piece_ends_at: int | None = None
        """Where that is; None where it is the target itself, and before anything was told."""
        self._rested = 0
        self._rested_at: int | None = None

    @property
    def going(self) -> bool:
        return self.how == "under way"

    def stands(self, at: int) -> None:
        """The motor stands at `at`: where the target had to wait for that, it is known now."""
        if self.target is None and self._find is not None:
            self.start, self.target = at, self._find(at)

    def wants(self, at: int) -> int | None:
        """What the chip's target has to be now, as its counter shows it; None where it is that already."""
        if self.target is None:
            return None
        wanted = next_target(self.counter, self.target, at)
        return None if wanted == self.written else wanted

    def wrote(self, written: int, at: int) -> None:
        """The chip's target register was told `written` while the axis was at `at`."""
        self.written = written
        end = at + self.counter.way(written, self.counter.shows(at))
        self._piece_ends_at = None if end == self.target else end

    def hurries(self, at: int) -> bool:
        """Whether the service had better look soon: arrived, or less than half a piece left of a longer way."""
        end = self._piece_ends_at
        return at == self.target or (end is not None and abs(end - at) < self.counter.piece // 2)

    def rests(self, at: int) -> bool:
        """The motor stands at `at`, which is not the target: whether it did for long enough."""
        self._rested = self._rested + 1 if at == self._rested_at else 1
        self._rested_at = at
        return self._rested >= RESTS

    def turns(self) -> None:
        """The motor turns."""
        self._rested_at = None

    def end(self, how: How, message: str) -> None:
        """It is over. The first word counts."""
        if self.going:
            self.how, self.message = how, message

    def pieces(self, at: int) -> Pieces | None:
        if self.target is None:
            return None
        total = pieces(self.counter, self.target, self.start)
        return Pieces(total, total - min(total, pieces(self.counter, self.target, at)), self.counter.piece)

    def progress(self, at: int) -> float | None:
        """0..1; 1 of a way of no length."""
        if self.target is None:
            return None
        whole = self.target - self.start
        return min(1.0, max(0.0, (at - self.start) / whole)) if whole else 1.0
