"""An axis of a plain emulated module: a trapezoid in velocity to a speed or to a target, worked out exactly."""

from __future__ import annotations

import math

PHASES_MAX = 16
"""A way to a target has four phases at the most: stop, start, cruise, brake; rounding may cut one in two."""
SETTLED = 1e-6
"""What rounding may come to [counts]: so near to where braking begins it begins, and so near to the target is there."""


class Axis:
    """Counts and seconds. `max_speed` and `acceleration` are what its parameters hold, whatever they count in."""

    def __init__(self) -> None:
        self.position = 0.0
        self.speed = 0.0
        self.target = 0
        self.target_speed = 0
        self.positioning = True
        self.max_speed = 0
        self.acceleration = 0

    def go_to(self, target: int) -> None:
        """By the greatest speed and acceleration, and stay there."""
        self.target, self.target_speed, self.positioning = target, 0, True

    def turn(self, speed: int) -> None:
        """On and on; 0 slows down to a stop."""
        self.target_speed, self.positioning = speed, False

    def set_position(self, position: int) -> None:
        """Call the place where it is `position`; it goes nowhere by that."""
        self.position = float(position)
        if self.positioning:
            self.target = position

    @property
    def counter(self) -> int:
        """The position counter: 32 bits, which wrap."""
        return (math.floor(self.position + 0.5) + (1 << 31)) % (1 << 32) - (1 << 31)

    @property
    def reached(self) -> bool:
        return self.positioning and self.speed == 0 and self.position == self.target

    @property
    def rests(self) -> bool:
        """Whether it stays as it is until it is written to."""
        if self.speed:
            return False
        if self.positioning:
            return self.position == self.target or not (self.max_speed and self.acceleration)
        return self.target_speed == 0 or self.acceleration == 0

    def run(self, duration_s: float) -> None:
        """Live on for so long [s]."""
        left_s = duration_s
        for _ in range(PHASES_MAX):
            if left_s <= 0 or self.rests:
                return
            left_s -= self._phase(left_s)

    def _phase(self, longest_s: float) -> float:
        """One stretch of constant acceleration, cut off after `longest_s`; how long it lasted [s]."""
        if not self.positioning:
            return self._towards_speed(float(self.target_speed), longest_s)
        if not self.acceleration or not self.max_speed:  # it runs on as it is: nothing can brake it
            self.position += self.speed * longest_s
            return longest_s
        way = self.target - self.position
        forth = 1.0 if way > 0 else -1.0
        along = self.speed * forth
        braking = self.speed**2 / (2 * self.acceleration)
        if along < 0 or braking > abs(way) * (1 + 1e-9) + SETTLED:
            return self._towards_speed(0.0, longest_s)
        if abs(way) <= SETTLED and along <= math.sqrt(2 * self.acceleration * SETTLED):
            self.position, self.speed = float(self.target), 0.0
            return 0.0
        if math.isclose(braking, abs(way), rel_tol=1e-9, abs_tol=SETTLED):
            return self._brake(longest_s)
        top = min(float(self.max_speed), math.sqrt(self.acceleration * abs(way) + self.speed**2 / 2))
        if not math.isclose(along, top, rel_tol=1e-12):
            return self._towards_speed(top * forth, longest_s)
        cruise_s = (abs(way) - braking) / top
        lasts_s = min(cruise_s, longest_s)
        self.position += self.speed * lasts_s
        return lasts_s

    def _brake(self, longest_s: float) -> float:
        """To rest, exactly at the target."""
        lasts_s = abs(self.speed) / self.acceleration
        if lasts_s <= longest_s:
            self.position, self.speed = float(self.target), 0.0
            return lasts_s
        return self._towards_speed(0.0, longest_s)

    def _towards_speed(self, speed: float, longest_s: float) -> float:
        """At the acceleration towards `speed`; on at it where that is the speed already."""
        if speed == self.speed or not self.acceleration:
            self.position += self.speed * longest_s
            return longest_s
        takes_s = abs(speed - self.speed) / self.acceleration
        lasts_s = min(takes_s, longest_s)
        after = (
            speed if lasts_s == takes_s else self.speed + math.copysign(self.acceleration * lasts_s, speed - self.speed)
        )
        self.position += (self.speed + after) / 2 * lasts_s
        self.speed = after
        return lasts_s
