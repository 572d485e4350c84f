"""What a study of the least current tells."""

from __future__ import annotations

from pydantic import Field

from ..parts import Interval, Part


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
