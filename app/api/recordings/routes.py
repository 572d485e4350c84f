"""Recordings: telemetry that is kept."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Annotated, Literal, TypeVar

from fastapi import Body, HTTPException, Path, Query
from fastapi.responses import Response, StreamingResponse

from ...calc.signals.instrument_csv import FILE_MAX_BYTES, read_table
from ...calc.signals.spectrum import Detrend, Window
from ...errors import OutOfRange, StoreUnavailable, UnknownThing, UsageError, WrongState
from ...profiles.errors import UnreadableProfile
from ...recording.service import axes_of, configuration_of, options_of
from ...store.recordings.added import FILES_MAX
from ...store.recordings.library import Entry, Label
from ...store.recordings.marks import Mark
from ...store.recordings.notebook import Cell
from ...store.recordings.opened import Opened
from ...telemetry.recorder import Trigger
from ..audit import wording
from ..deps import CurrentBench
from ..http.problems import problems
from ..policy import policy
from ..profiles.views import detail as profile_detail
from ..router import subject_router
from .align import offset_of
from .compare import compare, spectrum_of
from .predict import predict as predicted
from .report import WrittenCell, report_of
from .schemas import (
    AddedFile,
    Align,
    CompareWith,
    Comparison,
    LevelTrigger,
    MoveTrigger,
    PredictionOut,
    RecordingDetail,
    RecordingFigures,
    RecordingInfo,
    RecordingLabel,
    RecordingList,
    RecordingMark,
    RecordingPlot,
    RecordingStart,
    Replay,
    ReplayStart,
    Spectrum,
)
from .views import added_file, beside, csv_of, detail, info, parquet_of, plot, plot_frame, stretch_figures, zero_of

router = subject_router(prefix="/recordings", tags=["recordings"])

RecordingId = Annotated[str, Path(description="as in the list", max_length=60)]
Since = Annotated[float | None, Query(description="since the zero [s]", allow_inf_nan=False)]
READ_WITHIN_S = 0.05
"""How long a page of the list reads files that were never read [s]."""
REPORT_POINTS = 1500
"""Of a curve in a report that is 640 px wide: twice what can be seen."""
FRAME = "application/vnd.stepscope.frame"
T = TypeVar("T")
ROWS_AS = {"csv": "text/csv", "parquet": "application/vnd.apache.parquet"}


async def _aside(work: Callable[[], T]) -> T:
    # The disk may be slow: not on the loop that samples and stops motors.
    return await asyncio.to_thread(work)


@router.get("")
async def list_recordings(
    bench: CurrentBench,
    search: Annotated[str, Query(max_length=200, description="words of name, note, device or model")] = "",
    device: Annotated[str, Query(max_length=200, description="only those of this device")] = "",
    limit: Annotated[int, Query(ge=1, le=1000, description="how many at the most")] = 100,
    before: Annotated[str, Query(max_length=60, description="`next` of the page before")] = "",
) -> RecordingList:
    """Recordings, the latest first, page by page; a page ends early where files have to be read for too long."""
    library = bench.recordings.library
    page, free_bytes = await _aside(
        lambda: (library.page(search, device, limit, before, READ_WITHIN_S), library.free_bytes)
    )
    found = [info(entry, bench.recordings.course(entry.id)) for entry in page.entries]
    room_bytes = max(0, free_bytes - bench.recordings.reserve_bytes)
    return RecordingList(
        recordings=found,
        next=page.next,
        total=page.total,
        unread=page.unread,
        size_bytes=page.size_bytes,
        free_bytes=free_bytes,
        room_bytes=room_bytes,
    )


@router.post("/compare", responses=problems(UnknownThing, WrongState, UsageError, OutOfRange))
@policy(lease="free", role="look", audit="silent")
async def compare_recordings(bench: CurrentBench, body: CompareWith) -> Comparison:
    """Lay recordings on each other: aligned curves, what each is above the first, their figures side by side."""
    return await bench.recordings.readers.do(lambda: compare(bench.recordings.library, body))


@router.api_route("/compare", methods=["GET", "PUT", "PATCH", "DELETE"], include_in_schema=False)
async def no_recording_is_called_compare() -> None:
    """Keep `/recordings/{recording}` from taking this address for a recording."""
    raise HTTPException(405, headers={"Allow": "POST"})


@router.post("", status_code=201, responses=problems(UnknownThing, WrongState, OutOfRange, UsageError))
@policy(lease="free", words=wording.named("start recording"))
async def start_recording(bench: CurrentBench, body: RecordingStart) -> RecordingInfo:
    """Record channels of a device from now on, or from a trigger on with what was before it."""
    device = bench.manager.get(body.device)
    device.session.require_connected()
    wanted = body.trigger
    trigger = Trigger()
    if isinstance(wanted, MoveTrigger):
        trigger = Trigger("move", axis=wanted.axis, pre_s=wanted.pre_s)
    elif isinstance(wanted, LevelTrigger):
        trigger = Trigger("level", 0, wanted.channel, wanted.level, wanted.rising, wanted.pre_s)
    configuration, axes = await configuration_of(device), await axes_of(device)
    label = Label(body.name, body.note)
    channels = tuple(dict.fromkeys(body.channels))
    recording = await bench.recordings.start(
        device, channels, body.rate_hz, trigger, body.duration_s, label, configuration, axes
    )
    return info(bench.recordings.library.entry(recording), bench.recordings.course(recording))


@router.get(
    "/{recording}",
    responses={
        **problems(UnknownThing, WrongState),
        200: {"content": {media: {"schema": {"type": "string", "format": "binary"}} for media in ROWS_AS.values()}},
    },
)
async def get_recording(
    bench: CurrentBench,
    recording: RecordingId,
    format: Annotated[Literal["json", "csv", "parquet"], Query(description="json: what it is; else its rows")] = "json",  # noqa: A002
    figures: Annotated[bool, Query(description="false: without figures, which take a reading of all rows")] = True,
) -> RecordingDetail:
    """What a recording is of, its marks and figures; or with `format` all of its rows as a file.

    In a file the channels of files beside it are read off at the recording's times.
    """
    recordings = bench.recordings
    opened = await recordings.readers.do(lambda: recordings.library.open(recording))
    if format != "json":
        write = csv_of if format == "csv" else parquet_of
        head, rows = opened.head, opened.pieces(0, opened.rows)
        added = await recordings.readers.do(lambda: recordings.library.rows_of_added(recording))
        if added:
            marks = await _aside(lambda: recordings.library.marks(recording))
            head, rows = beside(head, rows, added, zero_of(opened, marks) or 0.0)
        content = await recordings.readers.stream(write(head, rows))
        named = {"content-disposition": f'attachment; filename="{recording}.{format}"'}
        return StreamingResponse(content, media_type=ROWS_AS[format], headers=named)  # type: ignore[return-value]  # a file is no JSON
    course = recordings.course(recording)
    return await recordings.readers.do(
        lambda: detail(
            recordings.library.entry(recording),
            course,
            opened,
            recordings.library.marks(recording),
            recordings.library.notebook(recording),
            recordings.library.added(recording),
            with_figures=figures,
        )
    )


@router.get("/{recording}/info", responses=problems(UnknownThing))
async def get_recording_info(bench: CurrentBench, recording: RecordingId) -> RecordingInfo:
    """Its line of the list: how far one is that runs."""
    entry = await _aside(lambda: bench.recordings.library.entry(recording))
    return info(entry, bench.recordings.course(recording))


@router.get(
    "/{recording}/plot",
    responses={
        **problems(UnknownThing, WrongState, UsageError),
        200: {"content": {FRAME: {"schema": {"type": "string", "format": "binary"}}}},
    },
)
async def plot_recording(
    bench: CurrentBench,
    recording: RecordingId,
    channel: Annotated[list[str] | None, Query(description="only these", max_length=64)] = None,
    from_s: Since = None,
    to_s: Since = None,
    points: Annotated[int, Query(description="of each channel, about", ge=8, le=100_000)] = 3000,
    format: Annotated[  # noqa: A002
        Literal["json", "frame"],
        Query(description="frame: a telemetry frame of all channels, times since the zero; what zooms without stutter"),
    ] = "json",
) -> RecordingPlot:
    """What a plot of so many points shows, in full or of a stretch of it."""
    library = bench.recordings.library
    readers = bench.recordings.readers
    opened = await readers.do(lambda: library.open(recording))
    marks = await _aside(lambda: library.marks(recording))
    if format == "frame":
        if channel:
            raise UsageError("a frame is of all channels")
        frame, rows = await readers.do(lambda: plot_frame(opened, marks, from_s, to_s, points))
        return Response(frame, media_type=FRAME, headers={"stepscope-rows": str(rows)})  # type: ignore[return-value]
    return await readers.do(
        lambda: plot(opened, marks, channel or (), from_s, to_s, points, library.rows_of_added(recording))
    )


@router.get("/{recording}/figures", responses=problems(UnknownThing, WrongState))
async def get_recording_figures(
    bench: CurrentBench, recording: RecordingId, from_s: Since = None, to_s: Since = None
) -> RecordingFigures:
    """Figures of a stretch: of what a plot shows, between two cursors."""
    library = bench.recordings.library
    return await bench.recordings.readers.do(
        lambda: stretch_figures(
            library.open(recording), library.marks(recording), from_s, to_s, library.rows_of_added(recording)
        )
    )


@router.get(
    "/{recording}/report",
    response_class=Response,
    responses={
        **problems(UnknownThing, WrongState, OutOfRange),
        200: {"content": {"text/html": {"schema": {"type": "string"}}}},
    },
)
async def get_recording_report(
    bench: CurrentBench,
    recording: RecordingId,
    from_s: Since = None,
    to_s: Since = None,
    predict: Annotated[list[int] | None, Query(description="axes to be laid beside a prediction", max_length=9)] = None,
) -> Response:
    """Plots, marks and figures, in full or of a stretch, as one HTML file that needs nothing else."""
    library, course = bench.recordings.library, bench.recordings.course(recording)

    def report() -> str:
        opened, marks = library.open(recording), library.marks(recording)
        entry, notes = library.entry(recording), library.notebook(recording)
        about = detail(entry, course, opened, marks, notes, library.added(recording), with_figures=False)
        added = library.rows_of_added(recording)
        shown = plot(opened, marks, (), from_s, to_s, REPORT_POINTS, added)
        cells = [written(opened, marks, cell) for cell in notes.cells]
        figures = stretch_figures(opened, marks, from_s, to_s, added)
        axes = dict.fromkeys(predict or ())
        predictions = [predicted(library, recording, axis, None, from_s, to_s, REPORT_POINTS) for axis in axes]
        return report_of(about, shown, figures, from_s, to_s, cells, predictions)

    def written(opened: Opened, marks: Sequence[Mark], cell: Cell) -> WrittenCell:
        known = [column.name for column in opened.head.columns]
        names = [name for name in cell.channels if name in known]
        drawn = plot(opened, marks, names, cell.from_s, cell.to_s, REPORT_POINTS) if cell.kind == "figure" else None
        told = stretch_figures(opened, marks, cell.from_s, cell.to_s) if cell.kind == "table" else None
        if told and names:
            told.figures = {name: of for name, of in told.figures.items() if name in names}
        return cell.text, drawn, told

    named = {"content-disposition": f'attachment; filename="recording-{recording}.html"'}
    return Response(await bench.recordings.readers.do(report), media_type="text/html", headers=named)


@router.get("/{recording}/spectrum", responses=problems(UnknownThing, WrongState, OutOfRange))
async def get_spectrum(
    bench: CurrentBench,
    recording: RecordingId,
    channel: Annotated[str, Query(max_length=80)],
    from_s: Since = None,
    to_s: Since = None,
    window: Annotated[Window, Query(description="flattop tells amplitudes, none tells close sines apart")] = "hann",
    detrend: Annotated[
        Detrend, Query(description="what is taken off first: the mean, the best straight line")
    ] = "line",
    points: Annotated[int, Query(description="lines at the most", ge=8, le=100_000)] = 4000,
) -> Spectrum:
    """What a channel swings at, one of a file beside it too: amplitudes and power density over frequency."""
    library = bench.recordings.library
    return await bench.recordings.readers.do(
        lambda: spectrum_of(
            library.open(recording),
            library.marks(recording),
            channel,
            from_s,
            to_s,
            window,
            detrend,
            points,
            library.rows_of_added(recording),
        )
    )


@router.get(
    "/{recording}/prediction",
    responses=problems(UnknownThing, WrongState, UsageError, OutOfRange, UnreadableProfile, StoreUnavailable),
)
async def predict_recording(
    bench: CurrentBench,
    recording: RecordingId,
    axis: Annotated[int, Query(ge=0, le=31)] = 0,
    profile: Annotated[
        int | None, Query(ge=1, le=1 << 53, description="a kept profile to work it out by; none: as it was set then")
    ] = None,
    from_s: Since = None,
    to_s: Since = None,
    points: Annotated[int, Query(description="of each curve, about", ge=8, le=20_000)] = 3000,
) -> PredictionOut:
    """What the calculators expect of the commands in it, beside what was measured, and the residual.

    Worked out from the settings at the start and the writes meanwhile; where they are not known it says so.
    """
    library = bench.recordings.library
    document = None if profile is None else profile_detail(await bench.profile_store.get(profile)).document
    return await bench.recordings.readers.do(
        lambda: predicted(library, recording, axis, document, from_s, to_s, points)
    )


@router.patch("/{recording}", responses=problems(UnknownThing, UsageError, WrongState, StoreUnavailable))
@policy(lease="free", words=wording.named("edit recording"))
async def label_recording(bench: CurrentBench, recording: RecordingId, body: RecordingLabel) -> RecordingInfo:
    """Another name, note, colour, other tags, or another notebook."""
    library = bench.recordings.library

    def relabel() -> Entry:
        if body.notebook is not None:
            cells = [Cell(each.kind, each.text, each.from_s, each.to_s, tuple(each.channels)) for each in body.notebook]
            library.write_notebook(recording, cells, body.notebook_revision)
        said = body.model_dump(exclude_none=True, exclude={"notebook", "notebook_revision"})
        if said:
            tags = said.get("tags")
            changed = said if tags is None else {**said, "tags": tuple(dict.fromkeys(tags))}
            library.label(recording, replace(library.entry(recording).label, **changed))
        return library.entry(recording)

    return info(await _aside(relabel), bench.recordings.course(recording))


@router.post("/{recording}/stop", responses=problems(UnknownThing))
@policy(lease="free", words=wording.named("stop recording"))
async def stop_recording(bench: CurrentBench, recording: RecordingId) -> RecordingInfo:
    """End it with what is there; one that is over stays as it is."""
    await bench.recordings.stop(recording)
    return info(bench.recordings.library.entry(recording), bench.recordings.course(recording))


@router.post(
    "/{recording}/replay", status_code=202, responses=problems(UnknownThing, WrongState, UsageError, OutOfRange)
)
@policy(lease="free", words=wording.named("replay recording"))
async def replay_recording(bench: CurrentBench, recording: RecordingId, body: ReplayStart | None = None) -> Replay:
    """Live through it once more on an emulator of its own, which takes a fraction of the time; nothing moves here.

    The answer comes at once: GET tells how it goes, and the new recording's id.
    """
    asked = body or ReplayStart()
    options = None
    if asked.device is not None:
        device, head = bench.manager.get(asked.device), (await _aside(lambda: bench.recordings.library.head(recording)))
        if not device.session.emulated or device.model != head.model:
            raise WrongState(f"{device.name} is no emulated {head.model}", "name one that is, or none")
        options = options_of(device)
    return Replay.model_validate(await bench.recordings.replay(recording, options, asked.name))


@router.get("/{recording}/replay", responses=problems(UnknownThing))
async def get_replay(bench: CurrentBench, recording: RecordingId) -> Replay | None:
    """How the latest replay of this recording goes, or went; null where this server has made none."""
    progress = await _aside(lambda: bench.recordings.progress(recording))
    return None if progress is None else Replay.model_validate(progress)


@router.post("/{recording}/marks", responses=problems(UnknownThing, WrongState))
@policy(lease="free", words=wording.named("mark recording"))
async def mark_recording(bench: CurrentBench, recording: RecordingId, body: RecordingMark) -> RecordingInfo:
    """Mark this moment of a recording that runs."""
    bench.recordings.note(recording, body.text)
    return info(bench.recordings.library.entry(recording), bench.recordings.course(recording))


@router.delete("/{recording}", status_code=204, responses=problems(UnknownThing, WrongState, StoreUnavailable))
@policy(words=wording.named("delete recording"))
async def delete_recording(bench: CurrentBench, recording: RecordingId) -> None:
    """Gone for good."""
    await _aside(lambda: bench.recordings.delete(recording))


Number = Annotated[int, Path(ge=0, lt=FILES_MAX, description="the file's")]


@router.post(
    "/{recording}/added",
    status_code=201,
    responses=problems(UnknownThing, UsageError, WrongState, StoreUnavailable),
)
@policy(lease="free", words=wording.named("add file to recording"))
async def add_file(
    bench: CurrentBench,
    recording: RecordingId,
    name: Annotated[str, Query(min_length=1, max_length=100, description="the file's")],
    content: Annotated[bytes, Body(media_type="text/csv", max_length=FILE_MAX_BYTES)],
) -> AddedFile:
    """Lay a CSV file of an oscilloscope or another instrument beside a recording, its 0 on the recording's zero."""
    library = bench.recordings.library

    def add() -> AddedFile:
        library.entry(recording)
        return added_file(library.add(recording, name, read_table(content), 0.0, "its 0 on the recording's zero"))

    return await bench.recordings.readers.do(add)


@router.patch("/{recording}/added/{number}", responses=problems(UnknownThing, UsageError, WrongState, StoreUnavailable))
@policy(lease="free", words=wording.named("align file with recording"))
async def align_file(bench: CurrentBench, recording: RecordingId, number: Number, body: Align) -> AddedFile:
    """Put a file's time elsewhere on the recording's: by a figure, on a mark, or where a channel looks like one."""
    library = bench.recordings.library
    return await bench.recordings.readers.do(
        lambda: added_file(library.align(recording, number, *offset_of(library, recording, number, body)))
    )


@router.delete("/{recording}/added/{number}", status_code=204, responses=problems(UnknownThing, StoreUnavailable))
@policy(words=wording.named("remove file from recording"))
async def remove_file(bench: CurrentBench, recording: RecordingId, number: Number) -> None:
    """Forget a file that lies beside a recording."""
    await _aside(lambda: bench.recordings.library.take_away(recording, number))
