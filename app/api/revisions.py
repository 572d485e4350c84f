"""What documents that are kept with revisions have in common over REST: layouts and macros."""

from __future__ import annotations

from typing import Annotated, TypedDict

from fastapi import Path, Query
from pydantic import Field

from ..store.revisions import Revision, Saved
from .schemas import Answer, Body

ID_PATTERN = "^[a-z0-9][a-z0-9-]*$"
ID_MAX = 40
KeptId = Annotated[str, Path(description="as in the list", min_length=1, max_length=ID_MAX, pattern=ID_PATTERN)]
RevisionNumber = Annotated[int | None, Query(ge=1, le=1 << 53, description="an earlier one; the latest without")]


class SavedRevision(Answer):
    """When a document was saved."""

    revision: int
    saved_unix_s: float


class BasedOn(Body):
    """A document to be kept over a revision of it."""

    based_on: Annotated[int, Field(strict=True, ge=0, le=1 << 53)] = Field(
        description="the revision that this one was made from; 0 where there was none"
    )


class _Told(TypedDict):
    id: str
    revision: int
    saved_unix_s: float


def told(saved: Saved, of: Revision | None = None) -> _Told:
    """Its id, and which revision it is of; the latest by default."""
    shown = of or saved.latest
    return {"id": saved.id, "revision": shown.revision, "saved_unix_s": shown.saved_unix_s}


def revisions_of(saved: Saved) -> list[SavedRevision]:
    """Those that are still there, the latest first."""
    return [SavedRevision(revision=each.revision, saved_unix_s=each.saved_unix_s) for each in reversed(saved.revisions)]
