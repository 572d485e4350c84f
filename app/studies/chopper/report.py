"""What a report tells of a chopper: what was tried, how much the shaft shook, and the pairs."""

from __future__ import annotations

from collections.abc import Sequence

from ...html_report import EDGE, HEIGHT, WIDTH, PlotAxis, differences_plot, frame, mark, number, table
from ...number_text import plain
from ..record import StudyRecord
from .found import ChopperFound, ChopperTried


def sections(record: StudyRecord) -> list[str]:
    """Each with its heading."""
    found = record.chopper
    if found is None or found.before is None:
        return []
    shown = [found.before, *found.tried]
    parts = ["<h2>What was tried</h2>" + _plot(shown, found.before) + _table(shown, found)]
    if found.effect is not None:
        around = found.effect.interval_fullsteps
        differences = [pair.winner_fullsteps - pair.baseline_fullsteps for pair in found.pairs]
        rows = (
            ("before", f"{plain(found.effect.baseline_fullsteps, 4)} full steps"),
            ("after", f"{plain(found.effect.winner_fullsteps, 4)} full steps"),
            ("difference", f"{plain(found.effect.difference_fullsteps, 4)} full steps"),
            ("95 %", f"{plain(around.low, 4)} to {plain(around.high, 4)} full steps"),
            ("p (Wilcoxon)", plain(found.effect.p, 3)),
        )
        parts.append("<h2>Pairs</h2>" + differences_plot(differences, "full steps") + table(("", ""), rows))
    return parts


def _plot(shown: Sequence[ChopperTried], before: ChopperTried) -> str:
    x = PlotAxis([float(one.hysteresis) for one in shown], EDGE, WIDTH - 10)
    y = PlotAxis([0.0, *(one.ripple_fullsteps for one in shown)], HEIGHT - EDGE, 10)
    marks = "".join(
        mark(
            x.at(one.hysteresis),
            y.at(one.ripple_fullsteps),
            "failed" if one is before else "feasible",
            f"TOFF {one.off}, TBL {one.blank}, hysteresis {one.hysteresis}{' (before)' if one is before else ''}",
        )
        for one in shown
    )
    return frame(x, y, "hysteresis", "ripple [full steps]", marks)


def _table(shown: Sequence[ChopperTried], found: ChopperFound) -> str:
    rows = [
        (
            str(one.off),
            str(one.blank),
            str(one.hysteresis),
            number(one.ripple_fullsteps, 4),
            ", ".join(plain(each, 3) for each in one.by_speed_fullsteps),
            f"{one.chopper_hz / 1e3:.3g} kHz",
            one.why,
        )
        for one in shown
    ]
    speeds = ", ".join(plain(each) for each in found.speeds_rps)
    return table(
        ("TOFF", "TBL", "hysteresis", "ripple [full steps]", f"at {speeds} turns/s", "chopper, estimated", ""), rows
    )
