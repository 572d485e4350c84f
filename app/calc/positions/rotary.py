"""Axes that turn for ever: the position within a turn, whole turns, and ways to an angle (AN-001 chapter 3).

A turn may be any number of microsteps and, behind a gear, no whole number of them: it is a fraction, so
nothing adds up however long the axis turns.

`Rotary` works on an extended position (`extended_position`).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

Way = Literal["shortest", "positive", "negative"]
TURN_MAX = 1 << 40
"""Microsteps of a turn, at most."""


@dataclass(frozen=True, slots=True)
class Rotary:
    """A turn of the driven shaft is `microsteps_per_turn` microsteps of the motor; `zero` is position 0 of a turn.

    Raises ValueError for a turn of no length, or one beyond 2^40 microsteps.
    """

    microsteps_per_turn: Fraction
    zero: int = 0

    def __post_init__(self) -> None:
        if not 0 < self.microsteps_per_turn <= TURN_MAX:
            raise ValueError(f"a turn is above 0 and at most {TURN_MAX} microsteps, not {self.microsteps_per_turn}")

    @classmethod
    def geared(cls, microsteps_per_motor_turn: int, motor_teeth: int, driven_teeth: int, zero: int = 0) -> Rotary:
        """Behind a gear: with 3 teeth on the motor and 7 on the shaft the motor turns 7/3 times a turn."""
        if motor_teeth < 1 or driven_teeth < 1:
            raise ValueError(f"gears have teeth, not {motor_teeth}:{driven_teeth}")
        return cls(Fraction(microsteps_per_motor_turn * driven_teeth, motor_teeth), zero)

    def split(self, position: int) -> tuple[int, Fraction]:
        """Whole turns (negative below zero), and the place within the turn, 0 <= place < turn [microsteps]."""
        turns, place = divmod(Fraction(position - self.zero), self.microsteps_per_turn)
        return int(turns), place

    def angle_deg(self, position: int) -> float:
        """The place within the turn as an angle, 0..360 [deg]."""
        return float(self.split(position)[1] * 360 / self.microsteps_per_turn)

    def place_at(self, angle_deg: float | Fraction) -> Fraction:
        """The place of an angle within the turn [microsteps]; angles beyond a turn count as what is left of them."""
        return Fraction(angle_deg) * self.microsteps_per_turn / 360 % self.microsteps_per_turn

    def target(self, position: int, place: Fraction | int, way: Way = "shortest") -> int:
        """The position, nearest to exact, of `place` within a turn that is next to `position` that way [microsteps].

        `positive` and `negative` never turn the other way, and not at all where the axis is there already. Of two
        ways of one length the shortest is the positive one. The error of rounding is at most half a microstep, in
        every turn anew.
        """
        turns, _ = self.split(position)
        at = [self._whole(turns + more, Fraction(place) % self.microsteps_per_turn) for more in (-1, 0, 1, 2)]
        if way == "positive":
            return min(target for target in at if target >= position)
        if way == "negative":
            return max(target for target in at if target <= position)
        return min(at, key=lambda target: (abs(target - position), target < position))

    def _whole(self, turn: int, place: Fraction) -> int:
        """The microstep nearest to `place` in that turn; halves go up."""
        exact = turn * self.microsteps_per_turn + place
        return self.zero + int((2 * exact + 1) // 2)
