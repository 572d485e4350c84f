"""What a turn of an axis is: a length, exactly, the gear that it came from, and where its angle 0 is."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

from ..calc.positions.rotary import Rotary
from ..store.positions import Gear


@dataclass(frozen=True, slots=True)
class Turn:
    """A turn of the driven shaft. Raises ValueError for one that cannot be.

    gear : microsteps per turn of the motor, teeth on the motor, teeth on the shaft; None where the length was given
    """

    microsteps_per_turn: Fraction
    gear: Gear | None = None
    zero: int = 0

    def __post_init__(self) -> None:
        _ = self.rotary

    @classmethod
    def geared(cls, gear: Gear, zero: int) -> Turn:
        """Raises ValueError."""
        return cls(Rotary.geared(*gear).microsteps_per_turn, gear, zero)

    @property
    def rotary(self) -> Rotary:
        return Rotary(self.microsteps_per_turn, self.zero)

    def with_zero(self, zero: int) -> Turn:
        return replace(self, zero=zero)

    def displacement_const(self, counter_modulus: int) -> Fraction:
        """DISPLACEMENT_CONST: what a wrap of the counter adds to the place within the turn (AN-001 3.2)."""
        return Fraction(counter_modulus) % self.microsteps_per_turn

    def offset(self, position: int, count: int, counter_modulus: int) -> Fraction:
        """OFFSET: what, added to the counter as a positive number, gives the place within the turn (AN-001 3.2)."""
        return Fraction(position - self.zero - count % counter_modulus) % self.microsteps_per_turn
