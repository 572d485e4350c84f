"""What comes back, as records with types. A field of a newer server that is not known here is in no one's way."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

Json = Mapping[str, Any]
R = TypeVar("R")


def record(kind: type[R], data: Json) -> R:
    """`data` as a `kind`. Raises KeyError for a field that the server owes."""
    return kind(**{field.name: data[field.name] for field in fields(kind)})  # type: ignore[arg-type]  # every R is a dataclass


@dataclass(frozen=True, slots=True)
class Device:
    """A connection."""

    id: str
    name: str
    model: str
    title: str
    link: Json
    clock_hz: float
    state: str
    """"connected", "connecting", "disconnected" or "failed"."""
    problem: Json | None
    notes: tuple[str, ...]
    """What to know of it now: motors that were moving before stepscope was there."""
    emulated: bool
    axes: tuple[Json, ...]
    channels: tuple[Json, ...]
    rate_max_hz: float


@dataclass(frozen=True, slots=True)
class LeaseState:
    """Who has the bench."""

    state: str
    """"free" or "taken"."""
    holder: str | None
    mine: bool
    """Whether this client has it."""
    left: bool
    """The holder's last page was closed: any other session may take it."""
    since_s: float | None
    expires_in_s: float | None
    asking: tuple[Json, ...]
    """Who would like to have it: `id`, `name`, `since_s`."""
    on_vanish: str
    """What happens to moving motors when the holder gives no sign any more: "nothing", "stop" or "hold"."""
    vanish_after_s: float


@dataclass(frozen=True, slots=True)
class Reading:
    """A register or parameter as the device holds it."""

    name: str
    address: int
    axis: int | None
    raw: int
    value: int
    fields: Mapping[str, int]
    unit: str


@dataclass(frozen=True, slots=True)
class Written:
    """The read-back of a write."""

    name: str
    axis: int | None
    value: int
    fields: Mapping[str, int]
    unit: str
    written: int
    verified: bool | None
    """None where a read-back cannot tell: the chip changes the register by itself, or nobody can read it."""
    note: str


@dataclass(frozen=True, slots=True)
class Condition:
    """What is so with an axis: one of eleven kinds, why, by which evidence, and which calls mend it."""

    kind: str
    cause: str
    evidence: tuple[Json, ...]
    remedies: tuple[Json, ...]
    """Each with `label`, `method`, `path`, `body` and `moves`; `Bench.remedy` makes it."""
    since_s: float | None

    @property
    def remedy(self) -> Json | None:
        """The first of them; None where nothing helps."""
        return self.remedies[0] if self.remedies else None


@dataclass(frozen=True, slots=True)
class Standing:
    """How an axis of a device stands, as the server judged it last."""

    device: str
    axis: int
    condition: Condition
    referenced: bool | None
    """None where nobody knows."""
    ground_truth: Json | None
    """Of emulated axes: what is really so."""


@dataclass(frozen=True, slots=True)
class AxisState:
    """One axis, read now. Positions in microsteps; None where the family has none."""

    position: int
    target_position: int | None
    velocity_pps: float
    target_velocity_pps: float | None
    acceleration_pps2: float | None
    encoder_position: int | None
    deviation: float | None
    position_reached: bool
    moving: bool
    mode: str
    switches: Mapping[str, bool | None]
    flags: Mapping[str, bool]
    time_s: float
    condition: Condition
    referenced: bool | None
    ground_truth: Json | None


@dataclass(frozen=True, slots=True)
class MoveStarted:
    """A move is under way. Positions in microsteps, times in device time [s]."""

    axis: int
    from_position: int
    target_position: int
    started_at_s: float
    predicted_duration_s: float | None
    warnings: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Recording:
    """A recording in the server's data directory."""

    id: str
    name: str
    note: str
    device: str | None
    model: str | None
    rate_hz: float | None
    state: str
    """"waiting" for its trigger, "recording", "done" or "failed"."""
    message: str
    rows: int | None
    size_bytes: int


@dataclass(frozen=True, slots=True)
class Samples:
    """A stretch of telemetry: `time_s` [rows] and `values` [channels, rows], NaN where a sample is missing."""

    channels: tuple[str, ...]
    units: tuple[str, ...]
    rate_hz: float
    """Granted: less than asked for where the link carries no more."""
    time_s: NDArray[np.float64]
    values: NDArray[np.float64]
    dropped: int
    """Rows that this reader lost, because it was too slow."""

    def __getitem__(self, channel: str) -> NDArray[np.float64]:
        """The samples of one channel [rows]. Raises KeyError."""
        if channel not in self.channels:
            raise KeyError(f"{channel!r} is none of {', '.join(self.channels)}")
        values: NDArray[np.float64] = self.values[self.channels.index(channel)]
        return values
