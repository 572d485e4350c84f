"""What a resonance map tells: ripple at each speed and order, resonances by name, and what each change made of it.

Amplitudes in degrees electrical: 360 of them are four full steps.
"""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ..fitted import Estimate
from ..parts import Interval, Part

Told = Literal["quieter", "louder", "no difference"]


class MapPoint(Part):
    """One speed. Null is what could not be told."""

    speed_rps: float = Field(description="[turns of the motor a second]")
    electrical_hz: float
    ripple_deg: float | None = Field(
        description="root mean square of what the rotor is beside its mean lag, drift and the encoder's eccentricity"
    )
    interval_deg: Interval | None = Field(description="95 %, by repeats; null for fewer than two")
    amplitudes_deg: list[float | None] = Field(description="mean of the runs, as `orders` has them")
    rest_deg: float | None = Field(description="root mean square of what no order explains")
    rest_hz: float | None = Field(description="the strongest frequency of that")
    runs: int
    lost: int = Field(description="runs in which steps were lost: they are in no figure")
    blind: int = Field(
        default=0,
        description="runs whose samples fell on the same places of each electrical period, where all ripple looks "
        "alike: they are in no figure",
    )


class Crossing(Part):
    """An order that meets the resonance within the speeds."""

    order: int
    speed_rps: Estimate
    peak_deg: float = Field(description="its greatest amplitude there")
    times: float = Field(description="so many times of what it is beside")


class ComparedPoint(Part):
    """A speed without a change and with it, root mean square; the difference is with it less without."""

    speed_rps: float
    before_deg: float
    after_deg: float
    difference_deg: float
    interval_deg: Interval = Field(description="95 % of all speeds together (Bonferroni)")
    told: Told


class Change(Part):
    """What a change makes of the ripple."""

    name: str
    trial: int = Field(description="its number among the trials")
    points: list[ComparedPoint] = Field(default_factory=list)
    lost_rps: list[float] = Field(default_factory=list, description="speeds at which it lost steps")
    resonance_hz: Estimate | None = Field(default=None, description="with it")
    before_deg: float | None = Field(default=None, description="mean of all speeds")
    difference_deg: float | None = Field(default=None, description="of that mean, with it less without")
    interval_deg: Interval | None = None
    p: float | None = Field(default=None, description="of the paired test (Wilcoxon), two-sided")
    quieter: bool | None = None


class ResonanceFound(Part):
    """The map."""

    orders: list[int]
    points: list[MapPoint] = Field(default_factory=list, description="by rising speed")
    resonance_hz: Estimate | None = Field(default=None, description="of small swings of the rotor")
    damping_ratio: Estimate | None = None
    told_by: list[int] = Field(default_factory=list, description="the orders that tell the resonance")
    crossings: list[Crossing] = Field(default_factory=list, description="those that tell it first, then the strongest")
    changes: list[Change] = Field(default_factory=list)
