"""Layouts of the page's panels: a file each in the folder `layouts` of the data directory, with its last revisions.

What a layout says is the page's own business. Here it is a JSON object with a name; a save says which revision it
was made from, and is refused where another has been saved since.
"""

from __future__ import annotations

import json
import logging
import re
import time
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..errors import StoreUnavailable, UnknownThing, UsageError, WrongState
from .document import Document, Entry, UnreadableDocument, writable

log = logging.getLogger("stepscope.store")

FOLDER = "layouts"
FORMAT = "stepscope-layout-revisions"
KEPT_MAX = 200
"""Layouts."""
REVISIONS_MAX = 20
"""Of one layout: the oldest goes first."""
BYTES_MAX = 64 * 1024
"""Of one revision as JSON."""
ID = re.compile("[a-z0-9][a-z0-9-]{0,39}")


class LayoutChanged(WrongState):
    """A layout has another revision than the one that was to be replaced. `revision` is what it has, 0 for none."""

    def __init__(self, layout: str, based_on: int, revision: int) -> None:
        has = f"has revision {revision} by now" if revision else "is not there any more"
        super().__init__(
            f"layout {layout!r} was to be saved over revision {based_on}, and {has}",
            "look at it first, then save over that revision, or save yours under another name",
        )
        self.layout, self.based_on, self.revision = layout, based_on, revision


@dataclass(frozen=True, slots=True)
class Revision:
    """A layout as it was saved once."""

    revision: int
    saved_unix_s: float
    document: dict[str, Any]


@dataclass(frozen=True, slots=True)
class SavedLayout:
    """A layout with its revisions, the latest last; there is always one."""

    id: str
    revisions: tuple[Revision, ...]

    @property
    def latest(self) -> Revision:
        return self.revisions[-1]


class LayoutStore:
    """The folder. Each save is on disk when it returns. Safe to use from several threads."""

    def __init__(self, data_dir: Path, unix_s: Callable[[], float] = time.time) -> None:
        self._folder, self._unix_s = data_dir / FOLDER, unix_s
        self._turn = Document(self._folder / "index")  # its lock alone: which ids there are is decided under it

    def all(self) -> list[SavedLayout]:
        """By id. A file that cannot be read is left out, and stays where it is."""
        try:
            paths = sorted(path for path in self._folder.glob("*.json") if ID.fullmatch(path.stem))
        except OSError as error:
            raise _unavailable(error) from error
        found = []
        for path in paths[:KEPT_MAX]:
            try:
                found.append(_layout(path))
            except WrongState as damage:
                log.warning("%s", damage)
        return [layout for layout in found if layout is not None]

    def get(self, layout: str) -> SavedLayout:
        """Raises UnknownThing, WrongState for one that is damaged."""
        found = _layout(self._path(layout))
        if found is None:
            raise UnknownThing("layout", layout, [each.id for each in self.all()])
        return found

    def add(self, document: Mapping[str, Any]) -> SavedLayout:
        """Keep a new layout under an id made of its name. Raises UsageError, StoreUnavailable."""
        with self._locked():
            taken = {path.stem for path in self._folder.glob("*.json")}
            base = re.sub("[^a-z0-9]+", "-", str(document["name"]).casefold()).strip("-")[:34].strip("-") or "layout"
            layout, number = base, 2
            while layout in taken:
                layout, number = f"{base}-{number}", number + 1
            return self._save(layout, (), document)

    def put(self, layout: str, based_on: int, document: Mapping[str, Any]) -> SavedLayout:
        """Keep a further revision of a layout, or its first over revision 0. Raises LayoutChanged, WrongState."""
        path = self._path(layout)
        with self._locked():
            before = _layout(path)
            revision = before.latest.revision if before else 0
            if revision != based_on:
                raise LayoutChanged(layout, based_on, revision)
            return self._save(layout, before.revisions if before else (), document)

    def delete(self, layout: str) -> None:
        """Forget a layout with its revisions. Raises UnknownThing, StoreUnavailable."""
        path = self._path(layout)
        with self._locked():
            try:
                path.unlink()
            except FileNotFoundError as error:
                raise UnknownThing("layout", layout) from error
            except OSError as error:
                raise _unavailable(error) from error

    def _save(self, layout: str, before: tuple[Revision, ...], document: Mapping[str, Any]) -> SavedLayout:
        revision = before[-1].revision + 1 if before else 1
        whole = {**document, "id": layout, "revision": revision}
        if not writable(whole) or len(json.dumps(whole).encode()) > BYTES_MAX:
            raise UsageError(f"a layout is JSON of at most {BYTES_MAX // 1024} kB: leave out a long note, say")
        if not before and len(list(self._folder.glob("*.json"))) >= KEPT_MAX:
            raise UsageError(f"{KEPT_MAX} layouts are kept already: delete one")
        saved = SavedLayout(layout, (*before, Revision(revision, self._unix_s(), whole))[-REVISIONS_MAX:])
        entries: list[Entry] = [
            {"revision": each.revision, "saved_unix_s": each.saved_unix_s, "document": each.document}
            for each in saved.revisions
        ]
        try:
            Document(self._path(layout)).write({"format": FORMAT, "version": 1, "revisions": entries})
        except OSError as error:
            raise _unavailable(error) from error
        return saved

    def _locked(self) -> AbstractContextManager[None]:
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise _unavailable(error) from error
        return self._turn.locked()

    def _path(self, layout: str) -> Path:
        if not ID.fullmatch(layout):
            raise UnknownThing("layout", layout[:60])
        return self._folder / f"{layout}.json"


def _layout(path: Path) -> SavedLayout | None:
    """None where there is no file. Raises WrongState for one that no layout can be read from."""
    try:
        found = Document(path).read()
    except UnreadableDocument as error:
        raise _damaged(path, str(error)) from error
    if found is None:
        return None
    entries = found.get("revisions")
    if found.get("format") != FORMAT or found.get("version") != 1 or not isinstance(entries, list):
        raise _damaged(path, f"its format is {found.get('format')!r}, version {found.get('version')!r}")
    revisions = tuple(revision for entry in entries if (revision := _revision(entry)))
    if not revisions:
        raise _damaged(path, "it has no revision that can be read")
    return SavedLayout(path.stem, revisions)


def _revision(entry: object) -> Revision | None:
    if not isinstance(entry, dict):
        return None
    number, saved, document = entry.get("revision"), entry.get("saved_unix_s"), entry.get("document")
    sound = isinstance(number, int) and isinstance(saved, float | int) and isinstance(document, dict)
    if not sound or not isinstance(document, dict) or not isinstance(document.get("name"), str):
        return None
    return Revision(int(str(number)), float(str(saved)), document)


def _damaged(path: Path, why: str) -> WrongState:
    return WrongState(f"layout {path.stem!r} cannot be read: {why}", f"mend or delete {path}")


def _unavailable(error: OSError) -> StoreUnavailable:
    return StoreUnavailable(f"layouts cannot be kept: {error}", "see to the disk of the data directory")
