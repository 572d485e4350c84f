"""A register that says from which speed on something works: in clocks of a step, or as a velocity."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..registers.model import Register

TSTEP_MAX = (1 << 20) - 1
TSTEP_MICROSTEPS = 256
"""TSTEP counts the clocks of one of so many microsteps of a full step, whatever the resolution is."""
VELOCITY_SCALE = 1 << 24
"""A velocity counts clock / 2^24 microsteps a second."""


@dataclass(frozen=True, slots=True)
class SpeedThreshold:
    """One of them. full_step : [microsteps]"""

    row: Register
    clock_hz: float
    full_step: int

    def speed_pps(self, word: int) -> float:
        """The speed that a word means; 0 clocks are a speed that is never passed."""
        if self.row.unit == "tCLK":
            return self._clocks / word if word else math.inf
        return word * self.clock_hz / VELOCITY_SCALE

    def word(self, speed_pps: float) -> int:
        """What to write for a speed."""
        if self.row.unit == "tCLK":
            return min(max(round(self._clocks / speed_pps), 0), TSTEP_MAX)
        return round(speed_pps / self.clock_hz * VELOCITY_SCALE)

    @property
    def _clocks(self) -> float:
        return self.clock_hz * self.full_step / TSTEP_MICROSTEPS
