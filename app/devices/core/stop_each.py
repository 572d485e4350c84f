"""Stops one axis after another: what the families have in common whose chips need no other order."""

from __future__ import annotations

import time
from collections.abc import Awaitable, Callable, Sequence

from ...errors import BenchError
from .results import StopMode, StopOutcome
from .session import Session


async def stop_each(
    session: Session, axes: Sequence[int], mode: StopMode, stop: Callable[[int], Awaitable[BenchError | None]]
) -> list[StopOutcome]:
    """Stop `axes` by `stop`, which has a turn of its own for the axis that it is given, and says what went wrong."""
    began_s = time.perf_counter()
    for axis in axes:
        session.stops[axis] += 1  # before anything waits: what is under way for these axes gives up
        session.commanded(axis, "stop", mode=mode)
    outcomes = []
    for axis in axes:
        problem = await stop(axis)
        took_ms = (time.perf_counter() - began_s) * 1e3
        outcomes.append(StopOutcome(session.id, axis, problem is None, took_ms, problem))
    return outcomes
