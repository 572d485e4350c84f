"""What only some devices can, as dependencies of routes. Where a device cannot, the route answers 409 and a way out."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import Annotated, TypeVar

from fastapi import Depends

from ..devices.core.capabilities import (
    EventLog,
    LatchedFlags,
    ParameterStore,
    PositionFromEncoder,
    ProgramMemory,
    TmclCommands,
)
from .deps import CurrentDevice

P = TypeVar("P")


def _needed(kind: type[P]) -> Callable[[CurrentDevice], Awaitable[P]]:
    async def part(device: CurrentDevice) -> P:
        return device.need(kind)

    return part


CurrentEventLog = Annotated[EventLog, Depends(_needed(EventLog))]
CurrentTmcl = Annotated[TmclCommands, Depends(_needed(TmclCommands))]
CurrentProgram = Annotated[ProgramMemory, Depends(_needed(ProgramMemory))]
CurrentStore = Annotated[ParameterStore, Depends(_needed(ParameterStore))]
CurrentEncoderPosition = Annotated[PositionFromEncoder, Depends(_needed(PositionFromEncoder))]
CurrentLatchedFlags = Annotated[LatchedFlags, Depends(_needed(LatchedFlags))]
