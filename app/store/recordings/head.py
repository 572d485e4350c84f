"""What a recording is of: written into its file before the first row, so that the file explains itself."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from pydantic_core import from_json

FORMAT = "stepscope-recording"
VERSION = 1


class UnreadableRecording(Exception):
    """The file is there and no recording of ours; the text says why."""


@dataclass(frozen=True, slots=True)
class Column:
    """A channel and its unit."""

    name: str
    unit: str


@dataclass(frozen=True, slots=True)
class Head:
    """Device, columns and circumstances.

    time_origin_unix_s : Unix time [s] of device time 0
    configuration : the device's whole configuration at the start, as its profile has it; None where it was not read
    axes : of each axis its settings (motor, gear, driver) and where it was at the start: what a replay needs beside it
    emulator : the link's options, where the device was emulated
    replay_of : the recording of which this is a replay
    """

    id: str
    device: str
    model: str
    columns: tuple[Column, ...]
    rate_hz: float
    started_unix_s: float
    time_origin_unix_s: float
    chip_timed: bool
    clock_hz: float
    trigger: Mapping[str, Any] = field(default_factory=dict)
    configuration: Mapping[str, Any] | None = None
    axes: tuple[Mapping[str, Any], ...] = ()
    emulator: Mapping[str, Any] | None = None
    replay_of: str | None = None

    def encode(self) -> bytes:
        """JSON, as it stands in the file."""
        return json.dumps({"format": FORMAT, "version": VERSION, **asdict(self)}, allow_nan=False).encode()

    @classmethod
    def decode(cls, data: bytes) -> Head:
        """Raises UnreadableRecording for what no version up to this one has written."""
        try:
            found = from_json(data)  # of a whole configuration: three times as fast as json
            if found.pop("format") != FORMAT:
                raise UnreadableRecording("it is of another program")
            version = found.pop("version")
            if version > VERSION:
                raise UnreadableRecording(f"it is of a newer stepscope: version {version}, known is {VERSION}")
            columns = tuple(Column(**column) for column in found.pop("columns"))
            return cls(columns=columns, axes=tuple(found.pop("axes", ())), **found)
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise UnreadableRecording(f"its head cannot be read: {error!r}") from error
