"""How kept profiles lie in the database: each function on a session of the caller's."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from ..errors import UnknownThing, WrongState
from .profiles import SavedProfile
from .tables import ProfileRow


def count(session: Session) -> int:
    """How many there are."""
    return session.scalar(select(func.count()).select_from(ProfileRow)) or 0


def latest_first(session: Session, model: str) -> Iterable[ProfileRow]:
    """Those of `model`; "" for any."""
    query = select(ProfileRow).order_by(ProfileRow.id.desc())
    return session.scalars(query.where(ProfileRow.model == model) if model else query)


def insert(session: Session, name: str, note: str, created_unix_s: float, document: dict[str, Any]) -> SavedProfile:
    """A new one."""
    row = ProfileRow(
        name=name,
        model=str(document["model"]),
        created_unix_s=created_unix_s,
        note=note,
        document={**document, "name": name, "note": note},
        version=int(document["version"]),
    )
    session.add(row)
    session.flush()
    return saved(row)


def rename(session: Session, profile: int, name: str | None, note: str | None) -> SavedProfile:
    """Another name or note; None leaves as it is. Raises UnknownThing, WrongState for one that is damaged."""
    row = find(session, profile)
    document = saved(row).document
    if name is not None:
        row.name = name
    if note is not None:
        row.note = note
    row.document = {**document, "name": row.name, "note": row.note}
    session.flush()
    return saved(row)


def find(session: Session, profile: int) -> ProfileRow:
    """The row of that id. Raises UnknownThing."""
    row = session.get(ProfileRow, profile) if 0 < profile < 1 << 63 else None
    if row is None:
        raise UnknownThing("profile", str(profile))
    return row


def saved(row: ProfileRow) -> SavedProfile:
    """As it was read. Raises WrongState for a row that something else wrote into: a broken disk, most likely."""
    document = row.document
    whole = isinstance(document, dict) and (document.get("name"), document.get("model")) == (row.name, row.model)
    if not whole or not isinstance(row.created_unix_s, float) or not 0 <= row.created_unix_s < 1e11:
        raise WrongState(f"profile {row.id} ({str(row.name)[:60]!r}) is damaged and left out", "delete it")
    return SavedProfile(row.id, row.name, row.model, row.created_unix_s, row.note, row.version, row.document)
