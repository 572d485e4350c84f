"""A recording that is looked at: where its rows stand in the file, and the extremes of each short segment of them.

A long recording's rows stay on the disk. Looking at it once costs a reading of the file; from then on a plot of any
part costs about the same few milliseconds, and what was written meanwhile is read behind what is known.
"""

from __future__ import annotations

import threading
from array import array
from bisect import bisect_left, bisect_right
from collections import OrderedDict
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...calc.signals.min_max_pyramid import MinMaxSegments, size_for
from .file import FloatArray, Rows, decode_head, whole_batches
from .head import Head, UnreadableRecording

if TYPE_CHECKING:
    import pyarrow as pa  # at run time by who opens a file, as in `file`

BLOCK = 64
"""Rows of a short segment, of recordings that have no more than `BLOCKS_MAX` of them."""
BLOCKS_MAX = 1 << 18
"""Short segments that are kept of a recording, 70 MB of eight channels; of longer ones they are twice as long, and so
on."""
PIECE_ROWS = 16_384
"""Rows of a piece: a megabyte or two."""
ROWS_AT_ONCE = 16_384
"""Taken in together: a megabyte or two stays in the processor's cache, and needs no fresh memory from the system."""
KEPT_BYTES = 256 << 20
"""What all opened recordings may keep in memory: some 80 of ten minutes at 8 x 1 kHz."""


class Opened:
    """One file. Safe to use from several threads. Raises UnreadableRecording, FileNotFoundError."""

    def __init__(self, path: Path, blocks_max: int = BLOCKS_MAX) -> None:
        import pyarrow as pa

        self._path, self._blocks_max = path, blocks_max
        self._lock = threading.Lock()
        with pa.OSFile(str(path)) as source:  # an empty file cannot be mapped
            try:
                self._schema = pa.ipc.read_schema(source)
            except (pa.ArrowInvalid, OSError, EOFError) as error:
                raise UnreadableRecording(f"it is no Arrow stream: {error}") from error
            self._end = source.tell()
        self.head: Head = decode_head(self._schema)
        # Of each batch where it stands, the number of its first row, and that row's time.
        self._offsets, self._firsts, self._times_s = array("q"), array("q"), array("d")
        self._rows = 0
        self._last_s = float("nan")
        self._blocks = MinMaxSegments.of_rows(np.empty(0), np.empty((self.channels, 0)))
        self._block = BLOCK
        self._rest = np.empty((1 + self.channels, 0))
        """Rows that are no whole block yet, times first."""
        self.refresh()

    @property
    def channels(self) -> int:
        return len(self.head.columns)

    @property
    def rows(self) -> int:
        """How many were in the file at the latest look."""
        return self._rows

    @property
    def first_s(self) -> float | None:
        """Device time of the first row [s]."""
        return self._times_s[0] if self._times_s else None

    @property
    def last_s(self) -> float | None:
        """Device time of the last row [s]."""
        return self._last_s if self._rows else None

    @property
    def size_bytes(self) -> int:
        """What is kept of it in memory, about."""
        return len(self._blocks) * (8 + self.channels * 33) + len(self._offsets) * 24

    def refresh(self) -> None:
        """Take in what was written since."""
        import pyarrow as pa

        with self._lock, pa.memory_map(str(self._path)) as source:
            source.seek(self._end)
            batches: list[pa.RecordBatch] = []
            held, parts = 0, [self._blocks]
            for batch, offset, end in whole_batches(source, self._schema):
                self._end = end
                if batch.num_rows:
                    batches.append(batch)
                    held += batch.num_rows
                    self._offsets.append(offset)
                    self._firsts.append(self._rows)
                    self._rows += batch.num_rows
                if held >= ROWS_AT_ONCE:
                    parts.append(self._taken(batches))
                    held, batches = 0, []
                    if sum(map(len, parts)) > self._blocks_max:
                        parts = [self._joined(parts)]
            if batches:
                parts.append(self._taken(batches))
            self._blocks = self._joined(parts)

    def _taken(self, batches: list[pa.RecordBatch]) -> MinMaxSegments:
        """The whole blocks that there are with `batches`; what is left waits for the next."""
        table = _table(batches, 1 + self.channels)
        begins = np.cumsum([0, *(batch.num_rows for batch in batches[:-1])])
        self._times_s.extend(table[0, begins])
        self._last_s = float(table[0, -1])
        table = np.concatenate((self._rest, table), axis=1)
        whole = table.shape[1] // self._block * self._block
        self._rest = table[:, whole:].copy()
        return MinMaxSegments.of_rows(table[0, :whole], table[1:, :whole]).joined(self._block)

    def _joined(self, parts: Sequence[MinMaxSegments]) -> MinMaxSegments:
        """All of them as one, in longer blocks where there are too many; an odd one waits for its pair."""
        parts = [part for part in parts if len(part)] or parts[:1]
        blocks = MinMaxSegments.chained(parts) if len(parts) > 1 else parts[0]
        while len(blocks) > self._blocks_max and len(blocks) % 2 == 0:
            self._block *= 2
            blocks = blocks.joined(2)
        return blocks

    def read(self, first: int, last: int) -> Rows:
        """Rows from number `first` up to `last`, without it."""
        import pyarrow as pa

        first, last = max(0, first), min(last, self._rows)
        if first >= last:
            return Rows(np.empty(0), np.empty((self.channels, 0)))
        begin = bisect_right(self._firsts, first) - 1
        with pa.memory_map(str(self._path)) as source:
            source.seek(self._offsets[begin])
            batches, read = [], self._firsts[begin]
            for batch, _, _ in whole_batches(source, self._schema):
                batches.append(batch)
                read += batch.num_rows
                if read >= last:
                    break
            table = _table(batches, 1 + self.channels)[:, first - self._firsts[begin] : last - self._firsts[begin]]
        return Rows(table[0], table[1:])

    def pieces(self, first: int, last: int) -> Iterator[Rows]:
        """The same in pieces of `PIECE_ROWS` and a batch at the most: for what is longer than the memory.

        The file may be deleted meanwhile.
        """
        import pyarrow as pa

        first, last = max(0, first), min(last, self._rows)
        if first >= last:
            return
        begin = bisect_right(self._firsts, first) - 1
        at = self._firsts[begin]
        with pa.memory_map(str(self._path)) as source:
            source.seek(self._offsets[begin])
            batches: list[pa.RecordBatch] = []
            read = at
            for batch, _, _ in whole_batches(source, self._schema):
                batches.append(batch)
                read += batch.num_rows
                if read - at >= PIECE_ROWS or read >= last:
                    table = _table(batches, 1 + self.channels)[:, max(0, first - at) : last - at]
                    yield Rows(table[0], table[1:])
                    at, batches = read, []
                if read >= last:
                    return

    def row_at(self, time_s: float, side: str = "left") -> int:
        """The first row not before device time `time_s` [s]; with `side` "right" the first behind it."""
        end = (bisect_right if side == "right" else bisect_left)(self._times_s, time_s)
        if end == 0:
            return 0
        # In the batch before, or up to the one that begins there: its first row is known not to be before.
        first = self._firsts[end - 1]
        last = self._firsts[end] if end < len(self._firsts) else self._rows
        times_s = self.read(first, last).time_s
        return first + int(np.searchsorted(times_s, time_s, side="right" if side == "right" else "left"))

    def segments(self, first: int, last: int, wanted: int) -> MinMaxSegments:
        """Rows `first` up to `last` as at most `wanted` + 2 segments; as they are where they are few enough."""
        first, last = max(0, first), min(last, self._rows)
        rows = max(0, last - first)
        with self._lock:  # both of the same look
            block, blocks = self._block, self._blocks
        if rows < wanted * block or rows < 4 * block:
            read = self.read(first, last)
            return MinMaxSegments.of_rows(read.time_s, read.columns).joined(size_for(rows, wanted))
        begin, end = -(-first // block), min(last // block, len(blocks))
        inner = blocks.part(begin, end).joined(size_for(end - begin, wanted))
        parts = [inner]
        for at, edge in ((0, (first, begin * block)), (len(parts), (end * block, last))):
            if edge[0] < edge[1]:
                read = self.read(*edge)
                outer = MinMaxSegments.of_rows(read.time_s, read.columns).joined(edge[1] - edge[0])
                parts.insert(at if at == 0 else len(parts), outer)
        return MinMaxSegments.chained(parts)


class OpenedRecordings:
    """Those that were looked at lately, as many as `limit_bytes` hold."""

    def __init__(self, limit_bytes: int = KEPT_BYTES) -> None:
        self._limit_bytes = limit_bytes
        self._opened: OrderedDict[Path, Opened] = OrderedDict()
        self._lock = threading.Lock()
        self._opening: dict[Path, threading.Lock] = {}

    def get(self, path: Path) -> Opened:
        """The recording at `path`, up to date. Raises UnreadableRecording, FileNotFoundError."""
        with self._lock:
            opening = self._opening.setdefault(path, threading.Lock())
        with opening:  # two plots of a recording that nobody looked at yet: one of them reads it
            opened = self._opened.get(path)
            try:
                if opened is None:
                    opened = Opened(path)
                else:
                    opened.refresh()
            except (FileNotFoundError, UnreadableRecording):
                self.forget(path)
                raise
        with self._lock:
            self._opened[path] = opened
            self._opened.move_to_end(path)
            while len(self._opened) > 1 and sum(each.size_bytes for each in self._opened.values()) > self._limit_bytes:
                oldest, _ = self._opened.popitem(last=False)
                self._opening.pop(oldest, None)
        return opened

    def forget(self, path: Path) -> None:
        """It is gone."""
        with self._lock:
            self._opened.pop(path, None)
            self._opening.pop(path, None)


def thinned(pieces: Iterable[Rows], channels: Sequence[int], every: int) -> tuple[FloatArray, FloatArray]:
    """The first of each `every` rows: `time_s` [rows], and of `channels` [channels, rows]."""
    times_s, columns = [np.empty(0)], [np.empty((len(channels), 0))]
    skip = 0
    for rows in pieces:
        times_s.append(rows.time_s[skip::every].copy())
        columns.append(rows.columns[list(channels), skip::every])
        skip = (skip - len(rows.time_s)) % every
    return np.concatenate(times_s), np.concatenate(columns, axis=1)


def _table(batches: list[pa.RecordBatch], width: int) -> FloatArray:
    """[columns, rows]; a copy, which outlives the file's mapping."""
    import pyarrow as pa

    joined = pa.Table.from_batches(batches)
    table = np.empty((width, joined.num_rows))
    for row, column in enumerate(joined.columns):
        table[row] = column.to_numpy()
    return table
