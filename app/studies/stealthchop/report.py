"""What a report tells of StealthChop: jolt over switch-over speed, what was tried, and the pairs."""

from __future__ import annotations

from collections.abc import Sequence

from ...html_report import EDGE, HEIGHT, WIDTH, PlotAxis, differences_plot, frame, mark, number, table
from ...number_text import plain
from ..record import StudyRecord
from .found import StealthFound, StealthTried


def sections(record: StudyRecord) -> list[str]:
    """Each with its heading."""
    found = record.stealthchop
    if found is None or found.before is None:
        return []
    shown = [found.before, *found.tried]
    parts = ["<h2>What was tried</h2>" + _plot(shown, found) + _table(shown)]
    if found.offset_auto is not None:
        gradient = "not told" if found.gradient_auto is None else str(found.gradient_auto)
        parts.append(
            "<h2>Tuned by the chip</h2>"
            + table(("", ""), [("PWM_OFS_AUTO", str(found.offset_auto)), ("PWM_GRAD_AUTO", gradient)])
        )
    if found.effects:
        differences = [pair.winner_jolt_fullsteps - pair.baseline_jolt_fullsteps for pair in found.pairs]
        rows = [
            (
                each.name,
                each.unit,
                plain(each.baseline, 4),
                plain(each.winner, 4),
                f"{plain(each.interval.low, 4)} to {plain(each.interval.high, 4)}",
                plain(each.p, 3),
            )
            for each in found.effects
        ]
        parts.append(
            "<h2>Pairs</h2>"
            + differences_plot(differences, "full steps")
            + table(("", "unit", "before", "after", "difference, 95 %", "p"), rows)
        )
    return parts


def _plot(shown: Sequence[StealthTried], found: StealthFound) -> str:
    switched = [(one.switch_rps, one) for one in shown if one.on and one.switch_rps is not None]
    x = PlotAxis([0.0, *(rps for rps, _ in switched), found.velocity_max_rps], EDGE, WIDTH - 10)
    y = PlotAxis([0.0, found.jolt_max_fullsteps, *(one.jolt_fullsteps for _, one in switched)], HEIGHT - EDGE, 10)
    marks = "".join(
        mark(
            x.at(rps),
            y.at(one.jolt_fullsteps),
            "feasible" if one is not found.before and one.jolt_fullsteps <= found.jolt_max_fullsteps else "failed",
            f"{plain(rps, 3)} turns/s{' (before)' if one is found.before else ''}",
        )
        for rps, one in switched
    )
    return frame(x, y, "switch-over [turns/s]", "jolt [full steps]", marks)


def _table(shown: Sequence[StealthTried]) -> str:
    rows = [
        (
            number(one.offset),
            number(one.gradient),
            "off" if not one.on else "every speed" if one.switch_rps is None else plain(one.switch_rps, 3),
            number(one.jolt_fullsteps, 3),
            _percent(one.added_share),
            _percent(one.amplitude_share),
            number(one.lost_fullsteps),
            one.why,
        )
        for one in shown
    ]
    return table(
        (
            "PWM_OFS",
            "PWM_GRAD",
            "switch-over [turns/s]",
            "jolt [full steps]",
            "amplitude off by",
            "greatest amplitude",
            "lost [full steps]",
            "",
        ),
        rows,
    )


def _percent(share: float | None) -> str:
    return "" if share is None else f"{plain(100 * share, 3)} %"
