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
"""The most chip time between two looks at how much work it was [s]: some 6 ms for the dearest chip and motor."""
SLICE_WORK_S = 0.006
"""What the work between two looks is kept near [s of processor time]."""
SLICE_LEAST_S = SLICE_S / 64
UNMEASURED = 1 / 16
"""The part of a slice that is worked out without a look."""


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


class Slice:
    """How much chip time an emulator works out between two looks, by how much work the last ones were.

    Machine code takes the longest there is; the plain Python that serves until it is compiled, a hundred times as slow,
    would hold everybody up for as long as a motor takes to arrive.
    """

    def __init__(self) -> None:
        self.length_s = SLICE_LEAST_S
        """Of chip time [s]."""

    @property
    def unmeasured_s(self) -> float:
        """Chip time that is too short to be worth a look [s]."""
        return UNMEASURED * self.length_s

    def took(self, chip_s: float, work_s: float) -> None:
        """It has worked `work_s` [s] for `chip_s` [s] of its time: twice as much the next time, or what fits."""
        fits_s = SLICE_WORK_S * chip_s / work_s if work_s > 0.0 else SLICE_S
        if fits_s < self.length_s or chip_s > 0.5 * self.length_s:
            self.length_s = min(SLICE_S, max(SLICE_LEAST_S, min(fits_s, 2 * self.length_s)))
