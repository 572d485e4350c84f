"""A recording as one HTML file, to be sent to somebody or put into a lab book."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import groupby

from ...html_report import EDGE, HEIGHT, WIDTH, PlotAxis, frame, line, moment, number, page, table, text
from ...number_text import plain
from .schemas import (
    Curve,
    FiguresByChannel,
    MarkOut,
    PredictionOut,
    RecordingDetail,
    RecordingFigures,
    RecordingPlot,
)

COLOURS = ("#0068a8", "#a86400", "#6a0f5c", "#008060", "#4b2fa3", "#5c5200")
"""Told apart by colour-blind eyes too, and dark enough for text on white; further ones begin again, dashed."""
MARK_COLOUR = "#868e96"


WrittenCell = tuple[str, RecordingPlot | None, RecordingFigures | None]
"""A cell of the notebook with what it shows: its text, its plot, its statistics."""


def report_of(
    detail: RecordingDetail,
    plot: RecordingPlot,
    figures: RecordingFigures,
    from_s: float | None,
    to_s: float | None,
    notebook: Sequence[WrittenCell] = (),
    predictions: Sequence[PredictionOut] = (),
) -> str:
    """What the page of a recording shows of the stretch that was plotted: what it is of, plots, marks and figures.

    from_s, to_s : the stretch that was asked for, since the zero [s]; None: from the beginning, to the end. A mark may
        lie behind the last sample.
    predictions : what was to be expected of each axis, of the same stretch
    """
    zero_s = plot.zero_s
    first_s, last_s = -math.inf if from_s is None else from_s, math.inf if to_s is None else to_s
    marks = [mark for mark in detail.marks if first_s <= mark.time_s - zero_s <= last_s]
    title = detail.name or detail.id
    about = (
        f"{detail.device} ({(detail.model or '').upper()}), {moment(detail.started_unix_s or 0.0)}; "
        f"recording {detail.id}, "
        f"{plain(detail.rate_hz or 0.0)} Hz. Shown: {plain(plot.from_s)} to {plain(plot.to_s)} s of "
        f"{plain(detail.duration_s)} s, {plot.rows} samples"
        + (", of which each stretch's lowest and highest are drawn." if plot.thinned else ".")
    )
    parts = [f"<h1>{text(title)}</h1>", f"<p>{text(about)}</p>"]
    parts += [f'<p class="verdict">{text(told)}</p>' for told in (detail.message, detail.note) if told]
    parts += [figure(unit, curves, marks, zero_s) for unit, curves in by_unit(plot.curves)]
    units = {each.name: each.unit for each in detail.channels}
    if notebook:
        parts.append("<h2>Notebook</h2>" + "".join(_cell(cell, detail, units) for cell in notebook))
    parts += [_predicted(each) for each in predictions]
    if marks:
        rows = [(number(mark.time_s - zero_s), mark.kind, mark.text) for mark in marks]
        parts.append("<h2>What happened</h2>" + table(("time [s]", "", ""), rows))
    parts.append("<h2>Figures</h2>" + _figures(figures.figures, units))
    return page(title, parts)


def _cell(cell: WrittenCell, detail: RecordingDetail, units: dict[str, str]) -> str:
    words, shown, of = cell
    parts = [f'<p style="white-space:pre-wrap">{text(words)}</p>'] if words else []
    if shown:
        zero_s = shown.zero_s
        marks = [mark for mark in detail.marks if shown.from_s <= mark.time_s - zero_s <= shown.to_s]
        parts += [figure(unit, curves, marks, zero_s) for unit, curves in by_unit(shown.curves)]
    if of:
        parts.append(f"<p>{number(of.from_s)} to {number(of.to_s)} s</p>" + _figures(of.figures, units))
    return "".join(parts)


def _predicted(of: PredictionOut) -> str:
    """The residual of one axis and its figures; what is not predicted, with the reason."""
    heads = ("channel", "unit", "largest residual", "at [s]", "mean", "RMS", "samples")
    rows, plots = [], []
    for channel in of.channels:
        for each in channel.differences:
            told = each.figures
            figures = (number(told.peak), number(told.peak_at_s), number(told.mean), number(told.rms))
            rows.append((channel.channel, channel.unit, *figures, str(told.samples)))
            if told.samples:
                name = f"{channel.channel} less its prediction"
                curve = Curve(channel=name, unit=channel.unit, time_s=each.time_s, values=each.values)
                plots.append(figure(channel.unit, [curve], (), 0.0))
    notes = "".join(f"<li>{text(note)}</li>" for note in of.notes)
    settings = f"<p>By the settings {text(of.settings)}; {of.motions} motions.</p>" if of.motions else ""
    heading = f"<h2>Beside the prediction of axis {of.axis}</h2>{settings}<ul>{notes}</ul>"
    return heading + (table(heads, rows) + "".join(plots) if of.motions else "")


def by_unit(curves: Sequence[Curve]) -> Iterator[tuple[str, list[Curve]]]:
    """Curves that share an axis: those of one unit, in the order of the channels."""
    order = list(dict.fromkeys(curve.unit for curve in curves))
    for unit, some in groupby(sorted(curves, key=lambda curve: order.index(curve.unit)), lambda curve: curve.unit):
        yield unit, list(some)


def figure(unit: str, curves: Sequence[Curve], marks: Sequence[MarkOut], zero_s: float) -> str:
    """A plot over time, with its legend; a line ends where samples are missing, and nothing is drawn for none."""
    known = [value for curve in curves for value in curve.values if value is not None]
    times = [time_s for curve in curves for time_s in curve.time_s]
    names = ", ".join(curve.channel for curve in curves)
    if not known:
        return f"<h2>{text(names)}</h2><p>No samples in this stretch.</p>"
    x = PlotAxis([min(times), max(times)], EDGE, WIDTH - 10)
    y = PlotAxis([min(known), max(known)], HEIGHT - EDGE, 10)
    drawn = [
        f'<path d="M{x.at(mark.time_s - zero_s):.1f} 10V{HEIGHT - EDGE}" stroke="{MARK_COLOUR}" stroke-dasharray="2 3">'
        f"<title>{text(mark.text)}</title></path>"
        for mark in marks
    ]
    legend = []
    for index, curve in enumerate(curves):
        colour, dashed = COLOURS[index % len(COLOURS)], index >= len(COLOURS)
        legend.append(f'<span style="color:{colour}">{"╌" if dashed else "━"} {text(curve.channel)}</span>')
        for run in runs(curve):
            points = [(x.at(time_s), y.at(value)) for time_s, value in run]
            drawn.append(line(points, colour, curve.channel, dashed=dashed))
    heading = f"<h2>{text(names)}</h2><p>{' '.join(legend)}</p>"
    return heading + frame(x, y, "time [s]", f"[{unit}]" if unit else "", "".join(drawn))


def runs(curve: Curve) -> Iterator[list[tuple[float, float]]]:
    """The parts of a curve between missing samples."""
    pairs = zip(curve.time_s, curve.values, strict=True)
    for known, some in groupby(pairs, lambda pair: pair[1] is not None):
        if known:
            yield [(time_s, value) for time_s, value in some if value is not None]


def _figures(figures: FiguresByChannel, units: dict[str, str]) -> str:
    heads = ("channel", "unit", "least", "most", "mean", "RMS", "samples", "missing")
    rows = [
        (
            name,
            units.get(name, ""),
            *(number(value) for value in (of.minimum, of.maximum, of.mean, of.rms)),
            str(of.samples),
            str(of.missing),
        )
        for name, of in figures.items()
    ]
    return table(heads, rows)
