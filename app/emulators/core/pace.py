"""How much work emulators may make of the time that has passed, so that nobody else waits for them for long."""

from __future__ import annotations

import threading
from collections.abc import Callable

AT_ONCE_S = 0.02
"""The most that one catch-up may work [s of processor time]."""
IN_STORE_S = 0.15
"""What emulators may work in a row, after a while in which they did little [s]."""
SHARE = 0.5
"""Of all time, what emulators may work."""
SLICE_S = 0.05
"""Chip time between two looks at how much work it was [s]: some 6 ms for the dearest chip and motor."""


class Pace:
    """The processor time that the emulators of one process share; safe to use from several threads."""

    def __init__(self, now: Callable[[], float], share: float = SHARE) -> None:
        """`now` tells real time [s]; `share` of it may be worked, 1 where the emulators are all that there is."""
        self._now = now
        self._share = share
        self._told_s = now()
        self._left_s = IN_STORE_S
        self._lock = threading.Lock()

    def allowed_s(self) -> float:
        """What a catch-up that begins now may work [s]."""
        with self._lock:
            now_s = self._now()
            self._left_s = min(IN_STORE_S, self._left_s + self._share * (now_s - self._told_s))
            self._told_s = now_s
            return min(AT_ONCE_S, self._left_s)

    def spend(self, work_s: float) -> None:
        """It has worked that long [s].

        One piece that took long for another reason, a compilation or a collection of garbage, lets nobody stand still
        for twice as long: it costs no more than the whole store.
        """
        with self._lock:
            self._left_s = max(-IN_STORE_S, self._left_s - work_s)
