"""Shapes of the server's health."""

from __future__ import annotations

from pydantic import Field

from ..schemas import Answer, DeviceState


class StorageHealth(Answer):
    """The data directory and its disk."""

    data_dir: str
    free_bytes: int | None = Field(description="null where the disk does not tell")
    total_bytes: int | None
    reserve_bytes: int = Field(description="recordings end before less than this is free")
    writable: bool | None = Field(description="whether the server's user may write there; null where nobody knows")
    notes: list[str] = Field(description="what is not saved, and what was set aside because it could not be read")


class ProcessHealth(Answer):
    """What the server's process uses."""

    descriptors: int | None = Field(description="open files and sockets; null where the system does not tell")
    descriptors_max: int
    resident_bytes: int | None = Field(description="its memory that is in RAM; null where the system does not tell")


class LoopHealth(Answer):
    """How much later than wanted the event loop wakes a sleeper."""

    lag_ms: float | None = Field(description="just now; null before the first measurement")
    lag_p99_ms: float | None = Field(description="99 of 100 in the last minute were not later")
    lag_ms_by_second: list[float | None] = Field(
        description="the worst of each of the last 60 s, oldest first; null where nothing was measured"
    )


class QueueHealth(Answer):
    """Turns that wait for a device's line."""

    stops: int
    commands: int
    samples: int
    longest_wait_ms: float = Field(description="in the last half to one minute; of all that wait, or waited")


class WireHealth(Answer):
    """What went over a device's link since it was made."""

    name: str
    kind: str
    bytes_sent: int
    bytes_received: int
    frames: int
    timeouts: int
    failures: int = Field(description="failed exchanges of any kind, timeouts included")
    samples_dropped: int = Field(description="samples that were not taken, for the link was too busy")


class ReadersHealth(Answer):
    """Who reads a device's samples: telemetry sockets, recordings, the 3D view."""

    readers: int
    rows_dropped: int = Field(description="rows that slow readers lost since the device was connected this way")


class EmulatorHealth(Answer):
    """An emulated device within this server."""

    time_scale: float = Field(description="how fast its time runs")
    samples_missed: int = Field(description="samples that were given up, for the server was too late")


class DeviceHealth(Answer):
    """One device."""

    id: str
    name: str
    model: str
    state: DeviceState
    problem: str | None = Field(description="why it is not connected, or what its latest exchange failed of")
    link: WireHealth
    queue: QueueHealth
    telemetry: ReadersHealth
    emulator: EmulatorHealth | None = Field(description="null for what is not emulated within this server")


class SocketsHealth(Answer):
    """Open connections of clients."""

    websockets: int
    rows_dropped: int = Field(description="telemetry rows that slow readers of the present devices lost")
    connections: int | None = Field(description="of HTTP, WebSockets included; null where another program serves this")
    connections_max: int | None
    connections_ended: int | None = Field(description="ended for others, or for taking too long, since the start")


class Compiling(Answer):
    """How far the first start has come with what it compiles."""

    done: int
    total: int = Field(description="0 in the first seconds: it has not been looked yet whether all is there")
    doing: list[str] = Field(description="families of emulators, and calculators, that are being compiled")


class HealthDetails(Answer):
    """How the server is."""

    version: str
    uptime_s: float
    storage: StorageHealth
    process: ProcessHealth
    event_loop: LoopHealth
    sockets: SocketsHealth
    devices: list[DeviceHealth]
    compiling: Compiling | None = Field(
        description="what a first start compiles in the background: until then emulators run in plain Python, slower "
        "than real time where that is too much, and studies of them are refused. null where all is there"
    )
