"""The audit log as CSV, piece by piece: it may be long."""

from __future__ import annotations

import csv
import io
from collections.abc import AsyncIterator, Sequence
from datetime import UTC, datetime

from ..store.audit import AuditLog
from ..store.audit_entries import Entry, EntryFilter

COLUMNS = (
    *("id", "time", "who", "kind", "address", "device", "axis"),
    *("action", "subject", "old", "new", "outcome", "detail"),
)
PIECE = 2000
"""Entries of one look into the database."""
FORMULA = ("=", "+", "-", "@", "\t", "\r")


async def csv_pieces(audit: AuditLog, wanted: EntryFilter, first: Sequence[Entry]) -> AsyncIterator[str]:
    """All entries that are wanted, `first` and those behind it, newest first."""
    yield _lines([COLUMNS])
    entries: Sequence[Entry] = first
    while entries:
        yield _lines([_cells(entry) for entry in entries])
        if len(entries) < PIECE:
            return
        entries = await audit.search(wanted, PIECE, entries[-1].id)


def time_of(entry: Entry) -> datetime:
    """When it was, in UTC."""
    return datetime.fromtimestamp(entry.at_unix_s, UTC)


def _cells(entry: Entry) -> list[object]:
    given = {name: getattr(entry, name, None) for name in COLUMNS} | {"time": time_of(entry).isoformat()}
    return [_plain(value) for value in given.values()]


def _plain(value: object) -> object:
    # A text that a spreadsheet takes for a formula would be run by whoever opens the file.
    return f"'{value}" if isinstance(value, str) and value.startswith(FORMULA) else value


def _lines(rows: Sequence[Sequence[object]]) -> str:
    text = io.StringIO()
    csv.writer(text).writerows(rows)
    return text.getvalue()
