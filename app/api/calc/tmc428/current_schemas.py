"""Shapes of the current scales of a TMC428: which holds when over a ramp."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ...schemas import Answer, Body, Flag, Number

Code = Annotated[int, Field(strict=True, ge=0, le=7)]


class CurrentScaling(Body):
    """The fields of is_agtat_is_aleat_is_v0_a_threshold, and the move that they are looked at over."""

    is_v0: Code = Field(default=0, description="at rest; eighths of full scale, 0 is 8/8")
    is_aleat: Code = Field(default=0, description="acceleration up to a_threshold")
    is_agtat: Code = Field(default=0, description="acceleration above a_threshold")
    a_threshold: Annotated[int, Field(strict=True, ge=0, le=2047)] = Field(default=0, description="unit of a_max")
    parameters: dict[str, Number | str] = Field(description="of the ramp, as POST /calc/ramp takes them")
    distance: Number = Field(description="microsteps")
    continuous_update: Flag | None = Field(default=None, description="of the global parameters; null: not known")


class CurrentSpan(Answer):
    scale: Literal["is_v0", "is_aleat", "is_agtat"]
    start_s: float
    end_s: float
    eighths: float = Field(description="of full scale; a mean where scales take turns too often to be listed")


class CurrentScalingResult(Answer):
    spans: list[CurrentSpan] = Field(description="without gaps, from before the move to after is_v0 has come back")
    motion_s: float
    rest_delay_s: float = Field(description="from the last step to is_v0: 255 ramp ticks")
    time_s: dict[str, float] = Field(description="time under each scale from the start to is_v0")
    heat: float = Field(description="mean square of the current over that time, as a share of full scale's")
    braking_below: float | None = Field(
        description="share of braking at which is_aleat holds, though the motor brakes; null where nothing brakes"
    )
    warnings: list[str]
