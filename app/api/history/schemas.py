"""Shapes of a device's history, and of what undo puts back."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Literal

from pydantic import AwareDatetime, ConfigDict, Field, model_validator

from ..audit.schemas import AuditEntry
from ..profiles.schemas import ProfileApplied
from ..schemas import Answer, AxisIndex, Body

EntryId = Annotated[int, Field(strict=True, ge=1, lt=1 << 53)]
RegisterLabel = Annotated[str, Field(strict=True, min_length=1, max_length=60)]


class HistoryChange(Answer):
    """What one request did to a device: its entries of the audit log together."""

    entry: AuditEntry = Field(description="the one that tells it best")
    first: int = Field(description="its lowest entry: undo `before` it is undo to there")
    last: int = Field(description="its highest entry")
    writes: int = Field(description="registers and settings that it has written; 0: there is nothing to put back")


class DeviceHistory(Answer):
    """Changes of a device, the newest first."""

    changes: list[HistoryChange]
    more: bool = Field(description="whether there are older ones: ask again with `before` the last one's `first`")


class PlaceIn(Body):
    """A register or setting by its name."""

    name: RegisterLabel
    axis: AxisIndex | None = None


class UndoOrder(Body):
    """To what the device shall be put back: one of `since`, `before` and `without`."""

    model_config = ConfigDict(extra="forbid", json_schema_extra={"examples": [{"without": 1}]})

    since: AwareDatetime | None = Field(default=None, description="as it was at that time, ISO 8601 with its zone")
    before: EntryId | None = Field(default=None, description="as it was before that entry of the audit log")
    without: EntryId | None = Field(default=None, description="without that entry and all others of its request")
    registers: Annotated[list[PlaceIn], Field(max_length=2000)] | None = Field(
        default=None, description="exactly these; null: those that are ready"
    )
    seen: Annotated[int, Field(strict=True, ge=0, lt=1 << 53)] | None = Field(
        default=None, description="`seen` of the preview on which they were chosen: refused if one was written since"
    )

    @model_validator(mode="after")
    def _one_of_them(self) -> UndoOrder:
        if sum(each is not None for each in (self.since, self.before, self.without)) != 1:
            raise ValueError("give exactly one of since, before and without")
        return self


class UndoneRegister(Answer):
    """A register or setting that is not as it was."""

    name: str
    axis: int | None
    kind: Literal["register", "setting"]
    was: int | float | str | None = Field(description="then; null where nobody knows")
    now: int | float | str | None = Field(description="as the device holds it now")
    unit: str
    was_physical: str
    now_physical: str
    state: Literal["ready", "ask", "cannot"] = Field(
        description='"ask": put back only where `registers` name it; "cannot": not at all'
    )
    why: str
    since: list[AuditEntry] = Field(description="writes of others that lie behind what would be undone, or among it")


class NotPutBack(Answer):
    """Entries that nothing puts back, the same things together."""

    action: str
    subject: str
    count: int
    time: datetime = Field(description="of the latest")
    who: str
    why: str


class RegisterPlace(Answer):
    name: str
    axis: int | None


class UndoAnswer(Answer):
    """What differs from then, and what was done about it."""

    state: Literal["dry run", "applied", "unchanged"]
    registers: list[UndoneRegister] = Field(description="in the order in which they are written")
    rest: list[NotPutBack]
    same: int = Field(description="registers of the log that are as they were")
    unseen: list[RegisterPlace] = Field(
        description="configuration of which the log tells nothing: whether it is as it was then nobody knows"
    )
    seen: int = Field(description="the latest entry that this answer knows of")
    applied: ProfileApplied | None = Field(description="what was written and read back; null where nothing was")
