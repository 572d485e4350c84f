"""The audit log of one device as what people have done to it: entries of one request are one change."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..devices.core.changes import DONE
from ..profiles.earlier import changes_something
from ..store.audit import AuditLog
from ..store.audit_entries import ADDED, WRITTEN, Entry, EntryFilter

LOOKED_THROUGH = 5000
"""Entries of one look: a page of history that would need more is shorter."""


@dataclass(frozen=True, slots=True)
class HistoryChange:
    """What one request did.

    entry : the one that tells it best. first, last : ids of its entries. writes : registers and settings it has written
    """

    entry: Entry
    first: int
    last: int
    writes: int


@dataclass(frozen=True, slots=True)
class ChangePage:
    """Changes, the newest first, and whether there are older ones."""

    changes: Sequence[HistoryChange]
    more: bool


async def changes_of(audit: AuditLog, device: str, limit: int, before: int | None = None) -> ChangePage:
    """The latest changes of a device; with `before` those with lower ids. Raises StoreUnavailable."""
    entries = await audit.search(EntryFilter(device=device), LOOKED_THROUGH, before)
    groups: dict[int, list[Entry]] = {}
    cut_off = len(entries) == LOOKED_THROUGH
    for entry in entries:
        assert entry.id is not None
        groups.setdefault(-entry.id if entry.call is None else entry.call, []).append(entry)
        if entry.action == ADDED and entry.outcome == DONE:  # what is older is of another device of that name
            cut_off = False
            break
    found = [_change(group) for group in groups.values()]
    if cut_off and len(found) > 1:
        found.pop()  # more of it may lie behind what was looked through
    return ChangePage(found[:limit], cut_off or len(found) > limit)


def _change(group: Sequence[Entry]) -> HistoryChange:
    """Of a request's entries, the newest first."""
    writes = [entry for entry in group if changes_something(entry)]
    whole = next((entry for entry in group if entry.action not in (WRITTEN, "edit device")), group[0])
    return HistoryChange(whole, group[-1].id or 0, group[0].id or 0, len(writes))
