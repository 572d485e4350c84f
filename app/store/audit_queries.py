"""How entries of the audit log lie in the database, and how they are looked for: each on a session of the caller's."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from typing import cast, get_args

from sqlalchemy import ColumnElement, Select, String, delete, func, insert, select
from sqlalchemy import cast as as_type
from sqlalchemy.orm import InstrumentedAttribute, Session

from ..devices.core.actor import ActorKind
from .audit_entries import ADDED, WRITTEN, Entry, EntryFilter, Known, row_of
from .tables import AuditRow

REFUSED = "refused%"


class AuditQueries:
    """What is asked of the audit log in the database, on a session of the caller's."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def insert_entries(self, entries: Sequence[Entry], kept: int | None) -> None:
        """New ones; with `kept` only so many of all stay, the oldest go."""
        self._session.execute(insert(AuditRow), [row_of(entry) for entry in entries])
        if kept is not None:
            newest = select(func.max(AuditRow.id)).scalar_subquery()
            self._session.execute(delete(AuditRow).where(AuditRow.id <= newest - kept))

    def search(self, wanted: EntryFilter, limit: int, before: int | None) -> list[Entry]:
        """The latest `limit` that are wanted, newest first; with `before` those with lower ids."""
        query = matching(wanted).order_by(AuditRow.id.desc()).limit(limit)
        if before is not None:
            query = query.where(AuditRow.id < before)
        return [entry_of(row) for row in self._session.scalars(query)]

    def of_device(self, device: str, first: int) -> list[Entry]:
        """All of a device from the id `first` on, the oldest first."""
        query = select(AuditRow).where(AuditRow.device == device, AuditRow.id >= first).order_by(AuditRow.id)
        return [entry_of(row) for row in self._session.scalars(query)]

    def first_of_call(self, call: int) -> int:
        """The lowest id of the entries of a request; 0 where it has none."""
        return self._session.scalar(select(func.min(AuditRow.id)).where(AuditRow.call == call)) or 0

    def last_writes(self, device: str, before: int) -> list[Entry]:
        """Of each register of a device its last write before the id `before`, since the device was added last."""
        earlier = (AuditRow.device == device, AuditRow.id < before)
        added = self._session.scalar(select(func.max(AuditRow.id)).where(*earlier, AuditRow.action == ADDED)) or 0
        last = (
            select(func.max(AuditRow.id))
            .where(*earlier, AuditRow.id > added, AuditRow.action == WRITTEN, AuditRow.outcome.not_like(REFUSED))
            .group_by(AuditRow.subject, AuditRow.axis)
        )
        return [entry_of(row) for row in self._session.scalars(select(AuditRow).where(AuditRow.id.in_(last)))]

    def first_since(self, unix_s: float) -> tuple[int, float | None]:
        """The id that entries since then begin with, and when the log itself begins [s]."""
        since = self._session.scalar(select(func.min(AuditRow.id)).where(AuditRow.at_unix_s >= unix_s))
        newest = self._session.scalar(select(func.max(AuditRow.id))) or 0
        return since or newest + 1, self._session.scalar(select(func.min(AuditRow.at_unix_s)))

    def known(self) -> Known:
        """All names that entries bear."""
        devices = _names(self._session, AuditRow.device)
        return Known(devices, _names(self._session, AuditRow.who), _names(self._session, AuditRow.action))


def _names(session: Session, column: InstrumentedAttribute[str] | InstrumentedAttribute[str | None]) -> list[str]:
    return sorted(name for name in session.scalars(select(column).distinct()) if name)


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
