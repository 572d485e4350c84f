"""Shapes of recordings: what to record, the list, and what a plot shows of one."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field, StringConstraints

from ...telemetry.recorder import State
from ..schemas import Answer, AxisIndex, Body, ChannelInfo, Flag, Number

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


Tag = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=40, strip_whitespace=True)]
Colour = Literal["", "blue", "orange", "green", "pink", "violet", "olive", "grey", "brown"]


class Cell(Body):
    """A cell of a recording's notebook; a figure or a table is of a stretch since the zero, or of all of it."""

    kind: Literal["text", "figure", "table"]
    text: Note = ""
    from_s: Number | None = None
    to_s: Number | None = None
    channels: Annotated[list[ChannelName], Field(max_length=64)] = Field(default=[], description="none: all")


class RecordingLabel(Body):
    """What is left out stays."""

    name: Text | None = None
    note: Note | None = None
    tags: Annotated[list[Tag], Field(max_length=12)] | None = None
    colour: Colour | None = Field(default=None, description="in lists and comparisons; empty: the one of its place")
    notebook: Annotated[list[Cell], Field(max_length=100)] | None = None
    notebook_revision: Annotated[int, Field(strict=True, ge=0, le=1 << 53)] | None = Field(
        default=None, description="the one that `notebook` replaces: where it has another by now, nothing is written"
    )


class CellOut(Answer):
    kind: Literal["text", "figure", "table"]
    text: str
    from_s: float | None
    to_s: float | None
    channels: list[str]


class RecordingMark(Body):
    text: Annotated[str, StringConstraints(strict=True, min_length=1, max_length=400)]


class Align(Body):
    """Where a file's time lies on the recording's: one of offset, mark and correlation; else its 0 on the zero."""

    offset_s: Number | None = Field(default=None, description="the file's 0, since the recording's zero [s]")
    mark: Annotated[int, Field(strict=True, ge=0, le=1_000_000)] | None = Field(
        default=None, description="the file's 0 lies on this mark, counted from 0 in the recording's `marks`"
    )
    like: ChannelName | None = Field(default=None, description="a recorded channel that one of the file looks like")
    channel: ChannelName | None = Field(default=None, description="the file's that looks like it; null: its first")


class AddedFile(Answer):
    """A file of another instrument beside the recording."""

    number: int
    name: str
    instrument: str = Field(description="as the file tells it; may be empty")
    channels: list[ChannelInfo]
    rows: int
    from_s: float
    to_s: float = Field(description="its first and last time, since the recording's zero [s]")
    offset_s: float = Field(description="its 0, since the recording's zero [s]")
    aligned: str = Field(description="how that came about")
    notes: list[str] = Field(description="what was assumed in reading it")


class MarkOut(Answer):
    time_s: float = Field(description="device time [s]")
    kind: str
    text: str
    axis: int | None
    detail: dict[str, object] | None = Field(description="the same for programs, where there is more than the text")


class RecordingInfo(Answer):
    id: str
    name: str
    note: str
    tags: list[str]
    colour: str = Field(description="by name; empty: the one of its place in a comparison")
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
    next: str | None = Field(description="`before` of the next page; null where this is the last one")
    total: int = Field(description="how many were found so far, on all pages")
    unread: int = Field(
        description="how many a search has not looked into yet, soon after the start: ask again, or go on with `next`"
    )
    size_bytes: int | None = Field(
        description="of all recordings, found or not [bytes]; null for a moment after the start with thousands of them"
    )
    free_bytes: int = Field(description="what the disk has left [bytes]")
    room_bytes: int = Field(description="what may still be recorded: a reserve of the disk is kept [bytes]; 0: nothing")


class FiguresOut(Answer):
    samples: int
    missing: int = Field(description="samples that should be there and are not")
    minimum: float | None
    maximum: float | None
    mean: float | None
    rms: float | None
    peak: float | None = Field(description="the value farthest from 0")
    first: float | None
    last: float | None
    overshoot: float | None = Field(description="beyond the last value, of what ends elsewhere than it began")
    settling_s: float | None = Field(description="until it stays within 2 % of the way of its last value [s]")


FiguresByChannel = Annotated[
    dict[str, FiguresOut],
    Field(description="by channel; `following_error.N` where the planned position of an axis was recorded, too"),
]


class RecordingDetail(RecordingInfo):
    time_origin_unix_s: float
    zero_s: float | None = Field(description="device time of the trigger, or of the first row [s]")
    duration_s: float = Field(description="from the first row to the last [s]")
    marks: list[MarkOut]
    notebook: list[CellOut] = Field(description="what is written about it, in its order")
    notebook_revision: int = Field(description="how often it was written")
    added: list[AddedFile] = Field(description="files of other instruments that lie beside it")
    figures: FiguresByChannel
    configuration: dict[str, object] | None = Field(description="the device's profile at the start")
    replay_of: str | None = Field(description="the recording of which this is a replay on an emulator")


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


class RecordingFigures(Answer):
    from_s: float
    to_s: float
    figures: FiguresByChannel


class Spectrum(Answer):
    """One side of a spectrum. Lines are thinned like plots: of each stretch of frequencies the highest stays."""

    channel: str
    unit: str
    frequency_hz: list[float]
    amplitude: list[float] = Field(description="of a sine that would make this line, in the channel's unit")
    density: list[float] = Field(description="power density [unit^2 / Hz]")
    peak_hz: float | None = Field(description="the highest line but the constant part; null where nothing swings")
    peak: float | None
    line_hz: float
    resolution_hz: float = Field(description="closer than this two sines are one")
    rate_hz: float
    samples: int
    from_s: float
    to_s: float = Field(description="what was analysed: the longest part without a gap, since the zero [s]")
    resampled: bool = Field(description="times were uneven: read off at even ones along straight lines")


class CompareWith(Body):
    """Recordings to lay on each other. The first is what the others are compared with."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [{"recordings": ["20261121-184500-00ff", "20261121-184610-01ab"], "channels": ["position.0"]}]
        }
    )

    recordings: Annotated[list[Annotated[str, StringConstraints(strict=True, max_length=60)]], Field(max_length=8)]
    channels: Annotated[list[ChannelName], Field(max_length=64)] | None = Field(
        default=None, description="null: all that at least two of them have"
    )
    align: Literal["trigger", "start", "move"] = Field(
        default="trigger",
        description="what is put at 0: the trigger, else the first row; always the first row; or the first start of a"
        " move, else as for trigger",
    )
    from_s: Number | None = None
    to_s: Number | None = None
    points: Annotated[int, Field(strict=True, ge=8, le=20_000)] = 2000


class DifferenceOut(Answer):
    samples: int = Field(description="times at which both are known")
    peak: float | None = Field(description="the largest, with its sign; null where they share no time")
    peak_at_s: float | None
    mean: float | None
    rms: float | None


class ComparedCurve(Answer):
    recording: str
    time_s: list[float]
    values: list[float | None]


class ComparedDifference(ComparedCurve):
    """What a recording is above the first, at its times, read off along straight lines between two samples."""

    figures: DifferenceOut


class ComparedChannel(Answer):
    channel: str
    unit: str
    curves: list[ComparedCurve]
    differences: list[ComparedDifference]


class ComparedRecording(Answer):
    id: str
    name: str
    colour: str
    device: str
    model: str
    zero_s: float = Field(description="device time that is 0 here [s]")
    from_s: float
    to_s: float
    figures: FiguresByChannel


class Comparison(Answer):
    from_s: float
    to_s: float
    recordings: list[ComparedRecording]
    channels: list[ComparedChannel]
    notes: list[str] = Field(description="what could not be compared, and why")


class PredictionOut(Comparison):
    """What the calculators expect of the commands in a recording: as a recording `predicted` beside the measured one.

    `differences` are the residual: measured less predicted. Nothing is predicted (null) where `notes` say so, and
    before the first command.
    """

    axis: int
    settings: str = Field(description="by which it was worked out: those of the recording, or a profile by its name")
    motions: int = Field(description="how many were predicted")


class ReplayStart(Body):
    """What a replay is made with."""

    model_config = ConfigDict(json_schema_extra={"examples": [{}, {"device": "slider", "name": "with a stage"}]})

    device: Annotated[str, StringConstraints(strict=True, min_length=1, max_length=200)] | None = Field(
        default=None,
        description="an emulated device of the bench, of the same model, whose motor and stage the emulator gets;"
        " null: those of the recording, where it was of an emulator, else the usual ones",
    )
    name: Text | None = None


class Replay(Answer):
    """How a replay goes: an emulator of its own lives through the recorded time as fast as it can."""

    of: str
    recording: str | None = Field(description="the new recording, as soon as it is there")
    state: Literal["running", "done", "failed"]
    message: str
    done_s: float = Field(description="how far it is [s]")
    duration_s: float
    played: int = Field(description="commands and writes so far")
    commands: int = Field(description="commands and writes in all")
    left_out: list[str] = Field(description="what cannot be replayed")
