"""Recordings as answers: the list, the figures, what a plot shows, and files for other programs."""

from __future__ import annotations

import io
from collections.abc import Sequence

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet
from numpy.typing import NDArray

from app.api.schemas import ChannelInfo
from app.api.schemas_recordings import (
    Curve,
    FiguresOut,
    MarkOut,
    RecordingDetail,
    RecordingInfo,
    RecordingPlot,
)
from app.calc.decimation import extremes
from app.calc.figures import figures
from app.links.errors import UnknownThing
from app.store.recordings.file import TIME, Rows
from app.store.recordings.head import Head
from app.store.recordings.library import Entry, span_s
from app.store.recordings.marks import Mark
from app.telemetry.recorder import Recorder


def info(entry: Entry, recorder: Recorder | None) -> RecordingInfo:
    """A line of the list. `recorder` is the one that wrote it, where it ran lately."""
    head = entry.head
    return RecordingInfo(
        id=entry.id,
        name=entry.label.name,
        note=entry.label.note,
        device=head.device if head else None,
        model=head.model if head else None,
        channels=[_channel(column.name, column.unit) for column in head.columns] if head else [],
        rate_hz=head.rate_hz if head else None,
        started_unix_s=head.started_unix_s if head else None,
        state=recorder.state if recorder else "done" if head else "failed",
        message=entry.problem or (recorder.message if recorder else ""),
        rows=recorder.rows if recorder else None,
        size_bytes=entry.size_bytes,
    )


def detail(entry: Entry, recorder: Recorder | None, head: Head, rows: Rows, marks: Sequence[Mark]) -> RecordingDetail:
    """Everything of one recording but its rows."""
    told = info(entry, recorder).model_dump()
    told["rows"] = len(rows.time_s)
    return RecordingDetail(
        **told,
        time_origin_unix_s=head.time_origin_unix_s,
        zero_s=zero_of(rows, marks),
        duration_s=span_s(rows),
        marks=[MarkOut.model_validate(mark) for mark in marks],
        figures={
            column.name: FiguresOut.model_validate(figures(rows.time_s, values))
            for column, values in zip(head.columns, rows.columns, strict=True)
        },
        configuration=None if head.configuration is None else dict(head.configuration),
    )


def zero_of(rows: Rows, marks: Sequence[Mark]) -> float | None:
    """Device time that plots call 0: the trigger's, else the first row's [s]."""
    triggered = next((mark.time_s for mark in marks if mark.kind == "trigger"), None)
    if triggered is not None or not len(rows.time_s):
        return triggered
    return float(rows.time_s[0])


def plot(
    head: Head,
    rows: Rows,
    marks: Sequence[Mark],
    channels: Sequence[str],
    from_s: float | None,
    to_s: float | None,
    points: int,
) -> RecordingPlot:
    """`channels` (none: all) between two times since the zero. Raises UnknownThing."""
    names = [column.name for column in head.columns]
    for name in channels:
        if name not in names:
            raise UnknownThing("recorded channel", name, names)
    zero_s = zero_of(rows, marks) or 0.0
    since_s = rows.time_s - zero_s
    first = 0 if from_s is None else int(np.searchsorted(since_s, from_s))
    last = len(since_s) if to_s is None else int(np.searchsorted(since_s, to_s, side="right"))
    shown = since_s[first:last]
    curves = []
    for column, values in zip(head.columns, rows.columns, strict=True):
        if not channels or column.name in channels:
            at_s, thinned = extremes(shown, values[first:last], points)
            curves.append(Curve(channel=column.name, unit=column.unit, time_s=at_s.tolist(), values=_json(thinned)))
    return RecordingPlot(
        zero_s=zero_s,
        from_s=float(shown[0]) if len(shown) else 0.0,
        to_s=float(shown[-1]) if len(shown) else 0.0,
        rows=len(shown),
        thinned=len(shown) > points,
        curves=curves,
    )


def csv_of(head: Head, rows: Rows) -> bytes:
    """A line a row, device time [s] first; a missing sample is an empty cell."""
    out = io.BytesIO()
    pyarrow.csv.write_csv(_table(head, rows, missing_is_null=True), out)
    return out.getvalue()


def parquet_of(head: Head, rows: Rows) -> bytes:
    """The same for programs; units and the whole head are in the file's metadata."""
    out = io.BytesIO()
    pyarrow.parquet.write_table(_table(head, rows), out, compression="zstd")
    return out.getvalue()


def _table(head: Head, rows: Rows, *, missing_is_null: bool = False) -> pa.Table:
    names = [TIME, *(column.name for column in head.columns)]
    units = ["s", *(column.unit for column in head.columns)]
    columns = [pa.array(values, from_pandas=missing_is_null) for values in (rows.time_s, *rows.columns)]
    fields = [pa.field(name, pa.float64(), metadata={"unit": unit}) for name, unit in zip(names, units, strict=True)]
    return pa.table(columns, schema=pa.schema(fields, metadata={"stepscope": head.encode()}))


def _json(values: NDArray[np.float64]) -> list[float | None]:
    return [None if value != value else value for value in values.tolist()]


def _channel(name: str, unit: str) -> ChannelInfo:
    quantity, _, axis = name.rpartition(".")
    return ChannelInfo(name=name, quantity=quantity, axis=int(axis) if axis.isdecimal() else 0, unit=unit)
