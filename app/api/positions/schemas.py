"""Shapes of extended positions: an axis beyond its counter's range, and one that turns for ever.

Positions have 64 bits and a browser's numbers end at 2^53, so each is also told as text, and may come in as text.
"""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, StringConstraints, model_validator

from ...calc.positions.extended import LIMIT
from ..schemas import Answer, Body, Number

Position64 = Annotated[
    Annotated[int, Field(strict=True, ge=-LIMIT, lt=LIMIT)]
    | Annotated[str, StringConstraints(strict=True, pattern=r"^-?[0-9]{1,19}$")],
    Field(description="microsteps, within 64 bits; as text where a client's numbers end earlier"),
]
FractionText = Annotated[str, StringConstraints(strict=True, pattern=r"^[0-9]{1,20}(/[0-9]{1,20})?$")]
Microsteps = Annotated[int, Field(strict=True, ge=1, le=1 << 40)] | FractionText
Teeth = Annotated[int, Field(strict=True, ge=1, le=1_000_000)]
Way = Literal["shortest", "positive", "negative"]


class Gear(Body):
    """A turn of the driven shaft is `microsteps_per_motor_turn` times `driven_teeth` / `motor_teeth`, exactly."""

    microsteps_per_motor_turn: Annotated[int, Field(strict=True, ge=1, le=1 << 40)]
    motor_teeth: Teeth
    driven_teeth: Teeth


class ExtendedPositionChange(Body):
    """Exactly one thing; `way` goes with `angle_deg` and `place`. All but `confirm` and `zero` begin to watch."""

    watch: Literal[True] | None = Field(default=None, description="begin, at what the counter shows; else no change")
    target: Position64 | None = Field(default=None, description="go there, in as many pieces as it takes")
    actual: Position64 | None = Field(
        default=None, description="the axis is here: sets the position anew, and makes it trusted. Writes no register"
    )
    confirm: Literal[True] | None = Field(default=None, description="what `actual` shows is right: trust it again")
    microsteps_per_turn: Microsteps | None = Field(
        default=None, description='a turn of the axis, e.g. 51200 or "358400/3"; null: it is no rotary axis any more'
    )
    gear: Gear | None = None
    zero: Position64 | None = Field(default=None, description="the position that is angle 0")
    angle_deg: Number | None = Field(default=None, description="go to this angle within the turn")
    place: Annotated[int, Field(strict=True)] | FractionText | None = Field(
        default=None, description="go to this place within the turn [microsteps]"
    )
    way: Way = "shortest"
    turns: Annotated[int, Field(strict=True, ge=-(1 << 53), le=1 << 53)] | None = Field(
        default=None, description="go so many whole turns on, negative ones back, to the same place within the turn"
    )
    compare: Position64 | None = Field(
        default=None,
        description="the position that the chip's compare register shall tell of; null: none, and the register is let"
        " alone",
    )

    @model_validator(mode="after")
    def _one_thing(self) -> Self:
        given = sorted(self.model_fields_set - {"way"})
        if len(given) != 1:
            raise ValueError(f"exactly one thing at a time, not {', '.join(given) or 'nothing'}")
        nullable = {"microsteps_per_turn", "compare"}
        if given[0] not in nullable and getattr(self, given[0]) is None:
            raise ValueError(f"{given[0]} is null")
        if "way" in self.model_fields_set and given[0] not in ("angle_deg", "place"):
            raise ValueError("way goes with angle_deg and place")
        return self


class Pieces(Answer):
    """How far a move is that the chip makes in pieces."""

    total: int = Field(description="pieces of the whole way")
    done: int
    length: int = Field(description="of one: a quarter of the counter's range [microsteps]")


class RotaryOut(Answer):
    """The turn, and what the application note (AN-001 3.2) calls its two numbers."""

    microsteps_per_turn: str = Field(description='exact, "n" or "n/d"')
    microsteps_per_turn_value: float
    gear: Gear | None = Field(description="as it was given; null where the turn was given by itself")
    zero: int
    zero_text: str
    displacement_const: str = Field(description="what a wrap of the counter adds to the place within the turn, exact")
    offset: str = Field(description="what all wraps up to now have added, modulo a turn, exact")


class CompareOut(Answer):
    register_name: str
    position: int
    position_text: str
    armed: bool = Field(
        description="false while the axis is further than a piece away: the counter would show the same number before"
    )


class ExtendedPosition(Answer):
    """Where an axis is, beyond its counter. Of an axis that is not watched all is null but what the chip can."""

    watching: bool
    trusted: bool = Field(description="false: `actual` is the best guess, and `reason` says why it is no more")
    reason: str = Field(description='why it is not trusted; "" where it is')
    way_out: str = Field(description='what to do about that; "" where there is nothing to do')
    actual: int | None
    actual_text: str | None
    target: int | None = Field(description="of the move under way, or the latest; null where there was none")
    target_text: str | None
    state: Literal["off", "idle", "moving", "lost"]
    message: str = Field(description='how the latest move ended, or ""')
    counter: int | None = Field(description="what the chip's counter showed at the latest look")
    counter_bits: int | None = Field(description="null: it wraps elsewhere as it is set, and cannot be followed")
    pieces: Pieces | None
    progress: float | None = Field(description="of the move under way, or the latest, 0..1")
    position_in_turn: float | None
    position_in_turn_text: str | None = Field(description='exact, "n" or "n/d"')
    turns: int | None = Field(description="whole turns; below zero they count down")
    angle_deg: float | None
    encoder_position: int | None = Field(description="where the encoder says it is, beyond its own counter")
    encoder_position_text: str | None
    encoder_angle_deg: float | None
    rotary: RotaryOut | None
    compare: CompareOut | None
    latch_register: str | None
    last_look_s: float | None = Field(description="device time [s]")
    look_age_s: float | None
    device_time_s: float = Field(description="now, on the clock of `last_look_s` and of the history [s]")
    service_period_s: float | None = Field(description="how often it is looked at, at the least, device time [s]")
    allowed_s: float | None = Field(description="after so long without a look the position would be lost [s]")
    speed_limit_pps: float = Field(description="what the chip can at most do, of which the two follow")
    warnings: list[str]


class LatchedPosition(Answer):
    """What the chip kept at an edge of a switch, extended."""

    register_name: str
    count: int
    position: int
    position_text: str


class ExtendedHistory(Answer):
    """Looks, oldest first; where nothing changed only the first and the last of them. Old ones are thinned out."""

    time_s: list[float] = Field(description="device time [s]")
    position: list[int]
    position_text: list[str]
    angle_deg: list[float | None] = Field(description="null while the axis is not rotary")
    encoder_angle_deg: list[float | None] = Field(description="null where the encoder was not read along")
