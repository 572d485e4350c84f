"""How a threshold moves the load values of a chip: the one scale on which both StallGuards can be compared."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ...telemetry.sampling import FloatArray

Generation = Literal[2, 4]
COUNTS_A_THRESHOLD = 8.0
"""What one more of SGT adds to a StallGuard2 value, about, until it is measured (INFERRED)."""


@dataclass(frozen=True, slots=True)
class Scale:
    """StallGuard2 adds the threshold to the value, and a stall is a value of 0; StallGuard4 compares with twice it.

    low, high : the range of the threshold
    slope : what one more of it adds to a value [counts]; 0 of StallGuard4
    """

    generation: Generation
    low: int
    high: int
    slope: float = 0.0

    def level(self, threshold: int) -> float:
        """The level at or below which a value at threshold 0 is a stall."""
        return -self.slope * threshold if self.generation == 2 else 2.0 * threshold

    def at_zero(self, values: FloatArray, threshold: int) -> FloatArray:
        """What values that were measured at a threshold would be at 0."""
        return values - self.slope * threshold

    def stricter(self, threshold: int, steps: int) -> int:
        """The threshold by which fewer values are a stall, `steps` further; of negative steps more."""
        moved = threshold + steps if self.generation == 2 else threshold - steps
        return min(max(moved, self.low), self.high)
