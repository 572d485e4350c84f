"""Shapes of a chip's events: edges of its flags, as a timeline that forgets nothing it was told."""

from __future__ import annotations

from pydantic import Field

from ..schemas import Answer


class AxisEvent(Answer):
    """What was new at one look: events since the look before, as far as it had been read then."""

    seq: int = Field(description="counts on by one; a page asks with the highest it has")
    time_s: float = Field(description="device time of the look that saw it [s]")
    unix_s: float = Field(description="Unix time [s]")
    names: list[str] = Field(description="of the bits of EVENTS, e.g. TARGET_REACHED, STOPL_EVENT")


class AxisEvents(Answer):
    """A stretch of the timeline, oldest first."""

    events: list[AxisEvent]
    next: int = Field(description="`after` of the next call")
    lost: int = Field(description="entries behind `after` that are not kept any more")
