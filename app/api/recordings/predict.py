"""A recording beside what the calculators expect of its commands."""

from __future__ import annotations

from ...calc.signals.alignment import difference_of
from ...calc.signals.decimation import extremes
from ...errors import OutOfRange, UsageError
from ...profiles.document import ProfileDocument
from ...recording.prediction import Expected, expect
from ...store.recordings.file import FloatArray, Rows
from ...store.recordings.library import Library
from . import schemas as out
from .views import nothing_as_null, rows_between, zero_of

ROWS_MAX = 4_000_000
PREDICTED = "predicted"
MEASURED = ("position", "encoder_position", "velocity")
"""Quantities that a prediction is laid beside."""
RECORDED = "as the recording tells"


def predict(
    library: Library,
    recording: str,
    axis: int,
    profile: ProfileDocument | None,
    from_s: float | None,
    to_s: float | None,
    points: int,
) -> out.PredictionOut:
    """Raises UnknownThing, WrongState for a file that cannot be read, UsageError, OutOfRange."""
    entry, opened, marks = library.entry(recording), library.open(recording), library.marks(recording)
    head = opened.head
    if profile is not None and profile.model != head.model:
        raise UsageError(f"the profile is of a {profile.model}, the recording of a {head.model}")
    axes = max(1, len(head.axes))
    if axis >= axes:
        raise OutOfRange("axis", axis, 0, axes - 1)
    if opened.rows > ROWS_MAX:
        raise OutOfRange("rows to predict", opened.rows, 0, ROWS_MAX)
    zero_s = zero_of(opened, marks) or 0.0
    rows = opened.read(0, opened.rows)
    expected = expect(head, marks, rows, axis, profile, zero_s)
    part = slice(*rows_between(opened, zero_s, from_s, to_s))
    time_s = rows.time_s[part] - zero_s
    sides = [
        _side(each, name, colour, head.device, head.model, zero_s, time_s)
        for each, name, colour in (
            (recording, entry.label.name or recording, entry.label.colour),
            (PREDICTED, "prediction", "orange" if entry.label.colour != "orange" else "blue"),
        )
    ]
    return out.PredictionOut(
        from_s=sides[0].from_s,
        to_s=sides[0].to_s,
        recordings=sides,
        channels=[
            _channel(name, column.unit, recording, rows, part, time_s, number, expected, points)
            for number, column in enumerate(head.columns)
            if (name := column.name).rpartition(".")[0] in MEASURED and name.rpartition(".")[2] == str(axis)
        ],
        notes=list(expected.notes),
        axis=axis,
        settings=RECORDED if profile is None else profile.name,
        motions=expected.motions,
    )


def _side(
    recording: str, name: str, colour: str, device: str, model: str, zero_s: float, time_s: FloatArray
) -> out.ComparedRecording:
    return out.ComparedRecording(
        id=recording,
        name=name,
        colour=colour,
        device=device,
        model=model,
        zero_s=zero_s,
        from_s=float(time_s[0]) if len(time_s) else 0.0,
        to_s=float(time_s[-1]) if len(time_s) else 0.0,
        figures={},
    )


def _channel(
    name: str,
    unit: str,
    recording: str,
    rows: Rows,
    part: slice,
    time_s: FloatArray,
    number: int,
    expected: Expected,
    points: int,
) -> out.ComparedChannel:
    measured = rows.columns[number]
    if name.startswith("velocity."):
        predicted, residual = expected.velocity_pps, measured - expected.velocity_pps
    else:
        predicted, residual = expected.position, expected.residual(measured)
    curves = []
    for side, values in ((recording, measured[part]), (PREDICTED, predicted[part])):
        at_s, thinned = extremes(time_s, values, points)
        curves.append(out.ComparedCurve(recording=side, time_s=at_s.tolist(), values=nothing_as_null(thinned)))
    at_s, thinned = extremes(time_s, residual[part], points)
    difference = out.ComparedDifference(
        recording=recording,
        time_s=at_s.tolist(),
        values=nothing_as_null(thinned),
        figures=out.DifferenceOut.model_validate(difference_of(time_s, residual[part])),
    )
    return out.ComparedChannel(channel=name, unit=unit, curves=curves, differences=[difference])
