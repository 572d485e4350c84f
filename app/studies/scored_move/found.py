"""What a scored move tells: its figures, means over its moves. Null is what could not be told."""

from __future__ import annotations

from pydantic import Field

from ..parts import Interval, Part


class Scored(Part):
    """Figures of one setting. Deviations in full steps of the motor, encoder less position as it was at first."""

    distance: int = Field(description="there, and back again [microsteps]")
    moves: int
    time_s: float | None = Field(description="from the command until the encoder stays in its band [s]")
    interval_s: Interval | None = Field(default=None, description="of that, 95 %; null for fewer than two")
    overshoot_fullsteps: float | None = Field(description="null where a stall ended each move")
    peak_fullsteps: float = Field(description="greatest deviation under way")
    vibration_fullsteps: float | None = Field(
        description="root mean square of the deviation under way, less its mean; null where a stall ended each move"
    )
    rest_fullsteps: float | None = Field(description="the same from the end of the ramp on, until it rested")
    lost_fullsteps: float = Field(description="worst of all moves; multiples of 4 of a whole loss")
    load_min: float | None = Field(
        default=None,
        description="least load value of StallGuard on the middle half of the way; of a move that a stall ended from "
        "there on until it stood, as far as samples show it",
    )
    load_margin: float | None = Field(
        default=None,
        description="how far that is above the load value that is a stall; null where a stall ended a move",
    )
    stalls: int = Field(default=0, description="moves that a stall ended on their way; no further one is made then")
    stalled_at: int | None = Field(default=None, description="where it stood then [microsteps]")
    reached: float = Field(default=1.0, description="least share of the way that a move made: 1 is all of it")
