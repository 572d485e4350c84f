"""What paced moves are made of: how fast an axis may go, and its ramp when it is told a speed of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .planned_motion import Plan
from .results import WriteItem


@dataclass(frozen=True, slots=True)
class PaceLimits:
    """An axis that stands: where [microsteps], and the speed and acceleration that its ramp is set to."""

    position: int
    velocity_pps: float
    acceleration_pps2: float


@dataclass(frozen=True, slots=True)
class PacedLeg:
    """A move on a trapezoid: what to write for it, what the registers make of speed and acceleration, and its plan."""

    writes: Sequence[WriteItem]
    velocity_pps: float
    acceleration_pps2: float
    plan: Plan
    shortcomings: tuple[str, ...] = ()
    """What keeps the registers from that speed and acceleration, with figures: said where it leaves the line."""
