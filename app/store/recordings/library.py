"""All recordings in the data directory: three files each, found again by listing the folder.

`ID.arrows` holds the rows and says what they are of, `ID.marks` what happened, `ID.json` what people call it. A file
that was copied in from another machine is there at the next look; one that cannot be read is listed with the reason.
"""

from __future__ import annotations

import math
import os
import re
import secrets
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from shutil import disk_usage

from ...calc.signals.instrument_csv import InstrumentTable
from ...errors import StoreUnavailable, UnknownThing, UsageError, WrongState
from ..document import Document, UnreadableDocument
from . import added as beside
from . import file, marks
from .head import Column, Head, UnreadableRecording
from .notebook import Cell, Notebook, notebook_of
from .opened import Opened, OpenedRecordings

FOLDER = "recordings"
ID = re.compile(r"[0-9]{8}-[0-9]{6}-[0-9a-f]{4}")
NAME_MAX, NOTE_MAX = 100, 4000
TAGS_MAX, TAG_MAX = 12, 40
LABEL = ".json"
NOTEBOOK = ".notebook.json"
SUFFIXES = (file.SUFFIX, marks.SUFFIX, LABEL, f"{LABEL}.lock", NOTEBOOK, f"{NOTEBOOK}.lock", *beside.SUFFIXES)
"""Of all files of a recording; the rows come first."""
SETTLED_NS, SETTLED_COARSE_NS = 100_000_000, 2_000_000_000
"""How long after a change another one would bear another time: of file systems that keep parts of a millisecond, and of
others, where FAT counts in steps of 2 s."""
WEIGHED_AT_ONCE = 200
"""Recordings whose files one answer looks at for the sum of their sizes: some 5 ms."""
READ_PAUSE_S = 0.002
"""Between two files that are read ahead [s]: the server has better things to do."""


@dataclass(frozen=True, slots=True)
class Label:
    """What people call a recording, and what they want to remember of it."""

    name: str = ""
    note: str = ""
    tags: tuple[str, ...] = ()
    colour: str = ""
    """The one that it has in lists and comparisons, by name; "": the one of its place."""


@dataclass(frozen=True, slots=True)
class Summary:
    """What the list tells of a head: ten thousand of them whole would take half a gigabyte."""

    device: str
    model: str
    columns: tuple[Column, ...]
    rate_hz: float
    started_unix_s: float

    @classmethod
    def of(cls, head: Head) -> Summary:
        return cls(head.device, head.model, head.columns, head.rate_hz, head.started_unix_s)


@dataclass(frozen=True, slots=True)
class Entry:
    """A recording in the list. `head` is None, and `problem` tells why, where its file cannot be read."""

    id: str
    label: Label
    head: Summary | None
    size_bytes: int
    recording: bool
    problem: str = ""


@dataclass(frozen=True, slots=True)
class Page:
    """Some of the list. `next` is the id to go on before, None at the end; `total` counts all that were found so far.

    unread : recordings that a search could not look into yet; 0 without a search
    size_bytes : of all recordings, found or not, as in `Library.size_bytes`
    """

    entries: list[Entry]
    next: str | None
    total: int
    unread: int
    size_bytes: int | None


Stamp = tuple[int, int, int]
"""Inode, time of the last change and size of a file: what a reading of it is good for."""


@dataclass(frozen=True, slots=True)
class _Known:
    """What was read of a recording, what is searched in it, and the stamps of its rows and its label then."""

    rows: Stamp | None
    label: Stamp | None
    entry: Entry
    words: str


class Library:
    """The recordings below `data_dir`. `running` are the ids that are being written now, kept by the recorders.

    For many threads: the names in the folder and the sizes are behind a lock, what was read of a file is not.
    """

    def __init__(self, data_dir: Path) -> None:
        self._folder = data_dir / FOLDER
        self.running: set[str] = set()
        self._opened = OpenedRecordings()
        self._scanned_ns = 0
        """When the folder was changed last, as the latest scan found it."""
        self._seen: set[str] = set()
        """Names of everything in the folder, ours or not."""
        self._sizes: dict[str, int] = {}
        """Of each id what its files take [bytes]; of those without rows, too."""
        self._total_bytes = 0
        """The sum of these."""
        self._with_rows: set[str] = set()
        self._ids: list[str] = []
        """Of those with rows, the latest first."""
        self._changed: set[str] = set()
        """Ids whose files have other sizes now. Filled by anybody; whoever wants the sum weighs them."""
        self._entries: dict[str, _Known] = {}
        """What was read of each."""
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
        self._changed.add(recording)

    def mark(self, recording: str, mark: marks.Mark) -> None:
        """Remember that something happened. Raises UnknownThing, OSError."""
        self._known(recording)
        marks.add(self._folder / f"{recording}{marks.SUFFIX}", mark)

    def page(
        self, search: str = "", device: str = "", limit: int | None = None, before: str = "", within_s: float = math.inf
    ) -> Page:
        """The latest first, `limit` of those that are older than the id `before`.

        `search` is looked for in name, note, device and model, without regard to case. Blocks. Files that were never
        read (`read_all` does it before) are read for `within_s`; then the page ends early, with `next` where it ended.
        """
        with self._looking:
            ids, size_bytes = self._scan(), self._sum()
        words = search.casefold().split()

        def is_found(one: _Known) -> bool:
            if device and (one.entry.head is None or one.entry.head.device != device):
                return False
            return all(word in one.words for word in words)

        entries: list[Entry] = []
        following, looked = None, ""
        until_s = time.monotonic() + within_s
        for each in (one for one in ids if one < before) if before else ids:
            known = self._entries.get(each)
            if len(entries) == limit:
                if known is None or is_found(known):
                    following = entries[-1].id
                    break
                continue
            if known is None:
                if looked and time.monotonic() > until_s:
                    following = looked
                    break
                known = self._read(each)
            looked = each
            if is_found(known):  # of others what was read of them has to do; what is shown is looked at once more
                entries.append(self._entry(each))
        if not words and not device:
            return Page(entries, following, len(ids), 0, size_bytes)
        all_known = [self._entries.get(each) for each in ids]
        total = sum(1 for one in all_known if one is not None and is_found(one))
        return Page(entries, following, total, all_known.count(None), size_bytes)

    def read_all(self, ended: threading.Event) -> None:
        """Read what was never read, so that the first search need not. Blocks, for seconds where there are thousands;
        leaves others their turn in between, and ends early with `ended`."""
        with self._looking:
            ids = self._scan()
        while self.size_bytes is None:
            if ended.wait(READ_PAUSE_S):
                return
        for each in ids:
            if ended.wait(READ_PAUSE_S):
                return
            if each not in self._entries:
                self._read(each)

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
        if len(label.tags) > TAGS_MAX:
            raise UsageError(f"at most {TAGS_MAX} tags, not {len(label.tags)}")
        with _written(f"the name of recording {recording} is not kept"):
            self._write_label(self._known(recording), label)

    def notebook(self, recording: str) -> Notebook:
        """What is written about it; nothing where that cannot be read. Raises UnknownThing."""
        try:
            return notebook_of(self._notebook_of(recording).read() or {})
        except UnreadableDocument:
            return Notebook()

    def write_notebook(self, recording: str, cells: Sequence[Cell], based_on: int | None = None) -> None:
        """Raises UnknownThing, UsageError for more than a notebook takes, WrongState where it has another revision
        than `based_on` (None: whatever it has) by now, StoreUnavailable."""
        document = self._notebook_of(recording)
        with _written(f"the notebook of recording {recording} is not kept"), document.locked():
            document.write(asdict(self.notebook(recording).followed_by(cells, based_on)))

    def added(self, recording: str) -> tuple[beside.Added, ...]:
        """The files that were laid beside it. Raises UnknownThing."""
        try:
            return beside.added_of(self._added_of(recording).read() or {})
        except UnreadableDocument:
            return ()

    def rows_of_added(self, recording: str) -> list[beside.AddedRows]:
        """What they hold. Raises UnknownThing, WrongState for what cannot be read."""
        return [self.rows_of_one(recording, each) for each in self.added(recording)]

    def rows_of_one(self, recording: str, of: beside.Added) -> beside.AddedRows:
        """What one of them holds. Raises UnknownThing, WrongState for what cannot be read."""
        try:
            return beside.read_rows(self._data_of(recording, of.number), of)
        except (OSError, ValueError) as error:
            raise WrongState(f"{of.name} beside recording {recording} cannot be read: {error}", "remove it") from error

    def add(self, recording: str, name: str, table: InstrumentTable, offset_s: float, aligned: str) -> beside.Added:
        """Lay a file beside it. Raises UnknownThing, WrongState for one too many, StoreUnavailable."""
        document = self._added_of(recording)
        with _written(f"the file beside recording {recording} is not kept"), document.locked():
            files = self.added(recording)
            free = sorted(set(range(beside.FILES_MAX)) - {each.number for each in files})
            if not free:
                raise WrongState(f"{beside.FILES_MAX} files lie beside this recording", "remove one first")
            taken = {column.name for column in self.open(recording).head.columns}
            taken |= {column.name for each in files for column in each.columns}
            columns = tuple(map(Column, _untaken(table.names, taken), table.units))
            times = len(table.time_s), float(table.time_s[0]), float(table.time_s[-1])
            of = beside.Added(free[0], name, table.instrument, columns, *times, offset_s, aligned, table.notes)
            beside.write_rows(self._data_of(recording, of.number), table.time_s, table.columns)
            document.write(beside.as_document((*files, of)))
        self._changed.add(recording)
        return of

    def align(self, recording: str, number: int, offset_s: float, aligned: str) -> beside.Added:
        """Put a file elsewhere on the recording's time. Raises UnknownThing, StoreUnavailable."""
        document = self._added_of(recording)
        with _written(f"the file beside recording {recording} is not moved"), document.locked():
            files = {each.number: each for each in self.added(recording)}
            of = replace(self.one_added(recording, number), offset_s=offset_s, aligned=aligned)
            document.write(beside.as_document(tuple((files | {number: of}).values())))
        return of

    def take_away(self, recording: str, number: int) -> None:
        """Forget a file. Raises UnknownThing, StoreUnavailable."""
        document = self._added_of(recording)
        with _written(f"the file beside recording {recording} is not removed"), document.locked():
            self.one_added(recording, number)
            document.write(beside.as_document([each for each in self.added(recording) if each.number != number]))
            self._data_of(recording, number).unlink(missing_ok=True)
        self._changed.add(recording)

    def one_added(self, recording: str, number: int) -> beside.Added:
        """Raises UnknownThing."""
        files = self.added(recording)
        for each in files:
            if each.number == number:
                return each
        raise UnknownThing("file beside the recording", str(number), [str(each.number) for each in files])

    def _added_of(self, recording: str) -> Document:
        return Document(self._folder / f"{self._known(recording)}{beside.SUFFIX}")

    def _data_of(self, recording: str, number: int) -> Path:
        return self._folder / f"{self._known(recording)}{beside.data_suffix(number)}"

    def _notebook_of(self, recording: str) -> Document:
        return Document(self._folder / f"{self._known(recording)}{NOTEBOOK}")

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
    def size_bytes(self) -> int | None:
        """Room that all of them take on the disk; None while thousands were never weighed: each call weighs some."""
        with self._looking:
            self._scan()
            return self._sum()

    def _rows_of(self, recording: str) -> Path:
        return self._folder / f"{recording}{file.SUFFIX}"

    def _known(self, recording: str) -> str:
        # The pattern before the path: an id never leads out of the folder.
        if not ID.fullmatch(recording) or not self._rows_of(recording).is_file():
            with self._looking:
                raise UnknownThing("recording", recording[:60], self._scan()[:5])
        return recording

    def _scan(self) -> list[str]:
        """Every recording, the latest first: one look at the names in the folder, none while it is as it was. The list
        is never changed."""
        looked_ns = time.time_ns()
        try:
            changed_ns = self._folder.stat().st_mtime_ns
            if self._scanned_ns != changed_ns:
                self._take_in(set(os.listdir(self._folder)))
                # What changes within the same tick of the file system's clock must not be missed.
                settled_ns = SETTLED_NS if changed_ns % 1_000_000 else SETTLED_COARSE_NS
                self._scanned_ns = changed_ns if looked_ns - changed_ns > settled_ns else 0
        except OSError:
            self._take_in(set())
            self._scanned_ns = 0
        return self._ids

    def _take_in(self, names: set[str]) -> None:
        """These are the names in the folder now; only what came or went costs anything."""
        came, went = names - self._seen, self._seen - names
        if not came and not went:
            return
        self._seen = names
        touched = set(filter(ID.fullmatch, {name.partition(".")[0] for name in came | went}))
        self._changed |= touched
        self._with_rows -= touched
        self._with_rows |= {each for each in touched if each + file.SUFFIX in names}
        self._ids = sorted(self._with_rows, reverse=True)
        for recording in self._entries.keys() - self._with_rows:
            self._entries.pop(recording, None)  # others may forget it, too

    def _sum(self) -> int | None:
        """What all of them take; some that were never weighed are, each time."""
        for recording in tuple(self.running):
            self._weigh(recording)
        for _ in range(min(len(self._changed), WEIGHED_AT_ONCE)):
            self._weigh(self._changed.pop())
        return None if self._changed else self._total_bytes

    def _weigh(self, recording: str) -> None:
        """Look at the sizes of its files."""
        size = self._size_of(recording)
        self._total_bytes += size - self._sizes.pop(recording, 0)
        if size:
            self._sizes[recording] = size

    def _entry(self, recording: str) -> Entry:
        """As it is now."""
        known = self._entries.get(recording)
        if (
            known is not None
            and (known.rows, known.label) == self._stamps(recording)
            and known.entry.recording == (recording in self.running)
        ):
            return known.entry
        return self._read(recording).entry

    def _read(self, recording: str) -> _Known:
        stamps = self._stamps(recording)
        head, problem = None, ""
        try:
            head = Summary.of(file.read_head(self._rows_of(recording)))
        except (UnreadableRecording, OSError) as error:
            problem = str(error)
        label = Label() if stamps[1] is None else _label(self._folder / f"{recording}{LABEL}")
        size = self._size_of(recording)
        entry = Entry(recording, label, head, size, recording in self.running, problem)
        known = self._entries[recording] = _Known(*stamps, entry, _words(entry))
        return known

    def _stamps(self, recording: str) -> tuple[Stamp | None, Stamp | None]:
        begin = f"{self._folder}{os.sep}{recording}"
        return _stamp(f"{begin}{file.SUFFIX}"), _stamp(f"{begin}{LABEL}")

    def _size_of(self, recording: str) -> int:
        stamps = (_stamp(f"{self._folder}{os.sep}{recording}{suffix}") for suffix in SUFFIXES)
        return sum(told[2] for told in stamps if told is not None)

    def _write_label(self, recording: str, label: Label) -> None:
        Document(self._folder / f"{recording}{LABEL}").write(asdict(label))
        self._changed.add(recording)
        self._entries.pop(recording, None)


def _stamp(path: str) -> Stamp | None:
    try:
        told = os.stat(path)
    except OSError:
        return None
    return told.st_ino, told.st_mtime_ns, told.st_size


def _label(path: Path) -> Label:
    try:
        found = Document(path).read() or {}
    except UnreadableDocument:
        return Label()
    name, note = (str(found.get(key, "")).encode(errors="replace").decode() for key in ("name", "note"))
    tags, colour = found.get("tags"), found.get("colour")
    kept = [tag[:TAG_MAX] for tag in tags if isinstance(tag, str)] if isinstance(tags, list) else []
    return Label(
        name[:NAME_MAX], note[:NOTE_MAX], tuple(kept[:TAGS_MAX]), colour[:TAG_MAX] if isinstance(colour, str) else ""
    )


def _untaken(names: Sequence[str], taken: set[str]) -> list[str]:
    """The names, with a number behind those that are taken."""
    result: list[str] = []
    for name in names:
        count, own = 1, name
        while own in taken or own in result:
            count += 1
            own = f"{name} ({count})"
        result.append(own)
    return result


def _words(entry: Entry) -> str:
    of = f"{entry.head.device} {entry.head.model}" if entry.head else ""
    return f"{entry.id} {entry.label.name} {entry.label.note} {' '.join(entry.label.tags)} {of}".casefold()


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
