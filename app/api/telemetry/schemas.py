"""Text messages of the telemetry socket, told apart by `type`. Its binary frame is in app/telemetry/frames.py."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ...deferred import DeferredRootModel
from ...devices.core.results import StopReason
from ..schemas import Answer, Problem

SUBPROTOCOL = "stepscope.telemetry.v1"


class TelemetryChannel(Answer):
    name: str
    unit: str


class TelemetryStart(Answer):
    """The first message: what the columns of every binary frame are."""

    type: Literal["start"] = "start"
    device: str
    channels: list[TelemetryChannel]
    rate_hz: float = Field(description="granted; less than requested where the link carries no more")
    requested_rate_hz: float
    chip_timed: bool = Field(description="times are the device's own, else the server's")
    time_origin_unix_s: float = Field(description="Unix time [s] of device time 0, at time scale 1")
    history_rows: int = Field(description="rows of the past that come before the first live one")


class TelemetryStatus(Answer):
    """How the stream went in the last second."""

    type: Literal["status"] = "status"
    achieved_rate_hz: float
    jitter_ms: float = Field(description="standard deviation of the time between samples [ms]")
    dropped: int = Field(description="rows this reader lost so far, because it was too slow")
    latency_ms: float = Field(description="longest time from a sample to its socket in the last second [ms]")
    calls_per_s: float = Field(default=0.0, description="frames and their replies that all of this wire's users sent")
    calls_per_s_possible: float | None = Field(default=None, description="null where the wire sets no limit")
    row_spread_ms: float = Field(default=0.0, description="from the first to the last question of a row [ms]")


class TelemetryGap(Answer):
    """Samples are missing from here on, until the next ones come. A row of NaN stands at the place."""

    type: Literal["gap"] = "gap"
    reason: str


class TelemetryMove(Answer):
    """An axis was sent somewhere: what a trigger waits for."""

    type: Literal["move"] = "move"
    axis: int
    started_at_s: float


class TelemetryStopped(Answer):
    """An axis came to rest, and why."""

    type: Literal["stopped"] = "stopped"
    axis: int
    reason: StopReason
    time_s: float = Field(description="device time [s]")
    position: int | None
    detail: str


class TelemetryEvent(Answer):
    """The chip has seen something happen (EVENTS): what is also in the timeline of its axis."""

    type: Literal["event"] = "event"
    axis: int
    seq: int
    time_s: float = Field(description="device time [s]")
    names: list[str]


class TelemetryProgram(Answer):
    """The program of a module began, halted or ended; the latest come with the past, too."""

    type: Literal["program"] = "program"
    axis: int
    time_s: float = Field(description="device time at which it was commanded or seen [s]")
    address: int | None = Field(description="of the command that is done next; null where nobody has read it")
    text: str


class TelemetryProblem(Answer):
    """Why there is no stream, or no more of it; the socket closes with 4000 + the problem's status."""

    type: Literal["problem"] = "problem"
    problem: Problem


TelemetryText = (
    TelemetryStart
    | TelemetryStatus
    | TelemetryGap
    | TelemetryMove
    | TelemetryStopped
    | TelemetryEvent
    | TelemetryProgram
    | TelemetryProblem
)


class TelemetryMessage(DeferredRootModel[TelemetryText]):
    """Any text message of the socket."""

    root: Annotated[TelemetryText, Field(discriminator="type")]
