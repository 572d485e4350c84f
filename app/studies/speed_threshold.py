"""A register that says from which speed on something works: in clocks of a step, or as a velocity."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import WrongState
from ..profiles.physical import UnitContext
from ..registers.model import Register

TSTEP_MAX = (1 << 20) - 1
TSTEP_MICROSTEPS = 256
"""TSTEP counts the clocks of one of so many microsteps of a full step, whatever the resolution is."""


@dataclass(frozen=True, slots=True)
class SpeedThreshold:
    """One of them. full_step : [microsteps]"""

    row: Register
    units: UnitContext
    full_step: int

    def speed_pps(self, word: int) -> float:
        """The speed that a word means; 0 clocks are a speed that is never passed."""
        if self.row.unit == "tCLK":
            return self._clocks / word if word else math.inf
        return word * self._unit_pps

    def word(self, speed_pps: float) -> int:
        """What to write for a speed."""
        if self.row.unit == "tCLK":
            return min(max(round(self._clocks / speed_pps), 0), TSTEP_MAX)
        return round(speed_pps / self._unit_pps)

    @property
    def _clocks(self) -> float:
        return self.units.clock_hz * self.full_step / TSTEP_MICROSTEPS

    @property
    def _unit_pps(self) -> float:
        unit = self.units.physical(self.row, 1)
        if unit is None:
            raise WrongState(f"what {self.row.name} counts in is not known", "")
        return unit.value
