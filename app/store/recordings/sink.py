"""A recorder's way to the disk: rows and marks into the files of a library, as long as there is room."""

from __future__ import annotations

import errno
from collections.abc import Callable, Mapping
from typing import Any

from ...devices.core.marks import MarkKind
from .file import FloatArray, RecordingWriter, Rows
from .library import Library
from .marks import Mark

LOOK_EVERY = 10
"""How many writes go by between two looks at the room on the disk: with ten writes a second, one a second."""


class DiskFull(OSError):
    """So little room is left that the rest of the system needs it."""

    def __init__(self, free_bytes: int) -> None:
        super().__init__(errno.ENOSPC, f"only {megabytes(free_bytes)} are left on the disk")


class FileSink:
    """Rows and marks of recording `recording`. What is written stays whole: a full disk ends it between two writes."""

    def __init__(self, library: Library, recording: str, writer: RecordingWriter, room: Callable[[], int]) -> None:
        """`room` says how much may still be written [bytes]."""
        self._library, self._id, self._writer, self._room = library, recording, writer, room
        self._writes = 0

    def append(self, time_s: FloatArray, columns: FloatArray) -> None:
        """Rows. Raises DiskFull, OSError."""
        if self._writes % LOOK_EVERY == 0 and self._room() <= 0:
            raise DiskFull(self._library.free_bytes)
        self._writes += 1
        self._writer.append(Rows(time_s, columns))

    def mark(
        self, time_s: float, kind: MarkKind, text: str, axis: int | None, detail: Mapping[str, Any] | None = None
    ) -> None:
        """A mark. Raises OSError."""
        self._library.mark(self._id, Mark(time_s, kind, text, axis, detail))

    def close(self) -> None:
        """That was all."""
        self._writer.close()


def megabytes(size_bytes: float) -> str:
    """As people read it."""
    return f"{size_bytes / 1e9:.1f} GB" if abs(size_bytes) >= 1e9 else f"{size_bytes / 1e6:.0f} MB"
