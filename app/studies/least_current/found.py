"""What a study of the least current tells."""

from __future__ import annotations

from pydantic import Field

from ..parts import Interval, PairOrder, Part


class CurrentTried(Part):
    """A run current that was tried, and whether its load cycles lost no step."""

    scale: int
    share: float = Field(description="of the current before")
    held: bool
    cycles: int
    speed_times: float = Field(default=1.0, description="so many times the speed of the load cycle")
    deviation_fullsteps: float | None = Field(default=None, description="peak of encoder less position, under way")


class Saving(Part):
    """Heat of both coils while it moves: calculated from the resistance and the current as told, not measured."""

    before_w: float
    after_w: float
    saved_w: float
    interval_w: Interval = Field(description="with the winding between 20 and 80 deg C, and the current within 5 %")


UNIT = 32
"""What SEMIN and SEMAX count the load value in."""


class CoolSetting(Part):
    """What CoolStep works by, as its fields hold it."""

    semin: int
    semax: int
    seup: int
    sedn: int
    seimin: int

    @property
    def upper(self) -> int:
        """From this load value on there is less current."""
        return UNIT * (self.semin + self.semax + 1)

    def but(self, **changes: int) -> CoolSetting:
        """The same but for some fields."""
        return self.model_copy(update=changes)

    def __str__(self) -> str:
        return f"SEMIN {self.semin}, SEMAX {self.semax}, SEUP {self.seup}, SEDN {self.sedn}, SEIMIN {self.seimin}"


class CoolTried(Part):
    """A setting of CoolStep that was tried."""

    setting: CoolSetting
    scale: int = Field(description="run current scale, the most that it goes up to")
    held: bool = Field(description="no step was lost with SEMIN one lower, at the run current less the margin")
    cycles: int = Field(description="of that")
    heat_share: float | None = Field(
        default=None,
        description="of the heat of the coils while it moves, of that with the chosen run current all the time",
    )


class CoolPair(Part):
    """A load cycle without it and one with it: their heat, of that with the chosen run current."""

    without: float
    with_it: float
    order: PairOrder


class CoolStepFound(Part):
    """CoolStep for the load cycle."""

    why: str = Field(default="", description="why there is none; empty where there is, or while it is looked for")
    from_pps: float | None = Field(default=None, description="it works from this speed on")
    scale: int | None = Field(default=None, description="run current scale with it: the most that it goes up to")
    level: int | None = Field(default=None, description="of StallGuard2 (SGT), by which the load value was measured")
    steady: float | None = Field(default=None, description="load value at steady speed: a quarter lies below it")
    loaded: float | None = Field(default=None, description="load value while the speed changes: a quarter is below it")
    tried: list[CoolTried] = Field(default_factory=list)
    setting: CoolSetting | None = Field(default=None, description="the one that was proved")
    cycles: int = Field(default=0, description="of the proof, without a lost step")
    loss_rate_max: float | None = Field(default=None, description="upper bound of the loss rate there, 95 %, exact")
    pairs: list[CoolPair] = Field(default_factory=list)
    saved_share: float | None = Field(default=None, description="less heat by CoolStep while it moves, by the pairs")
    interval_share: Interval | None = Field(default=None, description="of that, 95 %")
    p: float | None = Field(default=None, description="of the paired test (Wilcoxon), two-sided")
    saving: Saving | None = None


class LeastCurrentFound(Part):
    """The least current."""

    scale_before: int
    tried: list[CurrentTried] = Field(default_factory=list)
    edge: int | None = Field(default=None, description="least scale at which no step was lost")
    proved: int | None = Field(default=None, description="scale of the proof: the margin below the chosen one")
    chosen: int | None = None
    cycles: int = Field(default=0, description="of the proof, without a lost step")
    loss_rate_max: float | None = Field(default=None, description="upper bound of the loss rate there, 95 %, exact")
    heat_share: float | None = Field(default=None, description="of the heat of the coils before")
    saving: Saving | None = None
    speed_times: float | None = Field(
        default=None, description="so many times the speed of the load cycle was proved as well; null: not tried"
    )
    limited_by_supply: bool = Field(
        default=False, description="whether more speed alone loses steps, with the current as it was before"
    )
    speed_times_held: float | None = Field(
        default=None, description="then: so many times the speed lost none with the current as it was before"
    )
    coolstep: CoolStepFound | None = Field(default=None, description="null: it was not asked for")
