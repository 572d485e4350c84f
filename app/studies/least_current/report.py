"""What a report tells of the least current: what held, and what it saves."""

from __future__ import annotations

import html

from ...html_report import EDGE, HEIGHT, WIDTH, PlotAxis, frame, mark, number, table
from ...number_text import plain
from ..record import StudyRecord
from .found import CoolStepFound, LeastCurrentFound


def sections(record: StudyRecord) -> list[str]:
    """Each with its heading."""
    found = record.least_current
    if found is None or not found.tried:
        return []
    parts = ["<h2>What was tried</h2>" + _plot(found) + _tried(found)]
    if found.saving is not None:
        around = found.saving.interval_w
        rows = (
            ("before", f"{plain(found.saving.before_w, 3)} W"),
            ("after", f"{plain(found.saving.after_w, 3)} W"),
            ("saved", f"{plain(found.saving.saved_w, 3)} W"),
            ("with the winding at 20 to 80 deg C", f"{plain(around.low, 3)} to {plain(around.high, 3)} W"),
        )
        parts.append("<h2>Heat of the coils, calculated</h2>" + table(("", ""), rows))
    if found.coolstep is not None:
        parts.append("<h2>CoolStep</h2>" + _coolstep(found.coolstep))
    return parts


def _coolstep(cool: CoolStepFound) -> str:
    told = f"<p>There is none: {html.escape(cool.why)}.</p>" if cool.why else ""
    if cool.setting is not None and cool.saved_share is not None and cool.interval_share is not None:
        around = cool.interval_share
        low, saved, high = (number(100 * share, 3) for share in (around.low, cool.saved_share, around.high))
        less = f"{saved} % less heat while it moves (95 %: {low} to {high} %), by {len(cool.pairs)} pairs"
        told += f"<p>{cool.setting}: {less}.</p>"
    rows = [
        (
            str(one.setting),
            f"{one.scale + 1}/32",
            "held" if one.held else "lost steps",
            str(one.cycles),
            "" if one.heat_share is None else f"{number(100 * one.heat_share, 3)} %",
        )
        for one in cool.tried
    ]
    heads = ("setting", "run current at most", "with SEMIN one lower and the margin", "load cycles", "heat of without")
    return told + (table(heads, rows) if rows else "")


def _plot(found: LeastCurrentFound) -> str:
    shown = [(one, one.deviation_fullsteps or 0.0) for one in found.tried]
    x = PlotAxis([one.scale + 1 for one, _ in shown], EDGE, WIDTH - 10)
    y = PlotAxis([0.0, *(deviation for _, deviation in shown)], HEIGHT - EDGE, 10)
    marks = "".join(
        mark(
            x.at(one.scale + 1),
            y.at(deviation),
            "feasible" if one.held else "infeasible",
            f"{one.scale + 1}/32: {'held' if one.held else 'lost steps'}",
        )
        for one, deviation in shown
    )
    return frame(x, y, "run current [1/32]", "peak deviation [full steps]", marks)


def _tried(found: LeastCurrentFound) -> str:
    rows = [
        (
            f"{one.scale + 1}/32",
            f"{100 * one.share:.3g} %",
            f"{100 * one.speed_times:.3g} %",
            "held" if one.held else "lost steps",
            str(one.cycles),
            number(one.deviation_fullsteps, 3),
        )
        for one in found.tried
    ]
    return table(("run current", "of before", "speed", "", "load cycles", "peak deviation [full steps]"), rows)
