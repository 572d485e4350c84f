"""A stretch of the telemetry socket, message by message, to arrays. No sockets: both clients feed it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from ..telemetry.frames import Frame, decode
from .errors import ClientError, Refused
from .records import Samples

SUBPROTOCOL = "stepscope.telemetry.v1"


def samples_of(content: bytes, rate_hz: float) -> Samples:
    """A recording's Parquet file as samples. Raises ClientError for a file of another program."""
    # Without threads of Arrow's own: one that still lets go of the bytes while a script ends aborts that
    # (github.com/apache/arrow/issues/34314).
    try:
        table = pq.ParquetFile(pa.BufferReader(content)).read(use_threads=False)
    except pa.ArrowException as error:
        raise ClientError(f"the file is no recording: {error}") from error
    names = table.column_names
    if not names or names[0] != "time_s":
        raise ClientError("the file is no recording of stepscope")
    units = tuple((table.field(name).metadata or {}).get(b"unit", b"").decode() for name in names[1:])
    columns = [table[name].to_numpy() for name in names]
    values = np.stack(columns[1:]) if len(columns) > 1 else np.empty((0, len(columns[0])))
    return Samples(tuple(names[1:]), units, rate_hz, columns[0], values, 0)


class Collector:
    """Collects rows until `seconds` of device time are there."""

    def __init__(self, seconds: float) -> None:
        if not seconds > 0:
            raise ValueError(f"seconds is above 0, not {seconds}")
        self._seconds = seconds
        self._start: Mapping[str, Any] | None = None
        self._frames: list[Frame] = []
        self._first_s: float | None = None

    @property
    def done_s(self) -> float:
        """How much there is [s]."""
        if self._first_s is None:
            return 0.0
        return float(np.nanmax(self._frames[-1].time_s)) - self._first_s

    def feed(self, message: str | bytes) -> bool:
        """Take a message; True once there is enough. Raises Refused, and ClientError where the stream ended."""
        if isinstance(message, str):
            self._hear(json.loads(message))
            return False
        if self._start is None:
            raise ClientError("the socket begins with rows: this is no telemetry of stepscope")
        frame = decode(message)
        if not len(frame.time_s):
            return False
        self._frames.append(frame)
        if self._first_s is None:
            self._first_s = float(frame.time_s[0])
        return self.done_s >= self._seconds

    def samples(self) -> Samples:
        """What was collected, cut to the seconds asked for. Raises ClientError where there is nothing."""
        if self._start is None or self._first_s is None:
            raise ClientError("no sample has come")
        time_s = np.concatenate([frame.time_s for frame in self._frames])
        values = np.concatenate([frame.columns for frame in self._frames], axis=1)
        wanted = time_s <= self._first_s + self._seconds
        channels = self._start["channels"]
        return Samples(
            tuple(channel["name"] for channel in channels),
            tuple(channel["unit"] for channel in channels),
            float(self._start["rate_hz"]),
            time_s[wanted],
            values[:, wanted],
            self._frames[-1].dropped,
        )

    def _hear(self, message: Mapping[str, Any]) -> None:
        if message["type"] == "start":
            self._start = message
        elif message["type"] == "problem":
            problem = message["problem"]
            raise Refused(int(problem["status"]), problem)
