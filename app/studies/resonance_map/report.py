"""What a report tells of a resonance map: the Campbell plot, its figures, and what each change made of the ripple."""

from __future__ import annotations

import math

from ...html_report import EDGE, HEIGHT, WIDTH, PlotAxis, frame, line, number, table, text
from ...number_text import plain, times
from ..parts import Interval
from ..record import StudyRecord
from .found import Change, MapPoint, ResonanceFound

CIVIDIS = ("#00224e", "#35456c", "#666970", "#948e77", "#c8b866", "#fee838")
"""Colours by amplitude, alike to all eyes, dark to light: of the map cividis (Nunez, Anderton, Renslow 2018)."""
BEFORE, AFTER = "#868e96", "#1971c2"
DOTS = (3.0, 9.0)
"""Radius of the least and the greatest amplitude: what colour says, size says too [pixels]."""
BLIND = "samples show none"


def sections(record: StudyRecord) -> list[str]:
    """Each with its heading."""
    found = record.resonances
    if found is None or not found.points:
        return []
    parts = ["<h2>Campbell plot</h2>" + campbell(found) + _legend(found), "<h2>Ripple by speed</h2>" + _table(found)]
    parts += [f"<h2>With {text(change.name)}</h2>" + _changed(change) for change in found.changes if change.points]
    return parts


def _greatest(found: ResonanceFound) -> float:
    return max((one for point in found.points for one in point.amplitudes_deg if one is not None), default=0.0) or 1.0


def _level(amplitude: float, greatest: float) -> float:
    """From 0 to 1: by the root, for ripples of all sizes to be seen."""
    return math.sqrt(min(max(amplitude / greatest, 0.0), 1.0))


def campbell(found: ResonanceFound) -> str:
    """A dot where each order's frequency is at each speed, the larger and lighter the more it vibrates there."""
    points, greatest = found.points, _greatest(found)
    speeds = [point.speed_rps for point in points]
    x = PlotAxis(speeds, EDGE, WIDTH - 10, log=True)
    frequencies = [order * point.electrical_hz for point in points for order in found.orders if point.electrical_hz > 0]
    y = PlotAxis(frequencies, HEIGHT - EDGE, 10, log=True)
    drawn = []
    if found.resonance_hz is not None:
        at = y.at(found.resonance_hz.value)
        name = f"resonance {plain(found.resonance_hz.value, 4)} Hz"
        drawn.append(line([(EDGE, at), (WIDTH - 10, at)], "#e8590c", name))
    drawn += [_dot(x, y, point, order, amplitude, greatest) for amplitude, point, order in _rising(found)]
    return frame(x, y, "speed [turns/s]", "frequency [Hz]", "".join(drawn))


def _rising(found: ResonanceFound) -> list[tuple[float, MapPoint, int]]:
    """The strongest last, so that it lies on top."""
    told = [
        (amplitude, point, order)
        for point in found.points
        for order, amplitude in zip(found.orders, point.amplitudes_deg, strict=True)
        if amplitude is not None
    ]
    return sorted(told, key=lambda one: one[0])


def _dot(x: PlotAxis, y: PlotAxis, point: MapPoint, order: int, amplitude: float, greatest: float) -> str:
    level = _level(amplitude, greatest)
    colour = CIVIDIS[min(int(level * len(CIVIDIS)), len(CIVIDIS) - 1)]
    name = f"order {order} at {plain(point.speed_rps, 3)} turns/s: {plain(amplitude, 3)} deg"
    return (
        f'<circle cx="{x.at(point.speed_rps):.1f}" cy="{y.at(order * point.electrical_hz):.1f}" '
        f'r="{DOTS[0] + level * (DOTS[1] - DOTS[0]):.1f}" fill="{colour}" stroke="#868e96" stroke-width="0.5">'
        f"<title>{text(name)}</title></circle>"
    )


def _legend(found: ResonanceFound) -> str:
    greatest, many = _greatest(found), len(CIVIDIS)
    swatches = " ".join(
        '<span style="white-space:nowrap">'
        f'<span style="background:{colour};border:1px solid #868e96;padding:0 .7em"></span> up to '
        f"{plain(greatest * ((index + 1) / many) ** 2, 3)}</span>"
        for index, colour in enumerate(CIVIDIS)
    )
    said = "Each line of dots is an order; the level line is the resonance."
    return f"<p>Amplitude [deg electrical]: {swatches}. {said}</p>"


def _table(found: ResonanceFound) -> str:
    heads = ("turns/s", "ripple [deg]", "95 %", *(f"order {order}" for order in found.orders), "rest", "at [Hz]", "")
    rows = [
        (
            plain(point.speed_rps, 3),
            number(point.ripple_deg, 3),
            _between(point.interval_deg),
            *(number(amplitude, 3) for amplitude in point.amplitudes_deg),
            number(point.rest_deg, 3),
            number(point.rest_hz, 3),
            f"steps lost {times(point.lost)}" if point.lost else BLIND if point.blind else "",
        )
        for point in found.points
    ]
    return table(heads, rows)


def _changed(change: Change) -> str:
    points = change.points
    speeds = [point.speed_rps for point in points]
    before, after = [point.before_deg for point in points], [point.after_deg for point in points]
    x = PlotAxis(speeds, EDGE, WIDTH - 10, log=True)
    y = PlotAxis([0.0, *before, *after], HEIGHT - EDGE, 10)
    drawn = "".join(
        line([(x.at(speed), y.at(value)) for speed, value in zip(speeds, values, strict=True)], colour, name)
        for name, colour, values in (("before", BEFORE, before), (change.name, AFTER, after))
    )
    rows = [
        (
            plain(point.speed_rps, 3),
            number(point.before_deg, 3),
            number(point.after_deg, 3),
            f"{number(point.difference_deg, 3)} ({_between(point.interval_deg)})",
            point.told,
        )
        for point in points
    ]
    legend = f'<p><b style="color:{BEFORE}">before</b>, <b style="color:{AFTER}">{text(change.name)}</b></p>'
    heads = ("turns/s", "before [deg]", "with it [deg]", "difference, 95 %", "")
    return frame(x, y, "speed [turns/s]", "ripple [deg electrical]", drawn) + legend + table(heads, rows)


def _between(interval: Interval | None) -> str:
    return "" if interval is None else f"{number(interval.low, 3)} to {number(interval.high, 3)}"
