"""What reports are made of: one HTML file of text, tables and plots (SVG), no script, nothing from elsewhere."""

from __future__ import annotations

import html
import math
import time
from collections.abc import Callable, Sequence

from .number_text import plain

WIDTH, HEIGHT, EDGE = 640, 260, 74
CHARACTER, LINE = 8, 14
"""As wide and as high as one is at the most, at the plots' size of letters [pixels]."""
SENTENCE = 40
"""Figures are shorter, and stay on one line; what is as long as this is none."""
DECADES = 2.5
"""From so many on an axis is marked at each."""
COLOURS = {"feasible": "#2b8a3e", "infeasible": "#e03131", "pruned": "#868e96", "failed": "#e8590c"}

STYLE = """
body{font:14px/1.45 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#1a1b1e;background:#fff}
h1{font-size:1.5rem}h2{font-size:1.1rem;margin-top:2rem}table{border-collapse:collapse;width:100%}
td,th{text-align:left;padding:.2rem .6rem;border-bottom:1px solid #dee2e6}td{white-space:nowrap}
td.long{min-width:10rem;white-space:normal}
.verdict{font-size:1.1rem;padding:.6rem .8rem;border-left:4px solid #228be6;background:#f1f3f5}
.wide{overflow-x:auto}svg{width:100%;min-width:40rem}
@media (prefers-color-scheme:dark){body{color:#e9ecef;background:#1a1b1e}
.verdict{background:#25262b}td,th{border-color:#373a40}}
"""


def page(title: str, parts: Sequence[str]) -> str:
    """The file: `parts` are HTML, the title is not."""
    body = "\n".join(parts)
    return (
        f'<!doctype html>\n<html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">\n'
        f"<title>{text(title)}</title><style>{STYLE}</style>\n"
        f"<body>\n{body}\n</body></html>\n"
    )


def moment(unix_s: float) -> str:
    """A time of day, to the minute."""
    return time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime(unix_s))


def text(told: object) -> str:
    """As HTML shows it."""
    return html.escape(str(told))


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Rows of cells below their heads."""
    head = "".join(f"<th>{text(name)}</th>" for name in heads)
    body = "".join("<tr>" + "".join(map(_cell, row)) + "</tr>" for row in rows)
    return f'<div class="wide"><table><tr>{head}</tr>{body}</table></div>'


def _cell(told: str) -> str:
    return f"<td{' class=long' if len(told) >= SENTENCE else ''}>{text(told)}</td>"


def number(value: float | None, digits: int = 4) -> str:
    """A figure; empty for none."""
    return "" if value is None else plain(value, digits)


class PlotAxis:
    """One axis of a plot: from data to pixels."""

    def __init__(self, values: Sequence[float], low: float, high: float, *, log: bool = False) -> None:
        self._log = log
        shown = [math.log10(value) for value in values] if log else list(values)
        least, most = min(shown), max(shown)
        pad = (most - least) * 0.06 or abs(most) * 0.1 or 1.0
        self._from, self._to, self._low, self._high = least - pad, most + pad, low, high

    def at(self, value: float) -> float:
        """Where it is drawn."""
        shown = math.log10(value) if self._log else value
        return self._low + (shown - self._from) / (self._to - self._from) * (self._high - self._low)

    def ticks(self) -> list[float]:
        """Round values to be written, three to eight of them; of several decades their tens."""
        if self._log and self._to - self._from >= DECADES:
            return [10.0**power for power in range(math.ceil(self._from), math.floor(self._to) + 1)]
        low, high = (10**self._from, 10**self._to) if self._log else (self._from, self._to)
        widest = (high - low) / 3
        power = 10.0 ** math.floor(math.log10(widest))  # a logarithm is rounded: this may be just above it
        step = max(power * times for times in (0.5, 1, 2, 5) if power * times <= widest)
        return [step * index for index in range(math.ceil(low / step), math.floor(high / step) + 1)]


def _told(axis: PlotAxis, ticks: Sequence[float], room: Callable[[str], float]) -> dict[float, str]:
    """What is written at ticks, from the least on: those of a logarithm crowd, and none lies upon another."""
    told: dict[float, str] = {}
    last = -math.inf
    for value in ticks:
        name = plain(value, 6)
        place = abs(axis.at(value) - axis.at(ticks[0]))
        if place - last >= room(name):
            told[value], last = name, place
    return told


def frame(x: PlotAxis, y: PlotAxis, x_name: str, y_name: str, marks: str) -> str:
    """A plot: its axes with names and ticks around `marks`."""
    foot, middle = HEIGHT - EDGE, (HEIGHT - EDGE + 10) / 2
    below = _told(x, x.ticks(), lambda name: CHARACTER * (len(name) + 1))
    beside = _told(y, y.ticks(), lambda _: LINE)
    ticks = "".join(
        f'<path d="M{x.at(value):.1f} 10V{foot}" stroke="#868e96" opacity=".3"/>'
        f'<text x="{x.at(value):.1f}" y="{foot + 18}" text-anchor="middle">{below.get(value, "")}</text>'
        for value in x.ticks()
    ) + "".join(
        f'<path d="M{EDGE} {y.at(value):.1f}H{WIDTH - 10}" stroke="#868e96" opacity=".3"/>'
        f'<text x="{EDGE - 6}" y="{y.at(value) + 4:.1f}" text-anchor="end">{beside.get(value, "")}</text>'
        for value in y.ticks()
    )
    return (
        f'<div class="wide"><svg viewBox="0 0 {WIDTH} {foot + 46}" role="img" '
        f'aria-label="{text(y_name)} over {text(x_name)}" font-size="12" fill="currentColor">'
        f'<rect x="{EDGE}" y="10" width="{WIDTH - EDGE - 10}" '
        f'height="{foot - 10}" fill="none" stroke="#adb5bd"/>{ticks}{marks}'
        f'<text x="{WIDTH / 2}" y="{foot + 38}" text-anchor="middle">{text(x_name)}</text>'
        f'<text transform="translate(11 {middle}) rotate(-90)" text-anchor="middle">{text(y_name)}</text>'
        "</svg></div>"
    )


def mark(x: float, y: float, state: str, title: str) -> str:
    """A trial's place in a plot [pixels]: a dot where it held, else a cross."""
    colour = COLOURS[state]
    if state == "feasible":
        shape = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{colour}">'
        return f"{shape}<title>{text(title)}</title></circle>"
    cross = f"M{x - 4:.1f} {y - 4:.1f}l8 8M{x + 4:.1f} {y - 4:.1f}l-8 8"
    return f'<path d="{cross}" stroke="{colour}" stroke-width="2"><title>{text(title)}</title></path>'


def differences_plot(differences: Sequence[float], unit: str) -> str:
    """New less old, pair by pair; nothing for a single pair."""
    if len(differences) < 2:
        return ""
    x = PlotAxis(list(range(1, len(differences) + 1)), EDGE, WIDTH - 10)
    y = PlotAxis([*differences, 0.0], HEIGHT - EDGE, 10)
    zero = f'<path d="M{EDGE} {y.at(0):.1f}H{WIDTH - 10}" stroke="#868e96"/>'
    marks = zero + "".join(
        mark(x.at(index), y.at(value), "feasible", f"pair {index}: {plain(value, 4)} {unit}")
        for index, value in enumerate(differences, 1)
    )
    return frame(x, y, "pair", f"difference [{unit}]", marks)


def line(points: Sequence[tuple[float, float]], colour: str, title: str, *, dashed: bool = False) -> str:
    """A line through points of a plot [pixels]."""
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    look = f'fill="none" stroke="{colour}" stroke-width="2"' + (' stroke-dasharray="6 4"' if dashed else "")
    return f'<polyline points="{path}" {look}><title>{text(title)}</title></polyline>'
