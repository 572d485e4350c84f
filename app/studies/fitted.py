"""Fitted figures as a record tells them, and a ring as it was measured and fitted."""

from __future__ import annotations

import math

from pydantic import Field

from ..calc.motors.ring_down import Fitted, RingDown
from .parts import Interval, Part


class Estimate(Part):
    """A figure and its 95 % interval."""

    value: float
    interval: Interval


class Ringing(Part):
    """One ring as it was measured, and as the fit has it: electrical angle about where the rotor shall rest."""

    time_s: list[float] = Field(default_factory=list)
    measured_deg: list[float] = Field(default_factory=list)
    fitted_deg: list[float] = Field(default_factory=list)
    residual_deg: float = Field(description="root mean square of what the fit leaves [deg electrical]")


def estimate(found: Fitted, scale: float = 1.0) -> Estimate:
    """A fitted figure, perhaps in another unit."""
    told = found.scaled(scale)
    return Estimate(value=told.value, interval=Interval(low=told.value - told.half, high=told.value + told.half))


def fitted(told: Estimate) -> Fitted:
    """The other way: a figure as it is calculated with."""
    return Fitted(told.value, (told.interval.high - told.interval.low) / 2)


def ringing(rings: RingDown) -> Ringing:
    """The ring that was fitted and is shown."""
    return Ringing(
        time_s=rings.time_s.tolist(),
        measured_deg=[math.degrees(angle) for angle in rings.samples.tolist()],
        fitted_deg=[math.degrees(angle) for angle in rings.fitted.tolist()],
        residual_deg=math.degrees(rings.residual),
    )
