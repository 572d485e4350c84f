"""What a study of StealthChop tells."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ..parts import Interval, PairOrder, Part


class StealthTried(Part):
    """A setting that was tried, and what was seen of it on the wire."""

    offset: int | None = Field(description="PWM_OFS; null: the chip has none")
    gradient: int | None = Field(description="PWM_GRAD; null: the chip has none of that meaning")
    switch_rps: float | None = Field(description="turns a second up to which StealthChop works; null: at every speed")
    on: bool = Field(description="false: SpreadCycle at every speed")
    jolt_fullsteps: float = Field(description="worst swing of encoder less position as one takes over from the other")
    added_share: float | None = Field(
        description="what the regulation had to add to the amplitude or take from it, over the amplitude, root mean "
        "square: how far the current would be off; without regulation, by what it had to in other turns; null: not told"
    )
    amplitude_share: float | None = Field(description="greatest amplitude seen, over the greatest there is")
    lost_fullsteps: float = 0.0
    why: str = ""


class StealthPair(Part):
    """The same run with the setting before and with the new one."""

    baseline_jolt_fullsteps: float
    winner_jolt_fullsteps: float
    baseline_added_share: float | None
    winner_added_share: float | None
    order: PairOrder


class StealthEffect(Part):
    """A figure of the new setting against that of the one before, by pairs. Differences are new less old."""

    name: Literal["jolt", "added"]
    unit: str
    pairs: int
    baseline: float
    winner: float
    difference: float
    interval: Interval = Field(description="of the mean difference, 95 %")
    winner_interval: Interval = Field(description="of the new one's mean, 95 %")
    p: float = Field(description="of the paired test (Wilcoxon), two-sided, for both figures together")
    significant: bool = Field(description="it is less by more than what counts")


class StealthFound(Part):
    """A setting of StealthChop."""

    velocity_max_rps: float
    jolt_max_fullsteps: float
    before: StealthTried | None = None
    calculated: StealthTried | None = Field(default=None, description="from resistance, supply, current and torque")
    offset_auto: int | None = Field(default=None, description="PWM_OFS_AUTO: what the chip has tuned at rest")
    gradient_auto: int | None = Field(default=None, description="PWM_GRAD_AUTO: what it has tuned in motion")
    tried: list[StealthTried] = Field(default_factory=list)
    chosen: StealthTried | None = Field(default=None, description="the one of the proof")
    pairs: list[StealthPair] = Field(default_factory=list)
    effects: list[StealthEffect] = Field(default_factory=list)
