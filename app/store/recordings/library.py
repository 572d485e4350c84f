"""All recordings in the data directory: three files each, found again by listing the folder.

`ID.arrows` holds the rows and says what they are of, `ID.marks` what happened, `ID.json` what people call it. A file
that was copied in from another machine is there at the next look; one that cannot be read is listed with the reason.
"""

from __future__ import annotations

import re
import secrets
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from shutil import disk_usage

import numpy as np

from app.links.errors import UnknownThing, UsageError, WrongState
from app.store.document import Document, UnreadableDocument
from app.store.recordings import file, marks
from app.store.recordings.head import Head, UnreadableRecording
from app.store.recordings.opened import Opened, OpenedRecordings

FOLDER = "recordings"
ID = re.compile(r"[0-9]{8}-[0-9]{6}-[0-9a-f]{4}")
NAME_MAX, NOTE_MAX = 100, 4000


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


class Library:
    """The recordings below `data_dir`. `running` are the ids that are being written now, kept by the recorders."""

    def __init__(self, data_dir: Path) -> None:
        self._folder = data_dir / FOLDER
        self.running: set[str] = set()
        self._opened = OpenedRecordings()

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
        self.label(head.id, label)
        self.running.add(head.id)
        return writer

    def ended(self, recording: str) -> None:
        """Nobody writes it any more."""
        self.running.discard(recording)

    def mark(self, recording: str, mark: marks.Mark) -> None:
        """Remember that something happened. Raises UnknownThing, OSError."""
        self._known(recording)
        marks.add(self._folder / f"{recording}{marks.SUFFIX}", mark)

    def entries(self, search: str = "", device: str = "") -> list[Entry]:
        """The latest first. `search` is looked for in name, note, device and model, without regard to case."""
        found = sorted(self._folder.glob(f"*{file.SUFFIX}"), reverse=True) if self._folder.is_dir() else []
        entries = [self._entry(path.stem) for path in found if ID.fullmatch(path.stem)]
        wanted = search.casefold().split()
        return [
            entry
            for entry in entries
            if (not device or (entry.head is not None and entry.head.device == device))
            and all(word in _words(entry) for word in wanted)
        ]

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
        """Call it `label.name` from now on. Raises UnknownThing, UsageError for what is too long."""
        for text, limit in ((label.name, NAME_MAX), (label.note, NOTE_MAX)):
            if len(text) > limit:
                raise UsageError(f"at most {limit} characters, not {len(text)}")
        Document(self._folder / f"{self._known(recording)}.json").write(asdict(label))

    def delete(self, recording: str) -> None:
        """Gone for good. Raises UnknownThing, WrongState while it is being written."""
        if self._known(recording) in self.running:
            raise WrongState(f"recording {recording} is still being written", "stop it first")
        # The rows go first: what else is left is nothing without them, and is not listed.
        for suffix in (file.SUFFIX, marks.SUFFIX, ".json", ".json.lock"):
            (self._folder / f"{recording}{suffix}").unlink(missing_ok=True)
        self._opened.forget(self._rows_of(recording))

    @property
    def free_bytes(self) -> int:
        """Room that is left where recordings go."""
        return disk_usage(next(each for each in (self._folder, *self._folder.parents) if each.exists())).free

    @property
    def size_bytes(self) -> int:
        """Room that all of them take on the disk."""
        return sum(path.stat().st_size for path in self._folder.glob("*")) if self._folder.is_dir() else 0

    def _rows_of(self, recording: str) -> Path:
        return self._folder / f"{recording}{file.SUFFIX}"

    def _known(self, recording: str) -> str:
        # The pattern before the path: an id never leads out of the folder.
        if not ID.fullmatch(recording) or not self._rows_of(recording).is_file():
            raise UnknownThing("recording", recording[:60], [path.stem for path in self._latest(5)])
        return recording

    def _latest(self, count: int) -> Sequence[Path]:
        return sorted(self._folder.glob(f"*{file.SUFFIX}"), reverse=True)[:count] if self._folder.is_dir() else []

    def _entry(self, recording: str) -> Entry:
        head, problem = None, ""
        try:
            head = file.read_head(self._rows_of(recording))
        except (UnreadableRecording, OSError) as error:
            problem = str(error)
        size = sum(path.stat().st_size for path in self._folder.glob(f"{recording}.*"))
        return Entry(recording, self._label(recording), head, size, recording in self.running, problem)

    def _label(self, recording: str) -> Label:
        try:
            found = Document(self._folder / f"{recording}.json").read() or {}
        except UnreadableDocument:
            return Label()
        return Label(str(found.get("name", "")), str(found.get("note", "")))


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


def span_s(rows: file.Rows) -> float:
    """From the first to the last sample [s]."""
    return float(np.ptp(rows.time_s)) if len(rows.time_s) else 0.0
