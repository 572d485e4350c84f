"""A load cycle, and the same with more speed: what a lower supply does to a motor, more speed does as well.

Back-EMF and the voltage that turns a current round grow with the speed. So a motor that follows at 1.25 times the speed
also follows at its own with 0.8 times the supply, not quite so little where resistance has a large part in it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ..ramp_settings import ACCELERATION, SPEED, least_time_s

LEAST_TIMES = 1.02
"""Less more speed than this shows nothing."""


@dataclass(frozen=True, slots=True)
class Cycle:
    """There and back. distance : with its sign [microsteps]; ramp : speed and acceleration [pps, pps^2]; times : the
    speed that it gets to, of the one of the load cycle."""

    distance: int
    ramp: Mapping[str, float]
    times: float = 1.0

    @property
    def way(self) -> int:
        """1 or -1."""
        return 1 if self.distance > 0 else -1

    @property
    def peak(self) -> float:
        """The speed that it gets to [pps]."""
        return min(self.ramp[SPEED], math.sqrt(abs(self.distance) * self.ramp[ACCELERATION]))

    @property
    def time_s(self) -> float:
        """Of one move [s]."""
        return least_time_s(self.distance, self.ramp[SPEED], self.ramp[ACCELERATION])


def faster(cycle: Cycle, times: float, most: Mapping[str, float], room: float) -> Cycle | None:
    """The same with so many times the speed, as far as `most` [pps, pps^2] allows it; None where that shows nothing.

    It goes further where it would not come to that speed; where it has no `room` for that [microsteps], it accelerates
    harder.
    """
    peak, acceleration = cycle.peak, cycle.ramp[ACCELERATION]
    speed = min(times * peak, most[SPEED])
    distance = max(float(abs(cycle.distance)), speed**2 / acceleration)
    if distance > room:
        distance = float(abs(cycle.distance))
        acceleration = max(acceleration, min(speed**2 / distance, most[ACCELERATION]))
        speed = min(speed, math.sqrt(acceleration * distance))
    if speed < LEAST_TIMES * peak:
        return None
    return Cycle(cycle.way * math.ceil(distance), {SPEED: speed, ACCELERATION: acceleration}, speed / peak)
