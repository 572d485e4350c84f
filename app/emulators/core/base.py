"""What every emulated thing at the far end of a wire has: seconds of its own, and a chip the faults of its link."""

from __future__ import annotations

import random
import threading
from abc import ABC, abstractmethod
from dataclasses import dataclass

from pydantic import BaseModel

from ...clock import Clock, ScaledClock
from .noise import flip


class FarEnd(ABC):
    """Lives by `clock`, `time_scale` times as fast, and never by itself: whoever asks makes it catch up first."""

    def __init__(self, clock: Clock, time_scale: float) -> None:
        self.clock = ScaledClock(clock, time_scale)
        self._lock = threading.Lock()
        self._latest_s = 0.0
        """Where it has been brought to, on `clock` [s]."""

    @property
    def brought_to_s(self) -> float:
        """The latest time used, on `clock` [s]."""
        return self._latest_s

    @abstractmethod
    def _run_until(self, at_s: float | None) -> None:
        """Run to `at_s` [s], by default now; never back. The lock is held."""

    def caught_up(self, lag_s: float = 1e-9) -> bool:
        """Has it been brought to within `lag_s` [s] of its clock?"""
        return self.clock.now() - self._latest_s <= lag_s

    def catch_up(self, slice_s: float) -> bool:
        """Bring it on by at most `slice_s` [s] of its time; True once it is up to date.

        Never needed for correctness: who asks after hours without it just waits for all of them at once.
        """
        now_s = self.clock.now()
        with self._lock:
            until_s = min(now_s, self._latest_s + slice_s)
            self._run_until(until_s)
        return until_s == now_s

    def _clocks(self, at_s: float | None, clock_hz: float) -> int:
        """Clocks of an oscillator by `at_s` [s], by default now; rounded so that exact instants stay exact."""
        self._latest_s = max(self._latest_s, self.clock.now() if at_s is None else at_s)
        return int(self._latest_s * clock_hz + 0.5)


@dataclass(slots=True)
class ChipFaults:
    """What is wrong between a chip and us at present."""

    silence: bool = False
    unplugged: bool = False
    bit_error_rate: float = 0.0

    def change(self, change: BaseModel) -> None:
        """Take what `change`, a document with fields of these names, names."""
        for name, value in change.model_dump(exclude_none=True).items():
            setattr(self, name, value)

    def require_plugged(self, model: str) -> None:
        """Raises ConnectionError while unplugged."""
        if self.unplugged:
            raise ConnectionError(f"emulated {model} is unplugged")

    def pass_on(self, model: str, reply: bytes, noise: random.Random) -> bytes:
        """What arrives of `reply`. Raises TimeoutError while silent."""
        reply = flip(reply, self.bit_error_rate, noise)
        if self.silence:
            raise TimeoutError(f"emulated {model} is silent")
        return reply
