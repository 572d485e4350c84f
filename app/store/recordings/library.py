"""All recordings in the data directory: three files each, found again by listing the folder.

`ID.arrows` holds the rows and says what they are of, `ID.marks` what happened, `ID.json` what people call it. A file
that was copied in from another machine is there at the next look; one that cannot be read is listed with the reason.
"""

from __future__ import annotations

import os
import re
import secrets
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path
from shutil import disk_usage

import numpy as np

from app.links.errors import StoreUnavailable, UnknownThing, UsageError, WrongState
from app.store.document import Document, UnreadableDocument
from app.store.recordings import file, marks
from app.store.recordings.head import Head, UnreadableRecording
from app.store.recordings.opened import Opened, OpenedRecordings

FOLDER = "recordings"
ID = re.compile(r"[0-9]{8}-[0-9]{6}-[0-9a-f]{4}")
NAME_MAX, NOTE_MAX = 100, 4000
LABEL = ".json"
SUFFIXES = (file.SUFFIX, marks.SUFFIX, LABEL, f"{LABEL}.lock")
"""Of all files of a recording; the rows come first."""
SETTLED_NS = 2_000_000_000


@dataclass(frozen=True, slots=True)
class Label:
    """What people call a recording, and what they want to remember of it."""

    name: str = ""
    note: str = ""


@dataclass(frozen=True, slots=True)
class Entry:
    """A recording in the list. `head` is None, and `problem` tells why, where its file cannot be read."""

    id: str
    label: Label
    head: Head | None
    size_bytes: int
    recording: bool
    problem: str = ""


@dataclass(frozen=True, slots=True)
class Page:
    """Some of the list. `next` is the id to go on before, None at the end; `total` counts all that were looked for."""

    entries: list[Entry]
    next: str | None
    total: int


Stamp = tuple[int, int, int]
"""Inode, time of the last change and size of a file: what a reading of it is good for."""


class Library:
    """The recordings below `data_dir`. `running` are the ids that are being written now, kept by the recorders."""

    def __init__(self, data_dir: Path) -> None:
        self._folder = data_dir / FOLDER
        self.running: set[str] = set()
        self._opened = OpenedRecordings()
        self._scanned: tuple[int, dict[str, int]] = (0, {})
        """When the folder was changed last, and the size of each recording then, the latest first."""
        self._entries: dict[str, tuple[Stamp | None, Stamp | None, Entry]] = {}
        """What was read of each, with the stamps of its rows and its label."""
        self._looking = threading.Lock()

    def new_id(self, unix_s: float) -> str:
        """An id that sorts by time and that nobody has."""
        stamp = datetime.fromtimestamp(unix_s, UTC).strftime("%Y%m%d-%H%M%S")
        while True:
            wanted = f"{stamp}-{secrets.token_hex(2)}"
            if not self._rows_of(wanted).exists():
                return wanted

    def begin(self, head: Head, label: Label) -> file.RecordingWriter:
        """A new file for `head.id`, listed as running until `ended`. Raises OSError."""
        self._folder.mkdir(parents=True, exist_ok=True)
        writer = file.RecordingWriter(self._rows_of(head.id), head)
        try:
            self._write_label(head.id, label)
        except BaseException:
            writer.close()
            self._rows_of(head.id).unlink(missing_ok=True)
            raise
        self.running.add(head.id)
        return writer

    def ended(self, recording: str) -> None:
        """Nobody writes it any more."""
        self.running.discard(recording)

    def mark(self, recording: str, mark: marks.Mark) -> None:
        """Remember that something happened. Raises UnknownThing, OSError."""
        self._known(recording)
        marks.add(self._folder / f"{recording}{marks.SUFFIX}", mark)

    def page(self, search: str = "", device: str = "", limit: int | None = None, before: str = "") -> Page:
        """The latest first, `limit` of those that are older than the id `before`.

        `search` is looked for in name, note, device and model, without regard to case. Blocks: the first search reads
        every file, a page without one only its own.
        """
        with self._looking:
            ids = list(self._scan())
            wanted = search.casefold().split()
            if wanted or device:
                ids = [
                    entry.id
                    for entry in map(self._entry, ids)
                    if (not device or (entry.head is not None and entry.head.device == device))
                    and all(word in _words(entry) for word in wanted)
                ]
            older = [each for each in ids if each < before] if before else ids
            shown = older[:limit]
            return Page([self._entry(each) for each in shown], shown[-1] if len(shown) < len(older) else None, len(ids))

    def entry(self, recording: str) -> Entry:
        """Raises UnknownThing."""
        return self._entry(self._known(recording))

    def head(self, recording: str) -> Head:
        """Raises UnknownThing, WrongState for a file that cannot be read."""
        with _readable(recording):
            return file.read_head(self._rows_of(self._known(recording)))

    def rows(self, recording: str) -> file.Rows:
        """All of it, so far. Raises UnknownThing, WrongState."""
        with _readable(recording):
            return file.read_rows(self._rows_of(self._known(recording)))

    def open(self, recording: str) -> Opened:
        """To look at any part of it, as far as it is written now. Raises UnknownThing, WrongState."""
        with _readable(recording):
            return self._opened.get(self._rows_of(self._known(recording)))

    def marks(self, recording: str) -> list[marks.Mark]:
        """Raises UnknownThing."""
        return marks.read(self._folder / f"{self._known(recording)}{marks.SUFFIX}")

    def label(self, recording: str, label: Label) -> None:
        """Call it `label.name` from now on. Raises UnknownThing, UsageError for what is too long, StoreUnavailable."""
        for text, limit in ((label.name, NAME_MAX), (label.note, NOTE_MAX)):
            if len(text) > limit:
                raise UsageError(f"at most {limit} characters, not {len(text)}")
        with _written(f"the name of recording {recording} is not kept"):
            self._write_label(self._known(recording), label)

    def delete(self, recording: str) -> None:
        """Gone for good. Raises UnknownThing, WrongState while it is being written, StoreUnavailable."""
        if self._known(recording) in self.running:
            raise WrongState(f"recording {recording} is still being written", "stop it first")
        # The rows go first: what else is left is nothing without them, and is not listed.
        with _written(f"recording {recording} is not deleted"):
            for suffix in SUFFIXES:
                (self._folder / f"{recording}{suffix}").unlink(missing_ok=True)
        self._opened.forget(self._rows_of(recording))
        self._entries.pop(recording, None)

    @property
    def free_bytes(self) -> int:
        """Room that is left where recordings go."""
        return disk_usage(next(each for each in (self._folder, *self._folder.parents) if each.exists())).free

    @property
    def size_bytes(self) -> int:
        """Room that all of them take on the disk."""
        with self._looking:
            return sum(self._scan().values())

    def _rows_of(self, recording: str) -> Path:
        return self._folder / f"{recording}{file.SUFFIX}"

    def _known(self, recording: str) -> str:
        # The pattern before the path: an id never leads out of the folder.
        if not ID.fullmatch(recording) or not self._rows_of(recording).is_file():
            with self._looking:
                raise UnknownThing("recording", recording[:60], list(islice(self._scan(), 5)))
        return recording

    def _scan(self) -> dict[str, int]:
        """Every recording and its size [bytes], the latest first: one look at the folder, none while it is as it was.

        A file that grows does not change its folder: those that are being written are looked at each time.
        """
        try:
            changed_ns = self._folder.stat().st_mtime_ns
        except OSError:
            return {}
        if self._scanned[0] != changed_ns:
            sizes: dict[str, int] = {}
            names: set[str] = set()
            with os.scandir(self._folder) as found:
                for each in found:
                    recording, dot, suffix = each.name.partition(".")
                    if not ID.fullmatch(recording):
                        continue
                    with suppress(OSError):  # deleted meanwhile
                        sizes[recording] = sizes.get(recording, 0) + each.stat().st_size
                        if f"{dot}{suffix}" == file.SUFFIX:
                            names.add(recording)
            # What changes within the same tick of the file system's clock must not be missed.
            settled = time.time_ns() - changed_ns > SETTLED_NS
            self._scanned = (changed_ns if settled else 0, {name: sizes[name] for name in sorted(names, reverse=True)})
            self._entries = {name: known for name, known in self._entries.items() if name in names}
        sizes = self._scanned[1]
        sizes |= {name: self._size(name) for name in self.running if name in sizes}
        return sizes

    def _size(self, recording: str) -> int:
        stamps = (_stamp(self._folder / f"{recording}{suffix}") for suffix in SUFFIXES)
        return sum(stamp[2] for stamp in stamps if stamp is not None)

    def _entry(self, recording: str) -> Entry:
        rows, label = self._rows_of(recording), self._folder / f"{recording}{LABEL}"
        stamps = _stamp(rows), _stamp(label)
        known = self._entries.get(recording)
        if known is not None and known[:2] == stamps and known[2].recording == (recording in self.running):
            return known[2]
        head, problem = None, ""
        try:
            head = file.read_head(rows)
        except (UnreadableRecording, OSError) as error:
            problem = str(error)
        size = self._size(recording)
        entry = Entry(recording, _label(label), head, size, recording in self.running, problem)
        self._entries[recording] = (*stamps, entry)
        return entry

    def _write_label(self, recording: str, label: Label) -> None:
        Document(self._folder / f"{recording}{LABEL}").write(asdict(label))


def _stamp(path: Path) -> Stamp | None:
    try:
        told = path.stat()
    except OSError:
        return None
    return told.st_ino, told.st_mtime_ns, told.st_size


def _label(path: Path) -> Label:
    try:
        found = Document(path).read() or {}
    except UnreadableDocument:
        return Label()
    name, note = (str(found.get(key, "")).encode(errors="replace").decode() for key in ("name", "note"))
    return Label(name[:NAME_MAX], note[:NOTE_MAX])


def _words(entry: Entry) -> str:
    of = f"{entry.head.device} {entry.head.model}" if entry.head else ""
    return f"{entry.id} {entry.label.name} {entry.label.note} {of}".casefold()


@contextmanager
def _readable(recording: str) -> Iterator[None]:
    """Turns a file that is none into a problem that names the recording."""
    try:
        yield
    except (UnreadableRecording, OSError) as error:
        raise WrongState(f"recording {recording} cannot be read: {error}") from error


@contextmanager
def _written(what: str) -> Iterator[None]:
    """Turns what a disk says that takes nothing into a problem that tells `what` did not happen."""
    try:
        yield
    except OSError as error:
        raise StoreUnavailable(f"{what}: {error}", "make room, or give stepscope a folder that it may write") from error


def span_s(rows: file.Rows) -> float:
    """From the first to the last sample [s]."""
    return float(np.ptp(rows.time_s)) if len(rows.time_s) else 0.0
