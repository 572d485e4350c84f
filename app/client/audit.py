"""Calls about the audit log, as values, and the record of an entry."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from .calls import BASE, Call
from .records import record


@dataclass(frozen=True, slots=True)
class AuditEntry:
    """One thing that a user did, or was refused."""

    id: int
    time: str
    """ISO 8601, UTC."""
    who: str
    kind: str
    """browser, client or server."""
    address: str
    device: str | None
    axis: int | None
    action: str
    subject: str
    """What it was done to: a register by its name, a setting..."""
    old: int | float | str | None
    new: int | float | str | None
    outcome: str
    """done, not proven or refused; behind a colon why."""
    detail: str
    call: int | None = None
    """What entries of one request have in common."""


def entries(
    text: str, device: str, who: str, action: str, since: datetime | None, limit: int, before: int | None
) -> Call[list[AuditEntry]]:
    given = {"q": text, "device": device, "who": who, "action": action}
    query: dict[str, str | int | list[str]] = {name: value for name, value in given.items() if value}
    query["limit"] = limit
    if since is not None:
        query["since"] = since.astimezone().isoformat()
    if before is not None:
        query["before"] = before
    return Call("GET", f"{BASE}/audit", _entries, query=query)


def _entries(answer: Any) -> list[AuditEntry]:
    return [record(AuditEntry, each) for each in answer["entries"]]
