"""What a study of the closed loop tells: the plant, the loop that was worked out, and what steps showed of it."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ..fitted import Estimate, Ringing
from ..parts import Interval, Part


class LoopCurves(Part):
    """The open loop over frequency."""

    frequency_hz: list[float]
    gain_db: list[float]
    phase_deg: list[float]


class LoopStep(Part):
    """A step: the encoder over the size of the step, as it was measured and as it was expected."""

    time_s: list[float]
    measured: list[float]
    expected: list[float]


class LoopEffect(Part):
    """Settling with the new gains against the old ones, by pairs [s]; differences are new less old."""

    pairs: int
    baseline_s: float
    winner_s: float
    difference_s: float
    interval_s: Interval
    p: float = Field(description="of the paired test (Wilcoxon), two-sided")
    significant: bool


class LoopLoad(Part):
    """Ramps there and back with the new gains: the load is what accelerates."""

    acceleration_pps2: float
    deviation_fullsteps: float = Field(description="of the encoder from the position at the most")
    lost_fullsteps: float


Mark = Literal["good", "fair", "poor"]


class Graded(Part):
    """One thing of a loop, and how good it is."""

    what: str
    figure: str
    mark: Mark


class LoopFound(Part):
    """A position loop and the plant that it is for. Margins are those of the worst plant that the fit leaves open."""

    resonance_hz: Estimate
    damping_ratio: Estimate
    friction_share: Estimate
    delay_s: float = Field(description="of chip, driver and coils, taken as so much [s]")
    ringing: Ringing
    alike: float = Field(description="correlation of what the fit leaves with the next of it; 0 is white noise")
    proportional_per_s: float
    integral_per_s2: float
    gain_margin: float
    phase_margin_deg: float
    bandwidth_hz: float
    open_loop: LoopCurves
    expected_overshoot: float = Field(description="share of a step")
    overshoot: Estimate | None = Field(default=None, description="measured, share of a step")
    settling_s: float | None = Field(default=None, description="mean over the steps [s]")
    step: LoopStep | None = None
    load: LoopLoad | None = Field(default=None, description="null: it was not shown to do as asked by its steps")
    grades: list[Graded] = Field(default_factory=list, description="of each thing that is known")
    grade: Mark | None = Field(default=None, description="the worst of them; null: nothing was shown")
    captures: int = Field(default=0, description="recordings that were made")
    effect: LoopEffect | None = Field(default=None, description="null: nothing regulated before")
