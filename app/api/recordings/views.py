"""Recordings as answers: the list, the figures, what a plot shows, and files for other programs."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...calc.signals.alignment import REACH, at_times, usual_interval_s
from ...calc.signals.decimation import extremes
from ...calc.signals.statistics import Piece, statistics
from ...errors import UnknownThing
from ...recording.service import Course
from ...store.recordings.added import Added, AddedRows
from ...store.recordings.file import TIME, Rows
from ...store.recordings.head import Head
from ...store.recordings.library import Entry
from ...store.recordings.marks import Mark
from ...store.recordings.notebook import Notebook
from ...store.recordings.opened import Opened
from ...telemetry.frames import encode_body, encode_header
from ..schemas import ChannelInfo
from .schemas import (
    AddedFile,
    CellOut,
    Curve,
    FiguresOut,
    MarkOut,
    RecordingDetail,
    RecordingFigures,
    RecordingInfo,
    RecordingPlot,
)

if TYPE_CHECKING:
    import pyarrow as pa  # at run time by who makes a file, as in `store.recordings.file`


def info(entry: Entry, course: Course | None) -> RecordingInfo:
    """A line of the list. `course` is how it goes or went, where it ran lately."""
    head = entry.head
    return RecordingInfo(
        id=entry.id,
        name=entry.label.name,
        note=entry.label.note,
        tags=list(entry.label.tags),
        colour=entry.label.colour,
        device=head.device if head else None,
        model=head.model if head else None,
        channels=[_channel(column.name, column.unit) for column in head.columns] if head else [],
        rate_hz=head.rate_hz if head else None,
        started_unix_s=head.started_unix_s if head else None,
        state=course.state if course else "recording" if entry.recording else "done" if head else "failed",
        message=entry.problem or (course.message if course else ""),
        rows=course.rows if course else None,
        size_bytes=entry.size_bytes,
    )


def detail(
    entry: Entry,
    course: Course | None,
    opened: Opened,
    marks: Sequence[Mark],
    notebook: Notebook,
    added: Sequence[Added] = (),
    *,
    with_figures: bool = True,
) -> RecordingDetail:
    """Everything of one recording but its rows. Figures are of all rows, which have to be read for them."""
    told = info(entry, course).model_dump()
    rows = told["rows"] = opened.rows  # of this moment: it may be growing
    head = opened.head
    return RecordingDetail(
        **told,
        time_origin_unix_s=head.time_origin_unix_s,
        zero_s=zero_of(opened, marks),
        duration_s=(opened.last_s or 0.0) - (opened.first_s or 0.0),
        marks=[MarkOut.model_validate(mark) for mark in marks],
        notebook=[CellOut.model_validate(cell) for cell in notebook.cells],
        notebook_revision=notebook.revision,
        added=[added_file(each) for each in added],
        figures=figures_of(head, lambda: opened.pieces(0, rows)) if with_figures else {},
        configuration=None if head.configuration is None else dict(head.configuration),
        replay_of=head.replay_of,
    )


def added_file(of: Added) -> AddedFile:
    """A file beside a recording."""
    return AddedFile(
        number=of.number,
        name=of.name,
        instrument=of.instrument,
        channels=[ChannelInfo(name=each.name, quantity=each.name, axis=0, unit=each.unit) for each in of.columns],
        rows=of.rows,
        from_s=of.from_s + of.offset_s,
        to_s=of.to_s + of.offset_s,
        offset_s=of.offset_s,
        aligned=of.aligned,
        notes=list(of.notes),
    )


def figures_of_added(files: Sequence[AddedRows], from_s: float | None, to_s: float | None) -> dict[str, FiguresOut]:
    """By channel, of what lies between two times since the zero."""
    told: dict[str, FiguresOut] = {}
    for each in files:
        part = slice(*_between(each, from_s, to_s))
        rows = Rows(each.time_s[part], each.columns[:, part])
        found = statistics(lambda rows=rows: iter([(rows.time_s, rows.columns)]), len(rows.columns))  # type: ignore[misc]
        names = [column.name for column in each.of.columns]
        told |= {name: FiguresOut.model_validate(one) for name, one in zip(names, found, strict=True)}
    return told


def curves_of_added(
    files: Sequence[AddedRows], channels: Sequence[str], from_s: float | None, to_s: float | None, points: int
) -> list[Curve]:
    """`channels` (none: all) between two times since the zero, each at most about `points`, its extremes kept."""
    curves = []
    for each in files:
        first, last = _between(each, from_s, to_s)
        first, last = max(0, first - 1), min(len(each.time_s), last + 1)  # a line reaches the edge of the plot
        for column, values in zip(each.of.columns, each.columns, strict=True):
            if not channels or column.name in channels:
                at_s, thinned = extremes(each.time_s[first:last], values[first:last], points)
                curves.append(
                    Curve(channel=column.name, unit=column.unit, time_s=at_s.tolist(), values=nothing_as_null(thinned))
                )
    return curves


def part_of(rows: AddedRows, shift_s: float, from_s: float | None, to_s: float | None) -> AddedRows:
    """What lies between two times, `shift_s` later than it says [s]."""
    shifted = replace(rows, time_s=rows.time_s + shift_s)
    part = slice(*_between(shifted, from_s, to_s))
    return AddedRows(rows.of, shifted.time_s[part], rows.columns[:, part])


def beside(
    head: Head, pieces: Iterable[Rows], added: Sequence[AddedRows], zero_s: float
) -> tuple[Head, Iterator[Rows]]:
    """A recording with the channels of files beside it as further columns, read off at its rows' times.

    Between two samples along the straight line; missing before the first, behind the last, and in gaps.
    """
    files = [(each, REACH * usual_interval_s(each.time_s)) for each in added]

    def wider() -> Iterator[Rows]:
        for rows in pieces:
            since_s = rows.time_s - zero_s
            read = [
                at_times(each.time_s, values, since_s, reach_s) for each, reach_s in files for values in each.columns
            ]
            yield Rows(rows.time_s, np.vstack((rows.columns, *read)))

    further = [column for each in added for column in each.of.columns]
    return replace(head, columns=(*head.columns, *further)), wider()


def _between(rows: AddedRows, from_s: float | None, to_s: float | None) -> tuple[int, int]:
    first = 0 if from_s is None else int(np.searchsorted(rows.time_s, from_s))
    last = len(rows.time_s) if to_s is None else int(np.searchsorted(rows.time_s, to_s, "right"))
    return first, max(first, last)


def figures_of(head: Head, pieces: Callable[[], Iterable[Rows]]) -> dict[str, FiguresOut]:
    """By channel, and by axis what the motor was away from its planned position. `pieces` are gone through twice."""
    names = [column.name for column in head.columns]
    away: dict[str, tuple[int, int]] = {}
    for number, name in enumerate(names):
        quantity, _, axis = name.rpartition(".")
        planned = f"predicted_position.{axis}"
        # The encoder knows where the motor is; without one the chip's own count is the best there is.
        if planned in names and (
            quantity == "encoder_position" or (quantity == "position" and f"encoder_position.{axis}" not in names)
        ):
            away[f"following_error.{axis}"] = number, names.index(planned)

    def with_errors() -> Iterator[Piece]:
        for rows in pieces():
            errors = [rows.columns[number] - rows.columns[planned] for number, planned in away.values()]
            yield rows.time_s, np.stack((*rows.columns, *errors))

    told = [*names, *away]
    found = statistics(with_errors, len(told))
    return {name: FiguresOut.model_validate(one) for name, one in zip(told, found, strict=True)}


def zero_of(opened: Opened, marks: Sequence[Mark]) -> float | None:
    """Device time that plots call 0: the trigger's, else the first row's [s]."""
    return next((mark.time_s for mark in marks if mark.kind == "trigger"), opened.first_s)


def rows_between(opened: Opened, zero_s: float, from_s: float | None, to_s: float | None) -> tuple[int, int]:
    """Numbers of the rows between two times since the zero: (first, behind the last)."""
    first = 0 if from_s is None else opened.row_at(from_s + zero_s)
    last = opened.rows if to_s is None else opened.row_at(to_s + zero_s, "right")
    return first, max(first, last)


def stretch_figures(
    opened: Opened,
    marks: Sequence[Mark],
    from_s: float | None,
    to_s: float | None,
    added: Sequence[AddedRows] = (),
) -> RecordingFigures:
    """Figures of what lies between two times since the zero."""
    zero_s = zero_of(opened, marks) or 0.0
    first, last = rows_between(opened, zero_s, from_s, to_s)
    begin_s, end_s = ends_of(opened, first, last, zero_s)
    found = figures_of(opened.head, lambda: opened.pieces(first, last))
    return RecordingFigures(from_s=begin_s, to_s=end_s, figures=found | figures_of_added(added, from_s, to_s))


def ends_of(opened: Opened, first: int, last: int, zero_s: float) -> tuple[float, float]:
    """Times since the zero of the row `first` and of the one before `last` [s]; 0 where there is none."""
    if last <= first:
        return 0.0, 0.0
    begin, end = opened.read(first, first + 1).time_s, opened.read(last - 1, last).time_s
    return float(begin[0] - zero_s), float(end[0] - zero_s)


def plot(
    opened: Opened,
    marks: Sequence[Mark],
    channels: Sequence[str],
    from_s: float | None,
    to_s: float | None,
    points: int,
    added: Sequence[AddedRows] = (),
) -> RecordingPlot:
    """`channels` (none: all) between two times since the zero. Raises UnknownThing."""
    head = opened.head
    require_channels(head, channels, added)
    zero_s = zero_of(opened, marks) or 0.0
    first, last = rows_between(opened, zero_s, from_s, to_s)
    # Of a segment three points may be left: its extremes, and one where a sample is missing. Two more are its ends.
    segments = opened.segments(first, last, points if last - first <= points else max(1, points // 3 - 2))
    curves = []
    for number, column in enumerate(head.columns):
        if not channels or column.name in channels:
            at_s, values = segments.points(number)
            curves.append(
                Curve(
                    channel=column.name,
                    unit=column.unit,
                    time_s=(at_s - zero_s).tolist(),
                    values=nothing_as_null(values),
                )
            )
    begin_s, end_s = ends_of(opened, first, last, zero_s)
    return RecordingPlot(
        zero_s=zero_s,
        from_s=begin_s,
        to_s=end_s,
        rows=last - first,
        thinned=last - first > points,
        curves=[*curves, *curves_of_added(added, channels, from_s, to_s, points)],
    )


def plot_frame(
    opened: Opened, marks: Sequence[Mark], from_s: float | None, to_s: float | None, points: int
) -> tuple[bytes, int]:
    """The same for a page that zooms, as one telemetry frame of all channels, and how many rows it stands for.

    Times count from the zero. All channels share them: a segment is two points, its extremes in their order.
    """
    zero_s = zero_of(opened, marks) or 0.0
    first, last = rows_between(opened, zero_s, from_s, to_s)
    wanted = points if last - first <= points else points // 2
    time_s, columns = opened.segments(first, last, wanted).line()
    frame = encode_header(0, 0, len(time_s), len(columns)) + encode_body(time_s - zero_s, columns.T)
    return frame, last - first


def require_channels(head: Head, channels: Sequence[str], added: Sequence[AddedRows] = ()) -> None:
    """Raises UnknownThing for one that was not recorded and lies not beside it."""
    names = [column.name for columns in (head.columns, *(each.of.columns for each in added)) for column in columns]
    for name in channels:
        if name not in names:
            raise UnknownThing("recorded channel", name, names)


def csv_of(head: Head, pieces: Iterable[Rows]) -> Iterator[bytes]:
    """A line a row, device time [s] first; a missing sample is an empty cell. Of no rows the names alone."""
    import pyarrow.csv

    first = True
    for rows in chain(pieces, (Rows(np.empty(0), np.empty((len(head.columns), 0))),)):
        out = io.BytesIO()
        options = pyarrow.csv.WriteOptions(include_header=first)
        pyarrow.csv.write_csv(_table(head, rows, missing_is_null=True), out, options)
        first = False
        yield out.getvalue()


def parquet_of(head: Head, pieces: Iterable[Rows]) -> Iterator[bytes]:
    """The same for programs; units and the whole head are in the file's metadata."""
    import pyarrow.parquet

    out = _Taken()
    with pyarrow.parquet.ParquetWriter(out, _schema(head), compression="zstd") as writer:
        for rows in pieces:
            writer.write_table(_table(head, rows))
            yield out.take()
    yield out.take()


class _Taken(io.RawIOBase):
    """A file whose bytes are taken away while it is written."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []

    def writable(self) -> bool:
        return True

    def write(self, data: Any, /) -> int:
        self._parts.append(bytes(data))
        return len(self._parts[-1])

    def take(self) -> bytes:
        taken, self._parts = b"".join(self._parts), []
        return taken


def _schema(head: Head) -> pa.Schema:
    import pyarrow as pa

    units = [(TIME, "s"), *((column.name, column.unit) for column in head.columns)]
    fields = [pa.field(name, pa.float64(), metadata={"unit": unit}) for name, unit in units]
    return pa.schema(fields, metadata={"stepscope": head.encode()})


def _table(head: Head, rows: Rows, *, missing_is_null: bool = False) -> pa.Table:
    import pyarrow as pa

    columns = [pa.array(values, from_pandas=missing_is_null) for values in (rows.time_s, *rows.columns)]
    return pa.table(columns, schema=_schema(head))


def nothing_as_null(values: NDArray[np.float64]) -> list[float | None]:
    """For JSON, which has no NaN."""
    return [None if value != value else value for value in values.tolist()]


def _channel(name: str, unit: str) -> ChannelInfo:
    quantity, _, axis = name.rpartition(".")
    return ChannelInfo(name=name, quantity=quantity, axis=int(axis) if axis.isdecimal() else 0, unit=unit)
