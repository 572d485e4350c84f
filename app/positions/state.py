"""What the service answers. Plain records; positions are whole microsteps of any size, fractions exact."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal

from .turn import Turn

State = Literal["off", "idle", "moving", "lost"]


@dataclass(frozen=True, slots=True)
class Pieces:
    """How far a move is that the chip makes in pieces of `length` microsteps."""

    total: int
    done: int
    length: int


@dataclass(frozen=True, slots=True)
class TurnState:
    """The turn, where the axis is in it, and the two numbers of the application note (AN-001 3.2)."""

    turn: Turn
    turns: int
    place: Fraction
    angle_deg: float
    encoder_angle_deg: float | None
    displacement_const: Fraction
    offset: Fraction


@dataclass(frozen=True, slots=True)
class CompareState:
    """The compare register, what it is for, and whether it is armed."""

    register: str
    position: int
    armed: bool


@dataclass(frozen=True, slots=True)
class ExtendedState:
    """One axis. Times are device time [s]; None where there is nothing to tell, as of an axis not watched."""

    watching: bool
    counter_bits: int | None
    speed_limit_pps: float
    latch_register: str | None
    state: State = "off"
    trusted: bool = False
    reason: str = ""
    way_out: str = ""
    actual: int | None = None
    target: int | None = None
    message: str = ""
    counter: int | None = None
    pieces: Pieces | None = None
    progress: float | None = None
    encoder_position: int | None = None
    rotary: TurnState | None = None
    compare: CompareState | None = None
    last_look_s: float | None = None
    look_age_s: float | None = None
    service_period_s: float | None = None
    allowed_s: float | None = None
    warnings: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Latched:
    """What the chip kept at an edge of a switch, extended."""

    register: str
    count: int
    position: int


@dataclass(frozen=True, slots=True)
class HistoryState:
    """Polls, oldest first. Angles are of the turn as it is set now [deg]; None where there is none."""

    time_s: list[float]
    position: list[int]
    angle_deg: list[float | None]
    encoder_angle_deg: list[float | None]
