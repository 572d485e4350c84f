"""Recordings: telemetry that is kept."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Annotated, Literal, TypeVar

from fastapi import APIRouter, Path, Query
from fastapi.responses import Response

from app.api.deps import CurrentBench
from app.api.problems import problems
from app.api.recording_desk import configuration_of
from app.api.recording_views import csv_of, detail, info, parquet_of, plot
from app.api.schemas_recordings import (
    LevelTrigger,
    MoveTrigger,
    RecordingDetail,
    RecordingInfo,
    RecordingLabel,
    RecordingList,
    RecordingMark,
    RecordingPlot,
    RecordingStart,
)
from app.links.errors import OutOfRange, UnknownThing, UsageError, WrongState
from app.store.recordings.library import Label
from app.telemetry.recorder import Trigger

router = APIRouter(prefix="/recordings", tags=["recordings"])

RecordingId = Annotated[str, Path(description="as in the list", max_length=60)]
T = TypeVar("T")
ROWS_AS = {"csv": "text/csv", "parquet": "application/vnd.apache.parquet"}


async def _aside(work: Callable[[], T]) -> T:
    # A long recording takes tenths of a second to read: not on the loop that samples and stops motors.
    return await asyncio.to_thread(work)


@router.get("")
async def list_recordings(
    bench: CurrentBench,
    search: Annotated[str, Query(max_length=200, description="words of name, note, device or model")] = "",
    device: Annotated[str, Query(max_length=200, description="only those of this device")] = "",
) -> RecordingList:
    """All recordings, the latest first."""
    library = bench.desk.library
    entries = await _aside(lambda: library.entries(search, device))
    found = [info(entry, bench.desk.recorder(entry.id)) for entry in entries]
    return RecordingList(recordings=found, size_bytes=library.size_bytes)


@router.post("", status_code=201, responses=problems(UnknownThing, WrongState, OutOfRange, UsageError))
async def start_recording(bench: CurrentBench, body: RecordingStart) -> RecordingInfo:
    """Record channels of a device from now on, or from a trigger on with what was before it."""
    device = bench.manager.get(body.device)
    device.require_connected()
    wanted = body.trigger
    trigger = Trigger()
    if isinstance(wanted, MoveTrigger):
        trigger = Trigger("move", axis=wanted.axis, pre_s=wanted.pre_s)
    elif isinstance(wanted, LevelTrigger):
        trigger = Trigger("level", 0, wanted.channel, wanted.level, wanted.rising, wanted.pre_s)
    configuration = await configuration_of(device)
    label = Label(body.name, body.note)
    channels = tuple(dict.fromkeys(body.channels))
    recording = await bench.desk.start(device, channels, body.rate_hz, trigger, body.duration_s, label, configuration)
    return info(bench.desk.library.entry(recording), bench.desk.recorder(recording))


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
) -> RecordingDetail:
    """What a recording is of, its marks and figures; or with `format` all of its rows as a file."""
    desk = bench.desk
    head = await _aside(lambda: desk.library.head(recording))
    rows = await _aside(lambda: desk.library.rows(recording))
    if format != "json":
        content = await _aside(lambda: csv_of(head, rows) if format == "csv" else parquet_of(head, rows))
        named = {"content-disposition": f'attachment; filename="{recording}.{format}"'}
        return Response(content, media_type=ROWS_AS[format], headers=named)  # type: ignore[return-value]  # a file is no JSON
    entry, marks = desk.library.entry(recording), desk.library.marks(recording)
    return await _aside(lambda: detail(entry, desk.recorder(recording), head, rows, marks))


@router.get("/{recording}/plot", responses=problems(UnknownThing, WrongState, UsageError))
async def plot_recording(
    bench: CurrentBench,
    recording: RecordingId,
    channel: Annotated[list[str] | None, Query(description="only these", max_length=64)] = None,
    from_s: Annotated[float | None, Query(description="since the trigger [s]", allow_inf_nan=False)] = None,
    to_s: Annotated[float | None, Query(description="since the trigger [s]", allow_inf_nan=False)] = None,
    points: Annotated[int, Query(description="of each channel, about", ge=8, le=100_000)] = 3000,
) -> RecordingPlot:
    """What a plot of so many points shows, in full or of a stretch of it."""
    library = bench.desk.library
    head = await _aside(lambda: library.head(recording))
    rows = await _aside(lambda: library.rows(recording))
    marks = library.marks(recording)
    return await _aside(lambda: plot(head, rows, marks, channel or (), from_s, to_s, points))


@router.patch("/{recording}", responses=problems(UnknownThing))
async def label_recording(bench: CurrentBench, recording: RecordingId, body: RecordingLabel) -> RecordingInfo:
    """Another name or note."""
    library = bench.desk.library
    old = library.entry(recording).label
    library.label(
        recording,
        Label(old.name if body.name is None else body.name, old.note if body.note is None else body.note),
    )
    return info(library.entry(recording), bench.desk.recorder(recording))


@router.post("/{recording}/stop", responses=problems(UnknownThing))
async def stop_recording(bench: CurrentBench, recording: RecordingId) -> RecordingInfo:
    """End it with what is there; one that is over stays as it is."""
    await bench.desk.stop(recording)
    return info(bench.desk.library.entry(recording), bench.desk.recorder(recording))


@router.post("/{recording}/marks", responses=problems(UnknownThing, WrongState))
async def mark_recording(bench: CurrentBench, recording: RecordingId, body: RecordingMark) -> RecordingInfo:
    """Mark this moment of a recording that runs."""
    bench.desk.note(recording, body.text)
    return info(bench.desk.library.entry(recording), bench.desk.recorder(recording))


@router.delete("/{recording}", status_code=204, responses=problems(UnknownThing, WrongState))
async def delete_recording(bench: CurrentBench, recording: RecordingId) -> None:
    """Gone for good."""
    bench.desk.library.delete(recording)
