"""What an axis may be asked for at most, as the user sets it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ...errors import OutOfRange, UsageError
from ...registers.catalog import MODELS

POSITION_MAX = 1 << 31
"""Counters have 32 bits at the most [microsteps]."""


@dataclass(frozen=True, slots=True)
class AxisLimits:
    """None stands for no limit. Positions are what the chip's counter shows.

    position_min, position_max : [microsteps]; a target beyond is refused, a motion stopped before it gets there
    velocity_max_pps : either way [microsteps/s]
    acceleration_max_pps2 : of every acceleration and deceleration that can be set [microsteps/s^2]
    current_max_a : of a coil, RMS, in motion or at rest [A]
    sense_resistor_ohm : what makes amperes of the current scales of a chip that has such resistors [ohm]
    current_full_scale_a : RMS at the greatest scale, vsense 0 [A]; takes the place of the resistor, and is needed where
        the power stage is outside (TMC428, TMC4361) or not described (PD42-1241)

    Raises OutOfRange for numbers that cannot be.
    """

    position_min: int | None = None
    position_max: int | None = None
    velocity_max_pps: float | None = None
    acceleration_max_pps2: float | None = None
    current_max_a: float | None = None
    sense_resistor_ohm: float | None = None
    current_full_scale_a: float | None = None

    def __post_init__(self) -> None:
        for name in ("position_min", "position_max"):
            position = getattr(self, name)
            if position is not None and not -POSITION_MAX <= position < POSITION_MAX:
                raise OutOfRange(name, position, -POSITION_MAX, POSITION_MAX - 1, "microsteps")
        if self.position_min is not None and self.position_max is not None and self.position_min > self.position_max:
            raise OutOfRange("position_min", self.position_min, None, self.position_max, "not above position_max")
        for name in ("velocity_max_pps", "acceleration_max_pps2", "current_max_a"):
            limit = getattr(self, name)
            if limit is not None and not 0 < limit <= 1e12:
                raise OutOfRange(name, limit, 0, 1e12, "above 0; null for no limit")
        for name in ("sense_resistor_ohm", "current_full_scale_a"):
            number = getattr(self, name)
            if number is not None and not (math.isfinite(number) and 0 < number <= 1000):
                raise OutOfRange(name, number, 0, 1000, "above 0")

    @property
    def given(self) -> bool:
        """Whether anything is limited."""
        return self.ranged or any(
            limit is not None for limit in (self.velocity_max_pps, self.acceleration_max_pps2, self.current_max_a)
        )

    @property
    def ranged(self) -> bool:
        """Whether the position is limited."""
        return self.position_min is not None or self.position_max is not None

    def beyond(self, position: int) -> int:
        """How far `position` is outside of the range [microsteps]: below it negative, above it positive, else 0."""
        if self.position_max is not None and position > self.position_max:
            return position - self.position_max
        if self.position_min is not None and position < self.position_min:
            return position - self.position_min
        return 0

    def require_model(self, model: str) -> None:
        """Raises UsageError where the current is limited and nobody can tell what it is, or the position of what counts
        none."""
        if self.ranged and not MODELS[model].counts_position:
            raise UsageError("position_min and position_max cannot be kept here: a driver counts no position")
        if self.current_max_a is None:
            return
        scale = MODELS[model].current_scale
        if scale == "sense_resistor" and self.sense_resistor_ohm is None and self.current_full_scale_a is None:
            raise UsageError(f"current_max_a needs {full_scale_figures(model)}: a chip tells no A")
        if scale == "full_scale" and self.current_full_scale_a is None:
            raise UsageError("current_max_a needs current_full_scale_a: what the greatest current scale gives, RMS")
        if not scale:
            raise UsageError("current_max_a cannot be kept here: its step/direction driver sets the current")


def full_scale_figures(model: str) -> str:
    """Which of the limits tell what full scale of its current is in A, in words."""
    by_resistor = MODELS[model].current_scale == "sense_resistor"
    return f"{'sense_resistor_ohm or ' * by_resistor}current_full_scale_a"
