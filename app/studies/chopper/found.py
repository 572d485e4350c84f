"""What a study of the chopper tells."""

from __future__ import annotations

from pydantic import Field

from ..parts import Interval, PairOrder, Part


class ChopperTried(Part):
    """A setting that was tried, and how much the shaft shook by it."""

    off: int = Field(description="TOFF")
    blank: int = Field(description="TBL")
    hysteresis: int = Field(description="effective, at its start: HSTRT + 1 + HEND - 3")
    ripple_fullsteps: float = Field(description="geometric mean over all speeds [full steps]")
    by_speed_fullsteps: list[float] = Field(description="at each speed: encoder less position, root mean square")
    chopper_hz: float = Field(description="at rest and the current's peak, estimated [Hz]")
    why: str = ""


class RipplePair(Part):
    """The same runs with the setting before and with the new one [full steps]."""

    baseline_fullsteps: float
    winner_fullsteps: float
    order: PairOrder


class RippleEffect(Part):
    """The new setting against the one before, by pairs. Differences are new less old [full steps]."""

    pairs: int
    baseline_fullsteps: float
    winner_fullsteps: float
    difference_fullsteps: float
    interval_fullsteps: Interval = Field(description="of the mean difference, 95 %")
    p: float = Field(description="of the paired test (Wilcoxon), two-sided")
    significant: bool


class ChopperFound(Part):
    """A chopper."""

    speeds_rps: list[float] = Field(description="turns of the motor a second")
    before: ChopperTried | None = None
    calculated: ChopperTried | None = Field(default=None, description="from resistance, inductance, current and supply")
    tried: list[ChopperTried] = Field(default_factory=list)
    chosen: ChopperTried | None = Field(default=None, description="the one of the proof")
    pairs: list[RipplePair] = Field(default_factory=list)
    effect: RippleEffect | None = None
