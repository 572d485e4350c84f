"""Profiles that were kept: rows of the database, each with its document whole."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from ..errors import UnknownThing, WrongState
from .database import Database
from .tables import ProfileRow

log = logging.getLogger("stepscope.store")

KEPT_MAX = 2000
"""Profiles; some 20 MB."""


@dataclass(frozen=True, slots=True)
class SavedProfile:
    """One of them. created_unix_s : when it was kept [s]. version : of the document's format."""

    id: int
    name: str
    model: str
    created_unix_s: float
    note: str
    version: int
    document: dict[str, Any]


class ProfileStore:
    """Everything raises StoreUnavailable where the database is not to be had; nothing blocks the loop."""

    def __init__(self, database: Database, unix_s: Callable[[], float] = time.time) -> None:
        self._database, self._unix_s = database, unix_s

    async def add(self, name: str, note: str, document: dict[str, Any]) -> SavedProfile:
        """Keep a document, whose model and version it bears itself. Raises WrongState where there are too many."""
        now_s = self._unix_s()

        def work(session: Session) -> SavedProfile:
            if (session.scalar(select(func.count()).select_from(ProfileRow)) or 0) >= KEPT_MAX:
                raise WrongState(f"{KEPT_MAX} profiles are kept already", "delete some of them")
            row = ProfileRow(
                name=name,
                model=str(document["model"]),
                created_unix_s=now_s,
                note=note,
                document={**document, "name": name, "note": note},
                version=int(document["version"]),
            )
            session.add(row)
            session.flush()
            return _saved(row)

        return await self._database.write(work)

    async def all(self, search: str = "", model: str = "") -> list[SavedProfile]:
        """Those of `model` (any) that have all words of `search` in name, note, model or device; the latest first."""
        query = select(ProfileRow).order_by(ProfileRow.id.desc())
        if model:
            query = query.where(ProfileRow.model == model)
        words = search.casefold().split()

        def work(session: Session) -> list[SavedProfile]:
            found = []
            for row in session.scalars(query):
                try:
                    found.append(_saved(row))
                except WrongState as damage:  # it alone
                    if str(damage) not in self._database.notes:
                        self._database.notes.append(str(damage))
                        log.warning("%s; %s", damage, damage.way_out)
            return [saved for saved in found if _has(saved, words)]

        return await self._database.read(work)

    async def get(self, profile: int) -> SavedProfile:
        """Raises UnknownThing, WrongState for one that is damaged."""
        return await self._database.read(lambda session: _saved(_row(session, profile)))

    async def edit(self, profile: int, name: str | None = None, note: str | None = None) -> SavedProfile:
        """Another name or note; None leaves as it is. Raises UnknownThing, WrongState for one that is damaged."""

        def work(session: Session) -> SavedProfile:
            row = _row(session, profile)
            document = _saved(row).document
            if name is not None:
                row.name = name
            if note is not None:
                row.note = note
            row.document = {**document, "name": row.name, "note": row.note}
            session.flush()
            return _saved(row)

        return await self._database.write(work)

    async def delete(self, profile: int) -> None:
        """Raises UnknownThing."""
        await self._database.write(lambda session: session.delete(_row(session, profile)))


def _row(session: Session, profile: int) -> ProfileRow:
    row = session.get(ProfileRow, profile) if 0 < profile < 1 << 63 else None
    if row is None:
        raise UnknownThing("profile", str(profile))
    return row


def _saved(row: ProfileRow) -> SavedProfile:
    """Raises WrongState for a row that something else wrote into: a broken disk, most likely."""
    document = row.document
    whole = isinstance(document, dict) and (document.get("name"), document.get("model")) == (row.name, row.model)
    if not whole or not isinstance(row.created_unix_s, float) or not 0 <= row.created_unix_s < 1e11:
        raise WrongState(f"profile {row.id} ({str(row.name)[:60]!r}) is damaged and left out", "delete it")
    return SavedProfile(row.id, row.name, row.model, row.created_unix_s, row.note, row.version, row.document)


def _has(saved: SavedProfile, words: list[str]) -> bool:
    if not words:
        return True
    text = f"{saved.name} {saved.note} {saved.model} {saved.document.get('device', '')}".casefold()
    return all(word in text for word in words)
