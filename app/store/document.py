"""One JSON document on disk that survives crashes, full disks and a second program writing it.

A write goes to a temporary file, to the disk, and then by rename over the old document: a reader
sees the old one or the new one, never half of one. Writers take turns by a lock beside the file.
What cannot be read is set aside under another name, never overwritten.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import tempfile
import threading
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import cast

from .files import aside_name, exclusive

Entry = dict[str, object]


class UnreadableDocument(Exception):
    """The file is there and is no document of ours; the text says why."""


class Document:
    """The document at `path`. Its directory is made when first written."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._threads = threading.RLock()
        self._depth = 0

    @contextlib.contextmanager
    def locked(self) -> Iterator[None]:
        """Keep other threads and other processes from writing."""
        with self._threads, contextlib.ExitStack() as held:
            if self._depth == 0:  # a second file lock of the same thread would wait for the first one
                held.enter_context(exclusive(self.path))
            self._depth += 1
            try:
                yield
            finally:
                self._depth -= 1

    def read(self) -> dict[str, object] | None:
        """The document, or None where there is none. Raises UnreadableDocument."""
        try:
            text = self.path.read_text(encoding="utf-8-sig")  # some editors begin a file with a byte-order mark
        except FileNotFoundError:
            return None
        except (OSError, UnicodeDecodeError) as error:
            raise UnreadableDocument(str(error)) from error
        try:
            found = json.loads(text, parse_float=_finite, parse_constant=_finite)
        except (ValueError, RecursionError) as error:
            raise UnreadableDocument(f"no JSON: {error}") from error
        if not isinstance(found, dict):
            raise UnreadableDocument("no JSON object")
        return cast("dict[str, object]", found)

    def write(self, document: dict[str, object]) -> None:
        """Replace the document. Raises OSError; then the old one is still there."""
        text = json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
        with self.locked():
            handle, name = tempfile.mkstemp(prefix=self.path.name + ".", suffix=".tmp", dir=self.path.parent)
            temporary = Path(name)
            try:
                with os.fdopen(handle, "w", encoding="utf-8") as file:
                    file.write(text)
                    file.flush()
                    os.fsync(file.fileno())
                temporary.replace(self.path)
            except BaseException:
                temporary.unlink(missing_ok=True)
                raise
            _sync_directory(self.path.parent)

    def set_aside(self) -> Path:
        """Copy the file to a name of its own and return that; the original stays until the next write. Raises OSError.

        A copy that is there already is not made again: a broken file is met at every start. A folder in the file's
        place is renamed.
        """
        with self.locked():
            if self.path.is_dir():
                return self.path.rename(aside_name(self.path))
            content = self.path.read_bytes()
            for earlier in sorted(self.path.parent.glob(f"{self.path.stem}.broken-*{self.path.suffix}")):
                if earlier.read_bytes() == content:
                    return earlier
            aside = aside_name(self.path)
            aside.write_bytes(content)
            return aside

    def kept_as(self) -> Path:
        """`set_aside` for those who only read: where the disk takes nothing, it stays what and where it is."""
        try:
            return self.set_aside()
        except OSError:
            return self.path


class Entries:
    """A document that lists entries under `key`, with its format and version beside it.

    An entry that is no object counts as one whose `name` is what stands there: it is left out by itself, and the
    others are kept.
    """

    def __init__(self, path: Path, key: str, file_format: str, version: int, name: str = "name") -> None:
        self.document = Document(path)
        self._key = key
        self._head: Entry = {"format": file_format, "version": version}
        self._name = name

    @property
    def path(self) -> Path:
        return self.document.path

    def read(self) -> list[Entry]:
        """The entries, unchecked; none where there is no file. Raises UnreadableDocument."""
        document = self.document.read()
        if document is None:
            return []
        for name, wanted in self._head.items():
            if document.get(name) != wanted:
                raise UnreadableDocument(f"its {name} is {document.get(name)!r} instead of {wanted!r}")
        entries = document.get(self._key)
        if not isinstance(entries, list):
            raise UnreadableDocument(f"its {self._key} are no list")
        return [entry if isinstance(entry, dict) else {self._name: entry} for entry in entries]

    def read_or(self, keep: Callable[[], Path]) -> tuple[list[Entry], list[str]]:
        """The entries; none, and why, where the file cannot be read: then `keep` sets it aside and says where it is."""
        try:
            return self.read(), []
        except UnreadableDocument as error:
            return [], [f"{self.path} cannot be read ({error}); it is kept as {keep()}, and a new one is begun"]

    def write(self, entries: Sequence[Entry]) -> None:
        """Replace all entries. Raises OSError; then the old ones are still there."""
        self.document.write({**self._head, self._key: list(entries)})


def writable(value: object) -> bool:
    """Whether `write` could write `value` as a part of a document: half of a surrogate pair, say, is no text."""
    try:
        json.dumps(value, ensure_ascii=False, allow_nan=False).encode()
    except (TypeError, ValueError, RecursionError):
        return False
    return True


def _finite(text: str) -> float:
    """A number of JSON. Raises ValueError for what could not be written again: NaN, Infinity, 1e999."""
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{text} is no number of JSON")
    return number


def _sync_directory(directory: Path) -> None:
    """The rename itself has to reach the disk too; not every system lets a directory be opened."""
    with contextlib.suppress(OSError):
        handle = os.open(directory, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
