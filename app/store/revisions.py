"""Documents that people keep by name: a file each in a folder of the data directory, with its last revisions.

What a document says is others' business. Here it is a JSON object with a name; a save says which revision it was made
from, and is refused where another has been saved since.
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
from typing import Any, ClassVar

from ..errors import StoreUnavailable, UnknownThing, UsageError, WrongState
from .document import Document, Entry, UnreadableDocument, writable

log = logging.getLogger("stepscope.store")

KEPT_MAX = 200
"""Documents of a kind."""
REVISIONS_MAX = 20
"""Of one document: the oldest goes first."""
BYTES_MAX = 64 * 1024
"""Of one revision as JSON."""
ID = re.compile("[a-z0-9][a-z0-9-]{0,39}")
NO_ID = re.compile("null|none|nan|undefined|true|false|[0-9]+")
"""What programs write where they have no id: nothing comes to be kept under it by their mistake."""


class RevisionChanged(WrongState):
    """A document has another revision than the one that was to be replaced. `revision` is what it has, 0 for none."""

    kind: ClassVar[str] = "document"

    def __init__(self, name: str, based_on: int, revision: int) -> None:
        kind = self.kind
        has = f"has revision {revision} by now" if revision else "is not there any more"
        super().__init__(
            f"{kind} {name!r} was to be saved over revision {based_on}, and {has}",
            "look at it first, then save over that revision, or save yours under another name",
        )
        self.based_on, self.revision = based_on, revision
        setattr(self, kind, name)  # a fact for clients: by what it is


@dataclass(frozen=True, slots=True)
class Revision:
    """A document as it was saved once."""

    revision: int
    saved_unix_s: float
    document: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Saved:
    """A document with its revisions, the latest last; there is always one."""

    id: str
    revisions: tuple[Revision, ...]

    @property
    def latest(self) -> Revision:
        return self.revisions[-1]


class RevisionStore:
    """One kind's folder. Each save is on disk when it returns. Safe to use from several threads."""

    kind: ClassVar[str]
    """As people say it; the folder is its plural."""
    changed: ClassVar[type[RevisionChanged]]
    """Of a save over another revision; made of the id and of both revisions."""

    def __init__(self, data_dir: Path, unix_s: Callable[[], float] = time.time) -> None:
        self._folder, self._unix_s = data_dir / f"{self.kind}s", unix_s
        self._format = f"stepscope-{self.kind}-revisions"
        self._turn = Document(self._folder / "index")  # its lock alone: which ids there are is decided under it

    def all(self) -> list[Saved]:
        """By id. A file that cannot be read is left out, and stays where it is."""
        try:
            paths = sorted(path for path in self._folder.glob("*.json") if ID.fullmatch(path.stem))
        except OSError as error:
            raise self._unavailable(error) from error
        found = []
        for path in paths[:KEPT_MAX]:
            try:
                found.append(self._saved(path))
            except WrongState as damage:
                log.warning("%s", damage)
        return [saved for saved in found if saved is not None]

    def get(self, name: str) -> Saved:
        """Raises UnknownThing, WrongState for one that is damaged."""
        found = self._saved(self._path(name))
        if found is None:
            raise UnknownThing(self.kind, name, [each.id for each in self.all()])
        return found

    def revision(self, name: str, revision: int | None) -> tuple[Saved, Revision]:
        """A document, and one of its revisions; the latest for None. Raises UnknownThing, WrongState."""
        saved = self.get(name)
        if revision is None:
            return saved, saved.latest
        for each in saved.revisions:
            if each.revision == revision:
                return saved, each
        known = [str(each.revision) for each in reversed(saved.revisions)]
        raise UnknownThing(f"revision of {self.kind} {name!r}", str(revision), known)

    def add(self, document: Mapping[str, Any]) -> Saved:
        """Keep a new document under an id made of its name. Raises UsageError, StoreUnavailable."""
        with self._locked():
            taken = {path.stem for path in self._folder.glob("*.json")}
            plain = re.sub("[^a-z0-9]+", "-", str(document["name"]).casefold())
            base = plain.strip("-")[:34].strip("-") or self.kind
            name = base = f"{self.kind}-{base}"[:34] if NO_ID.fullmatch(base) else base
            number = 2
            while name in taken:
                name, number = f"{base}-{number}", number + 1
            return self._save(name, (), document)

    def put(self, name: str, based_on: int, document: Mapping[str, Any]) -> Saved:
        """Keep a further revision, or the first over revision 0. Raises RevisionChanged, WrongState, UnknownThing."""
        path = self._path(name)
        with self._locked():
            before = self._saved(path)
            if before is None and NO_ID.fullmatch(name):
                raise UnknownThing(self.kind, name, [each.id for each in self.all()])
            revision = before.latest.revision if before else 0
            if revision != based_on:
                raise self.changed(name, based_on, revision)
            return self._save(name, before.revisions if before else (), document)

    def delete(self, name: str) -> None:
        """Forget a document with its revisions. Raises UnknownThing, StoreUnavailable."""
        path = self._path(name)
        with self._locked():
            try:
                path.unlink()
            except FileNotFoundError as error:
                raise UnknownThing(self.kind, name) from error
            except OSError as error:
                raise self._unavailable(error) from error

    def _save(self, name: str, before: tuple[Revision, ...], document: Mapping[str, Any]) -> Saved:
        revision = before[-1].revision + 1 if before else 1
        whole = {**document, "id": name, "revision": revision}
        if not writable(whole) or len(json.dumps(whole).encode()) > BYTES_MAX:
            raise UsageError(f"a {self.kind} is JSON of at most {BYTES_MAX // 1024} kB: leave out a long note, say")
        if not before and len(list(self._folder.glob("*.json"))) >= KEPT_MAX:
            raise UsageError(f"{KEPT_MAX} {self.kind}s are kept already: delete one")
        saved = Saved(name, (*before, Revision(revision, self._unix_s(), whole))[-REVISIONS_MAX:])
        entries: list[Entry] = [
            {"revision": each.revision, "saved_unix_s": each.saved_unix_s, "document": each.document}
            for each in saved.revisions
        ]
        try:
            Document(self._path(name)).write({"format": self._format, "version": 1, "revisions": entries})
        except OSError as error:
            raise self._unavailable(error) from error
        return saved

    def _locked(self) -> AbstractContextManager[None]:
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise self._unavailable(error) from error
        return self._turn.locked()

    def _path(self, name: str) -> Path:
        if not ID.fullmatch(name):
            raise UnknownThing(self.kind, name[:60])
        return self._folder / f"{name}.json"

    def _saved(self, path: Path) -> Saved | None:
        """None where there is no file. Raises WrongState for one that nothing can be read from."""
        try:
            found = Document(path).read()
        except UnreadableDocument as error:
            raise self._damaged(path, str(error)) from error
        if found is None:
            return None
        entries = found.get("revisions")
        if found.get("format") != self._format or found.get("version") != 1 or not isinstance(entries, list):
            raise self._damaged(path, f"its format is {found.get('format')!r}, version {found.get('version')!r}")
        revisions = tuple(revision for entry in entries if (revision := _revision(entry)))
        if not revisions:
            raise self._damaged(path, "it has no revision that can be read")
        return Saved(path.stem, revisions)

    def _damaged(self, path: Path, why: str) -> WrongState:
        return WrongState(f"{self.kind} {path.stem!r} cannot be read: {why}", f"mend or delete {path}")

    def _unavailable(self, error: OSError) -> StoreUnavailable:
        return StoreUnavailable(f"{self.kind}s cannot be kept: {error}", "see to the disk of the data directory")


def _revision(entry: object) -> Revision | None:
    if not isinstance(entry, dict):
        return None
    number, saved, document = entry.get("revision"), entry.get("saved_unix_s"), entry.get("document")
    sound = isinstance(number, int) and isinstance(saved, float | int) and isinstance(document, dict)
    if not sound or not isinstance(document, dict) or not isinstance(document.get("name"), str):
        return None
    return Revision(int(str(number)), float(str(saved)), document)
