"""Recordings laid on each other: at one zero, one read off at the other's times, their spectra and figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...calc.signals.alignment import REACH, at_times, difference_of, usual_interval_s
from ...calc.signals.decimation import extremes
from ...calc.signals.min_max_pyramid import MinMaxSegments, size_for
from ...calc.signals.spectrum import SAMPLES_MAX, Detrend, Window, spectrum
from ...errors import OutOfRange, UnknownThing, UsageError, WrongState
from ...store.recordings.added import AddedRows
from ...store.recordings.file import FloatArray, Rows
from ...store.recordings.head import Column
from ...store.recordings.library import Library
from ...store.recordings.marks import Mark
from ...store.recordings.opened import Opened
from . import schemas as out
from .views import (
    figures_of,
    figures_of_added,
    nothing_as_null,
    part_of,
    require_channels,
    rows_between,
    zero_of,
)

ROWS_MAX = 4_000_000
"""Of all compared recordings together: their rows are read whole, which takes 300 MB at eight channels each."""


@dataclass(frozen=True, slots=True)
class _Side:
    """One of the recordings: `rows` between the times asked for, counted from its zero."""

    id: str
    name: str
    colour: str
    opened: Opened
    zero_s: float
    rows: Rows
    added: Sequence[AddedRows]
    """Files that lie beside it, likewise."""

    @property
    def offered(self) -> list[str]:
        return [column.name for columns in self._columns for column in columns]

    def samples(self, channel: str) -> _Samples | None:
        """Those of a channel, of whatever measured it; None where nothing did."""
        measured: tuple[Rows | AddedRows, ...] = (self.rows, *self.added)
        for columns, rows in zip(self._columns, measured, strict=True):
            for column, values in zip(columns, rows.columns, strict=True):
                if column.name == channel:
                    return _Samples(rows.time_s, values, column.unit)
        return None

    @property
    def _columns(self) -> list[tuple[Column, ...]]:
        return [self.opened.head.columns, *(each.of.columns for each in self.added)]


class _Samples(NamedTuple):
    time_s: FloatArray
    values: FloatArray
    unit: str


def compare(library: Library, body: out.CompareWith) -> out.Comparison:
    """Raises UnknownThing, WrongState for files that cannot be read, UsageError, OutOfRange for too much at once."""
    if len(set(body.recordings)) < 2:
        raise UsageError("a comparison is of two recordings at least")
    notes: list[str] = []
    sides = _sides(library, body, notes)
    offered = [name for side in sides for name in side.offered]
    wanted = body.channels
    if wanted is None:
        wanted = [name for name in dict.fromkeys(offered) if offered.count(name) > 1]
        if not wanted:
            notes.append("no channel is in two of these recordings")
    for name in wanted:
        if name not in offered:
            raise UnknownThing("recorded channel", name, sorted(set(offered)))
    spans = [side.rows.time_s[[0, -1]] for side in sides if len(side.rows.time_s)]
    return out.Comparison(
        from_s=float(min((span[0] for span in spans), default=0.0)),
        to_s=float(max((span[1] for span in spans), default=0.0)),
        recordings=[_recording(side) for side in sides],
        channels=[_channel(sides, name, body.points, notes) for name in wanted],
        notes=notes,
    )


def _sides(library: Library, body: out.CompareWith, notes: list[str]) -> list[_Side]:
    sides: list[_Side] = []
    rows = 0
    for recording in dict.fromkeys(body.recordings):
        entry, opened, marks = library.entry(recording), library.open(recording), library.marks(recording)
        name = entry.label.name or recording
        zero_s = _zero(body.align, opened, marks, name, notes)
        first, last = rows_between(opened, zero_s, body.from_s, body.to_s)
        rows += last - first
        if rows > ROWS_MAX:
            raise OutOfRange("rows to compare", rows, 0, ROWS_MAX, "rows; compare a part of them: from_s, to_s")
        read = opened.read(first, last)
        shift_s = (zero_of(opened, marks) or 0.0) - zero_s
        added = [part_of(each, shift_s, body.from_s, body.to_s) for each in library.rows_of_added(recording)]
        rows += sum(len(each.time_s) for each in added)
        sides.append(
            _Side(recording, name, entry.label.colour, opened, zero_s, Rows(read.time_s - zero_s, read.columns), added)
        )
    return sides


def _zero(align: str, opened: Opened, marks: Sequence[Mark], name: str, notes: list[str]) -> float:
    first_s = opened.first_s or 0.0
    if align == "start":
        return first_s
    if align == "move":
        for mark in marks:
            if mark.kind == "move" and mark.time_s >= first_s:
                return mark.time_s
        notes.append(f"{name}: no move begins in it, so it is put where its trigger is, else at its start")
    if align == "trigger" and not any(mark.kind == "trigger" for mark in marks):
        notes.append(f"{name}: it had no trigger, so its first row is at 0")
    return zero_of(opened, marks) or 0.0


def _recording(side: _Side) -> out.ComparedRecording:
    head, time_s = side.opened.head, side.rows.time_s
    return out.ComparedRecording(
        id=side.id,
        name=side.name,
        colour=side.colour,
        device=head.device,
        model=head.model,
        zero_s=side.zero_s,
        from_s=float(time_s[0]) if len(time_s) else 0.0,
        to_s=float(time_s[-1]) if len(time_s) else 0.0,
        figures=figures_of(head, lambda: (side.rows,)) | figures_of_added(side.added, None, None),
    )


def _channel(sides: list[_Side], channel: str, points: int, notes: list[str]) -> out.ComparedChannel:
    having = [(side, samples) for side in sides if (samples := side.samples(channel)) is not None]
    first, against = having[0]
    curves, differences = [], []
    for side, samples in having:
        if samples.unit != against.unit:
            notes.append(f"{side.name}: its {channel} is in {samples.unit}, not {against.unit}, and is left out")
            continue
        at_s, thinned = extremes(samples.time_s, samples.values, points)
        curves.append(out.ComparedCurve(recording=side.id, time_s=at_s.tolist(), values=nothing_as_null(thinned)))
        if side is not sides[0] and first is sides[0]:
            differences.append(_difference(against, side, samples, points))
    return out.ComparedChannel(channel=channel, unit=against.unit, curves=curves, differences=differences)


def _difference(against: _Samples, side: _Side, samples: _Samples, points: int) -> out.ComparedDifference:
    wanted_s = against.time_s
    reach_s = REACH * max(usual_interval_s(samples.time_s), usual_interval_s(wanted_s))
    difference = at_times(samples.time_s, samples.values, wanted_s, reach_s) - against.values
    at_s, thinned = extremes(wanted_s, difference, points)
    return out.ComparedDifference(
        recording=side.id,
        time_s=at_s.tolist(),
        values=nothing_as_null(thinned),
        figures=out.DifferenceOut.model_validate(difference_of(wanted_s, difference)),
    )


def spectrum_of(
    opened: Opened,
    marks: Sequence[Mark],
    channel: str,
    from_s: float | None,
    to_s: float | None,
    window: Window,
    detrend: Detrend,
    points: int,
    added: Sequence[AddedRows] = (),
) -> out.Spectrum:
    """Raises UnknownThing, OutOfRange for too many samples, WrongState for too few."""
    require_channels(opened.head, [channel], added)
    time_s, values, unit = _samples_of(opened, zero_of(opened, marks) or 0.0, channel, from_s, to_s, added)
    try:
        found = spectrum(time_s, values, window=window, detrend=detrend)
    except ValueError as error:
        raise WrongState(
            f"{channel} has no spectrum here: {error}", "choose a longer part, or one without gaps"
        ) from error
    lines = MinMaxSegments.of_rows(found.frequency_hz, np.stack((found.amplitude, found.density)))
    shown = lines.joined(size_for(len(lines), points))
    swinging = found.amplitude[1:]
    top = int(swinging.argmax()) + 1 if len(swinging) and swinging.max() > 0 else None
    return out.Spectrum(
        channel=channel,
        unit=unit,
        frequency_hz=shown.high_s[0].tolist(),
        amplitude=shown.high[0].tolist(),
        density=shown.high[1].tolist(),
        peak_hz=None if top is None else float(found.frequency_hz[top]),
        peak=None if top is None else float(found.amplitude[top]),
        line_hz=found.line_hz,
        resolution_hz=found.resolution_hz,
        rate_hz=found.rate_hz,
        samples=found.samples,
        from_s=found.from_s,
        to_s=found.to_s,
        resampled=found.resampled,
    )


def _samples_of(
    opened: Opened, zero_s: float, channel: str, from_s: float | None, to_s: float | None, added: Sequence[AddedRows]
) -> _Samples:
    """A channel between two times since the zero. Raises OutOfRange for too many samples."""
    for each in added:
        for number, column in enumerate(each.of.columns):
            if column.name == channel:
                part = part_of(each, 0.0, from_s, to_s)
                _require_few(len(part.time_s))
                return _Samples(part.time_s, part.columns[number], column.unit)
    names = [column.name for column in opened.head.columns]
    number = names.index(channel)
    first, last = rows_between(opened, zero_s, from_s, to_s)
    _require_few(last - first)
    rows = opened.read(first, last)
    return _Samples(rows.time_s - zero_s, rows.columns[number], opened.head.columns[number].unit)


def _require_few(samples: int) -> None:
    if samples > SAMPLES_MAX:
        raise OutOfRange("samples of a spectrum", samples, 8, SAMPLES_MAX, "samples; choose a part: from_s, to_s")
