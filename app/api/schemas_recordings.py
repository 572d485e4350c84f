"""Shapes of recordings: what to record, the list, and what a plot shows of one."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StringConstraints

from app.api.schemas import Answer, AxisIndex, Body, ChannelInfo, Flag, Number
from app.telemetry.recorder import State

ChannelName = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=80)]
Text = Annotated[str, StringConstraints(strict=True, max_length=100, strip_whitespace=True)]
Note = Annotated[str, StringConstraints(strict=True, max_length=4000)]


class NowTrigger(Body):
    """At once."""

    kind: Literal["now"] = "now"


class MoveTrigger(Body):
    """When an axis is sent somewhere, by whomever."""

    kind: Literal["move"]
    axis: AxisIndex = 0
    pre_s: Annotated[float, Field(strict=True, ge=0, le=60)] = Field(default=0.5, description="kept of before [s]")


class LevelTrigger(Body):
    """When a recorded channel crosses a level."""

    kind: Literal["level"]
    channel: ChannelName
    level: Number
    rising: Flag = True
    pre_s: Annotated[float, Field(strict=True, ge=0, le=60)] = Field(default=0.5, description="kept of before [s]")


class RecordingStart(Body):
    device: Annotated[str, StringConstraints(strict=True, min_length=1, max_length=200)]
    channels: Annotated[list[ChannelName], Field(min_length=1, max_length=64)]
    rate_hz: Annotated[float, Field(strict=True, ge=1, le=1000)] = 200.0
    duration_s: Annotated[float, Field(strict=True, gt=0, le=86_400)] | None = Field(
        default=None, description="counted from the trigger; null: until it is stopped"
    )
    trigger: Annotated[NowTrigger | MoveTrigger | LevelTrigger, Field(discriminator="kind")] = NowTrigger()
    name: Text = ""
    note: Note = ""


class RecordingLabel(Body):
    """What is left out stays."""

    name: Text | None = None
    note: Note | None = None


class RecordingMark(Body):
    text: Annotated[str, StringConstraints(strict=True, min_length=1, max_length=400)]


class MarkOut(Answer):
    time_s: float = Field(description="device time [s]")
    kind: str
    text: str
    axis: int | None


class RecordingInfo(Answer):
    id: str
    name: str
    note: str
    device: str | None = Field(description="null where the file cannot be read: see `message`")
    model: str | None
    channels: list[ChannelInfo]
    rate_hz: float | None = Field(description="granted; less than asked for where the link carries no more")
    started_unix_s: float | None
    state: State
    message: str = Field(description="why it ended, where nobody asked for that; or why it cannot be read")
    rows: int | None = Field(description="written so far, of those that were recorded since the server started")
    size_bytes: int


class RecordingList(Answer):
    recordings: list[RecordingInfo]
    size_bytes: int = Field(description="of all recordings, found or not [bytes]")


class FiguresOut(Answer):
    samples: int
    missing: int = Field(description="samples that should be there and are not")
    minimum: float | None
    maximum: float | None
    mean: float | None
    rms: float | None
    first: float | None
    last: float | None
    overshoot: float | None = Field(description="beyond the last value, of what ends elsewhere than it began")
    settling_s: float | None = Field(description="until it stays within 2 % of the way of its last value [s]")


class RecordingDetail(RecordingInfo):
    time_origin_unix_s: float
    zero_s: float | None = Field(description="device time of the trigger, or of the first row [s]")
    duration_s: float = Field(description="from the first row to the last [s]")
    marks: list[MarkOut]
    figures: dict[str, FiguresOut]
    configuration: dict[str, object] | None = Field(description="the device's profile at the start")


class Curve(Answer):
    channel: str
    unit: str
    time_s: list[float] = Field(description="since `zero_s` [s]")
    values: list[float | None] = Field(description="null: missing")


class RecordingPlot(Answer):
    """Of each stretch the lowest and the highest sample, at their own times: no peak is hidden."""

    zero_s: float
    from_s: float
    to_s: float
    rows: int = Field(description="rows that lie between")
    thinned: bool = Field(description="fewer points than rows are here")
    curves: list[Curve]
