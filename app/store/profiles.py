"""Profiles that were kept: rows of the database, each with its document whole."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..errors import WrongState
from .database import Database

if TYPE_CHECKING:  # the page is there before the database is: see `database_file`
    from sqlalchemy.orm import Session

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
            from . import profile_rows

            if profile_rows.count(session) >= KEPT_MAX:
                raise WrongState(f"{KEPT_MAX} profiles are kept already", "delete some of them")
            return profile_rows.insert(session, name, note, now_s, document)

        return await self._database.write(work)

    async def all(self, search: str = "", model: str = "") -> list[SavedProfile]:
        """Those of `model` (any) that have all words of `search` in name, note, model or device; the latest first."""
        words = search.casefold().split()

        def work(session: Session) -> list[SavedProfile]:
            from . import profile_rows

            found = []
            for row in profile_rows.latest_first(session, model):
                try:
                    found.append(profile_rows.saved(row))
                except WrongState as damage:  # it alone
                    if str(damage) not in self._database.notes:
                        self._database.notes.append(str(damage))
                        log.warning("%s; %s", damage, damage.way_out)
            return [saved for saved in found if _has(saved, words)]

        return await self._database.read(work)

    async def get(self, profile: int) -> SavedProfile:
        """Raises UnknownThing, WrongState for one that is damaged."""

        def work(session: Session) -> SavedProfile:
            from . import profile_rows

            return profile_rows.saved(profile_rows.find(session, profile))

        return await self._database.read(work)

    async def edit(self, profile: int, name: str | None = None, note: str | None = None) -> SavedProfile:
        """Another name or note; None leaves as it is. Raises UnknownThing, WrongState for one that is damaged."""

        def work(session: Session) -> SavedProfile:
            from . import profile_rows

            return profile_rows.rename(session, profile, name, note)

        return await self._database.write(work)

    async def delete(self, profile: int) -> None:
        """Raises UnknownThing."""

        def work(session: Session) -> None:
            from . import profile_rows

            session.delete(profile_rows.find(session, profile))

        await self._database.write(work)


def _has(saved: SavedProfile, words: list[str]) -> bool:
    if not words:
        return True
    text = f"{saved.name} {saved.note} {saved.model} {saved.document.get('device', '')}".casefold()
    return all(word in text for word in words)
