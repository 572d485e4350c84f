"""The rows of a recording: an Arrow stream that grows by a batch, so that a killed server loses the last one only.

Arrow's stream has no end that would have to be written: whoever reads takes the batches that are whole. Other programs
read it as well (`pyarrow.ipc.open_stream`, pandas, polars, DuckDB).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .head import Head, UnreadableRecording

if TYPE_CHECKING:
    import pyarrow as pa

# pyarrow takes 0.15 s of work to import: whoever touches a file does it, and a server that keeps none starts without.

FloatArray = NDArray[np.float64]
SUFFIX = ".arrows"
"""What Arrow calls a file with a stream."""
TIME = "time_s"
HEAD = b"stepscope"


@dataclass(frozen=True, slots=True)
class Rows:
    """`time_s` [rows], device time, never falling; `columns` [channels, rows], NaN where a sample is missing."""

    time_s: FloatArray
    columns: FloatArray


class RecordingWriter:
    """Writes a new file. Raises FileExistsError for one that is there, OSError where the disk does not take it."""

    def __init__(self, path: Path, head: Head) -> None:
        import pyarrow as pa

        names = (TIME, *(column.name for column in head.columns))
        self._schema = pa.schema([(name, pa.float64()) for name in names], metadata={HEAD: head.encode()})
        self._file = path.open("xb", buffering=0)  # what was written is the system's, whatever becomes of us
        self._sink = pa.PythonFile(self._file, mode="w")
        self._stream = pa.ipc.new_stream(self._sink, self._schema)
        self.rows = 0
        # Arrow writes what the file is of with the first batch: until then nobody could tell.
        self._write([np.empty(0)] * len(self._schema))

    def append(self, rows: Rows) -> None:
        """Add rows; they outlive this process when it returns."""
        if not len(rows.time_s):
            return
        self._write([rows.time_s, *rows.columns])
        self.rows += len(rows.time_s)

    def _write(self, columns: Sequence[FloatArray]) -> None:
        import pyarrow as pa

        arrays = [pa.array(column) for column in columns]
        self._stream.write_batch(pa.record_batch(arrays, schema=self._schema))
        self._sink.flush()

    def close(self) -> None:
        """End the stream. A second call does nothing."""
        if not self._file.closed:
            self._stream.close()
            self._sink.close()
            self._file.close()


def read_head(path: Path) -> Head:
    """What the recording is of. Raises UnreadableRecording, FileNotFoundError."""
    import pyarrow as pa

    with pa.OSFile(str(path)) as source:
        return decode_head(_open(source).schema)


def read_rows(path: Path) -> Rows:
    """Every whole batch of the file, which may still be growing. Raises UnreadableRecording, FileNotFoundError."""
    import pyarrow as pa

    with pa.memory_map(str(path)) as source:
        stream = _open(source)
        width = len(decode_head(stream.schema).columns)
        batches = [
            np.stack([column.to_numpy(zero_copy_only=False) for column in batch.columns]) for batch in _whole(stream)
        ]
    table = np.concatenate(batches, axis=1) if batches else np.empty((1 + width, 0))
    return Rows(table[0], table[1:])


def _open(source: pa.NativeFile) -> pa.ipc.RecordBatchStreamReader:
    import pyarrow as pa

    try:
        return pa.ipc.open_stream(source)
    except (pa.ArrowInvalid, OSError) as error:
        raise UnreadableRecording(f"it is no Arrow stream: {error}") from error


def decode_head(schema: pa.Schema) -> Head:
    """What a stream of this schema is of. Raises UnreadableRecording."""
    metadata = schema.metadata or {}
    if HEAD not in metadata:
        raise UnreadableRecording("it is an Arrow stream of another program")
    return Head.decode(metadata[HEAD])


def whole_batches(source: pa.NativeFile, schema: pa.Schema) -> Iterator[tuple[pa.RecordBatch, int, int]]:
    """The batches from where `source` stands, up to one that breaks off: each with where it begins and ends [bytes]."""
    import pyarrow as pa

    while True:
        offset = source.tell()
        try:
            batch = pa.ipc.read_record_batch(pa.ipc.read_message(source), schema)
        except (EOFError, pa.ArrowInvalid, OSError):
            return
        yield batch, offset, source.tell()


def _whole(stream: pa.ipc.RecordBatchStreamReader) -> Iterator[pa.RecordBatch]:
    """The batches up to one that breaks off."""
    import pyarrow as pa

    while True:
        try:
            yield stream.read_next_batch()
        except (StopIteration, pa.ArrowInvalid, OSError):
            return
