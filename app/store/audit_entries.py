"""Entries of the audit log: what they hold, how they lie in the database, and how they are looked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from typing import cast, get_args

from sqlalchemy import ColumnElement, Select, String, func, select
from sqlalchemy import cast as as_type

from ..devices.core.actor import ActorKind
from ..devices.core.changes import DONE
from .tables import AuditRow, Value

LONG = {"who": 100, "address": 60, "device": 80, "action": 60, "subject": 200, "outcome": 500, "detail": 500}
"""How long each text may be: much of it comes from outside."""


@dataclass(frozen=True, slots=True)
class Entry:
    """One thing that a user did, or was refused.

    at_unix_s : Unix time [s]. action : as people say it, "write", "move", "add device"... subject : what it was done
    to, a register by its name. old, new : values where there are any. outcome : "done", "done: note",
    "not proven: why", "refused: why". id : None before it is in the database. call : what entries of one request have
    in common; None where it belongs to none.
    """

    at_unix_s: float
    who: str
    kind: ActorKind
    address: str
    device: str | None
    axis: int | None
    action: str
    subject: str
    old: Value = None
    new: Value = None
    outcome: str = DONE
    detail: str = ""
    id: int | None = None
    call: int | None = None


@dataclass(frozen=True, slots=True)
class EntryFilter:
    """Which entries: all words of `text` anywhere in them, and each of the others where it is given."""

    text: str = ""
    device: str = ""
    who: str = ""
    action: str = ""
    outcome: str = ""
    """What it begins with: "done", "not proven" or "refused"."""
    since_unix_s: float | None = None
    until_unix_s: float | None = None
    after: int | None = None
    """Only entries with higher ids."""


@dataclass(frozen=True, slots=True)
class Known:
    """What there is to filter by."""

    devices: Sequence[str]
    who: Sequence[str]
    actions: Sequence[str]


def row_of(entry: Entry) -> dict[str, object]:
    """The columns of an entry that is new; long texts end in an ellipsis."""
    row: dict[str, object] = {name: getattr(entry, name) for name in entry.__slots__ if name != "id"}
    for name, length in LONG.items():
        text = row[name]
        if isinstance(text, str):
            whole = text.encode("utf-8", "replace").decode()  # half a character of an address is no text for a database
            row[name] = whole if len(whole) <= length else whole[: length - 1] + "…"
    return row


def entry_of(row: AuditRow) -> Entry:
    """As it was read."""
    return Entry(
        row.at_unix_s,
        row.who,
        cast("ActorKind", row.kind) if row.kind in get_args(ActorKind) else "client",
        row.address,
        row.device,
        row.axis,
        row.action,
        row.subject,
        row.old,
        row.new,
        row.outcome,
        row.detail,
        row.id,
        row.call,
    )


def matching(wanted: EntryFilter) -> Select[AuditRow]:
    """All rows that are wanted, in no order."""
    query = select(AuditRow)
    for column, value in (
        (AuditRow.device, wanted.device),
        (AuditRow.who, wanted.who),
        (AuditRow.action, wanted.action),
    ):
        if value:
            query = query.where(column == value)
    if wanted.outcome:
        query = query.where(AuditRow.outcome.startswith(wanted.outcome, autoescape=True))
    if wanted.since_unix_s is not None:
        query = query.where(AuditRow.at_unix_s >= wanted.since_unix_s)
    if wanted.until_unix_s is not None:
        query = query.where(AuditRow.at_unix_s < wanted.until_unix_s)
    if wanted.after is not None:
        query = query.where(AuditRow.id > wanted.after)
    for word in wanted.text.split():
        query = query.where(_everything().icontains(word, autoescape=True))
    return query


def _everything() -> ColumnElement[str]:
    """All that an entry says, as one text."""
    columns = (
        AuditRow.who,
        AuditRow.address,
        AuditRow.device,
        AuditRow.action,
        AuditRow.subject,
        AuditRow.old,
        AuditRow.new,
        AuditRow.outcome,
        AuditRow.detail,
    )
    texts: list[ColumnElement[str]] = [func.coalesce(as_type(column, String), "") for column in columns]
    return reduce(lambda text, more: text.concat(" ").concat(more), texts)
