"""Where a move waits, judged and ready, until those of other devices are too, so that all start together.

Nothing that moves a motor is sent before. Whoever lets several devices start sets a gate in the context in which it
calls their moves; without one nobody waits.
"""

from __future__ import annotations

from contextvars import ContextVar
from typing import Protocol


class StartGate(Protocol):
    """One for each device that takes part."""

    async def ready(self) -> None:
        """Return when all are ready. Raises WrongState where they will not be; then nothing may be sent."""
        ...


start_gate: ContextVar[StartGate | None] = ContextVar("start_gate", default=None)


async def ready_to_start() -> None:
    """Wait for the others; called by drivers with everything judged, before the first write that a move makes."""
    gate = start_gate.get()
    if gate is not None:
        await gate.ready()
