"""What a report tells of a microstep calibration: the error over the electrical angle, its harmonics, and how sure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ...html_report import EDGE, HEIGHT, WIDTH, PlotAxis, differences_plot, frame, number, table
from ...number_text import plain
from ..record import AngleEffect, AngleFigures, MicrostepFigures, StudyRecord

COLOURS = {"before": "#e8590c", "expected": "#868e96", "after": "#1971c2"}
Curves = Mapping[str, Sequence[float]]


def sections(record: StudyRecord) -> list[str]:
    """Each with its heading."""
    found = record.microsteps
    if found is None:
        return []
    parts = [
        "<h2>Error over the electrical angle</h2>" + _error(found),
        "<h2>Harmonics</h2>" + _harmonics(found.before, found.after),
    ]
    if found.effect is not None:
        differences = [pair.winner_deg - pair.baseline_deg for pair in found.pairs]
        parts.append("<h2>How sure</h2>" + _effect(found, found.effect))
        parts.append(differences_plot(differences, "deg electrical"))
    if found.wave is not None:
        waves = {"before": found.wave_before, "after": found.wave}
        parts.append("<h2>Table</h2>" + _lines(waves, 90.0, "electrical angle [deg]", "current [counts]"))
    return parts


def _error(found: MicrostepFigures) -> str:
    curves = {"before": found.before.curve_deg, "expected": found.predicted_deg}
    if found.after is not None:
        curves["after"] = found.after.curve_deg
    return _lines(curves, 360.0, "commanded electrical angle [deg]", "error [deg electrical]")


def _lines(curves: Curves, span: float, x_name: str, y_name: str) -> str:
    """Curves of equal steps over `span` [deg], and what is what."""
    y = PlotAxis([value for curve in curves.values() for value in curve], HEIGHT - EDGE, 10)
    x = PlotAxis([0.0, span], EDGE, WIDTH - 10)
    drawn = []
    for name, curve in curves.items():
        points = " ".join(
            f"{x.at((index + 0.5) * span / len(curve)):.1f},{y.at(value):.1f}" for index, value in enumerate(curve)
        )
        drawn.append(f'<polyline points="{points}" fill="none" stroke="{COLOURS[name]}" stroke-width="2"/>')
    legend = ", ".join(f'<b style="color:{COLOURS[name]}">{name}</b>' for name in curves)
    return frame(x, y, x_name, y_name, "".join(drawn)) + f"<p>{legend}</p>"


def _harmonics(before: AngleFigures, after: AngleFigures | None) -> str:
    now = [""] * len(before.harmonics)
    if after is not None:
        now = [f"{plain(each.amplitude_deg, 3)} ± {plain(each.half_deg, 2)}" for each in after.harmonics]
    rows = [
        (str(was.order), f"{plain(was.amplitude_deg, 3)} ± {plain(was.half_deg, 2)}", told)
        for was, told in zip(before.harmonics, now, strict=True)
    ]
    rows.append(("root mean square", number(before.rms_deg, 3), number(None if after is None else after.rms_deg, 3)))
    return table(("order", "before [deg electrical]", "after"), rows)


def _effect(found: MicrostepFigures, effect: AngleEffect) -> str:
    low, high = effect.interval_deg.low, effect.interval_deg.high
    return table(
        ("root mean square", "deg electrical"),
        (
            ("before", plain(effect.baseline_deg, 4)),
            ("with the new table", plain(effect.winner_deg, 4)),
            ("expected of it", number(found.predicted_rms_deg)),
            ("what no such table takes away", number(found.beyond_rms_deg)),
            (f"difference, mean of {effect.pairs} pairs", plain(effect.difference_deg, 4)),
            ("its 95 % interval", f"{plain(low, 4)} to {plain(high, 4)}"),
            ("p", f"{effect.p:.3g}"),
        ),
    )
