"""What a device tells its listeners, and who is commanding while it does."""

from __future__ import annotations

from collections.abc import Mapping
from contextvars import ContextVar
from dataclasses import dataclass, field

from ...errors import BenchError
from .changes import RegisterChanged
from .counter import CounterWritten, PositionSeen
from .results import ChipEvents, DeviceState, MotionEnd, ProgramEvent


@dataclass(frozen=True, slots=True)
class StateChanged:
    """The connection's state is another one now."""

    state: DeviceState
    problem: BenchError | None


@dataclass(frozen=True, slots=True)
class MotionStarted:
    """An axis was sent somewhere: what a trigger waits for."""

    axis: int
    started_at_s: float


@dataclass(frozen=True, slots=True)
class MotionCommanded:
    """Something went to the chip that may move or stop an axis. `by` is what `motion_owner` held then.

    asked : by what it can be done again, empty where that is not known: `target` [microsteps] of a move; `velocity` in
        chip units of a rotation; `mode` of a stop; `position` [microsteps] that a place is called from now on
    """

    axis: int
    what: str
    by: object
    asked: Mapping[str, int | str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class LimitReached:
    """An axis was stopped before it would have left its range: which end of it, and where it was then [microsteps]."""

    axis: int
    name: str
    limit: int
    position: int


DeviceEvent = (
    StateChanged
    | LimitReached
    | MotionStarted
    | MotionCommanded
    | MotionEnd
    | ChipEvents
    | ProgramEvent
    | PositionSeen
    | CounterWritten
    | RegisterChanged
)

motion_owner: ContextVar[object] = ContextVar("motion_owner", default=None)
"""Who commands in this task: how a procedure tells its own commands from everybody else's."""
