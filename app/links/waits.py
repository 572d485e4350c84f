"""How long turns wait for a line."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

WINDOW_S = 60.0


class Waits:
    """The longest wait of the last minute, those that are not over yet included. For one event loop."""

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self._begun: dict[object, float] = {}
        """Waits that are not over, the oldest first."""
        self._halves = (0.0, 0.0)
        """The longest of the half window before, and of the present one [s]."""
        self._half_since_s = now()

    @contextmanager
    def one(self) -> Iterator[None]:
        """Counts as waiting for as long as the block runs."""
        key = object()
        begun_s = self._begun[key] = self._now()
        try:
            yield
        finally:
            del self._begun[key]
            self._turn()
            before, present = self._halves
            self._halves = (before, max(present, self._now() - begun_s))

    @property
    def longest_s(self) -> float:
        """Over the last half to one `WINDOW_S` [s]; 0 where nobody waited."""
        self._turn()
        oldest_s = next(iter(self._begun.values()), None)
        return max(*self._halves, 0.0 if oldest_s is None else self._now() - oldest_s)

    def _turn(self) -> None:
        passed = (self._now() - self._half_since_s) / (WINDOW_S / 2)
        if passed >= 1:
            self._halves = (self._halves[1] if passed < 2 else 0.0, 0.0)
            self._half_since_s = self._now()
