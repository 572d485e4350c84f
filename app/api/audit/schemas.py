"""Shapes of the audit log."""

from __future__ import annotations

from datetime import datetime
from typing import Literal

from pydantic import Field

from ..schemas import Answer

Outcome = Literal["done", "not proven", "refused"]


class AuditEntry(Answer):
    """One action of a client, done or refused."""

    id: int = Field(description="grows with time")
    time: datetime
    who: str = Field(description="as people know them; what a request says of itself, so no proof")
    kind: Literal["browser", "client", "server"]
    address: str
    device: str | None
    axis: int | None
    action: str = Field(description="write, move, rotate, stop, add device, lease taken...")
    subject: str = Field(description="what it was done to: a register by its name, a setting...")
    old: int | float | str | None = Field(description="value before; null where there is none or nobody knows")
    new: int | float | str | None
    outcome: str = Field(description="done, not proven or refused; behind a colon why")
    call: int | None = Field(description="what entries of one request have in common; null of those that have none")
    detail: str = Field(description="fields of a register that changed, units, what else was asked for")


class AuditPage(Answer):
    """Entries, the newest first."""

    entries: list[AuditEntry]
    more: bool = Field(description="whether there are older ones: ask again with `before` the last entry's id")


class AuditFilters(Answer):
    """What there is to filter by."""

    devices: list[str]
    who: list[str]
    actions: list[str]
