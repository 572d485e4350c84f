"""How many calls a second a line can carry, and how many it does."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

BITS_PER_BYTE = 10
"""Start bit, eight data bits, stop bit."""
WINDOW_S = 2.0


class Meter:
    """Calls a second over the last `WINDOW_S`: before its first call there were none."""

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self._counted: deque[tuple[float, int]] = deque()

    def count(self, calls: int) -> None:
        now_s = self._now()
        self._counted.append((now_s, calls))
        self._forget(now_s)

    def rate(self) -> float:
        """Calls a second [1/s]."""
        self._forget(self._now())
        return sum(calls for _, calls in self._counted) / WINDOW_S

    def _forget(self, now_s: float) -> None:
        counted = self._counted
        while counted and counted[0][0] <= now_s - WINDOW_S:
            counted.popleft()


class WireBudget:
    """What a line can carry and what it does carry, all modules on it together.

    `baud` is None where no baud rate limits it: a socket, a CAN bus, a USB port. A line that is seen
    to carry more than its baud rate allows has none either: a virtual port keeps the number and does
    not mind it.
    """

    def __init__(self, baud: int | None, bytes_per_call: int, now: Callable[[], float] = time.monotonic) -> None:
        self.baud = baud
        self.bytes_per_call = bytes_per_call
        self._meter = Meter(now)
        self._limited = baud is not None

    @property
    def calls_per_s_possible(self) -> float | None:
        """Question and answer back to back without a pause [1/s]; None without a limit."""
        if self.baud is None or not self._limited:
            return None
        return self.baud / (BITS_PER_BYTE * self.bytes_per_call)

    @property
    def calls_per_s(self) -> float:
        """Achieved over the last two seconds [1/s]."""
        return self._meter.rate()

    @property
    def share(self) -> float | None:
        """Achieved of possible, 0..1; None without a limit."""
        possible = self.calls_per_s_possible
        return None if possible is None else min(1.0, self.calls_per_s / possible)

    def count(self, calls: int, took_s: float) -> None:
        """For ports: `calls` exchanges were made in `took_s` [s]."""
        self._meter.count(calls)
        possible = self.calls_per_s_possible
        # A single call may be timed short by what a driver has in its buffer; ten in a row may not.
        if possible is not None and calls >= 10 and calls > 1.2 * possible * took_s:
            self._limited = False
