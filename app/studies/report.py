"""The report of a study as one HTML file: text, tables and plots (SVG), no script, nothing from elsewhere."""

from __future__ import annotations

import html
import math
import time
from collections.abc import Sequence

from ..number_text import plain
from .record import Evidence, Figures, StudyRecord, Trial

STYLE = """
body{font:14px/1.45 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#1a1b1e;background:#fff}
h1{font-size:1.5rem}h2{font-size:1.1rem;margin-top:2rem}table{border-collapse:collapse;width:100%}
td,th{text-align:left;padding:.2rem .6rem;border-bottom:1px solid #dee2e6}td.n{text-align:right}
.verdict{font-size:1.1rem;padding:.6rem .8rem;border-left:4px solid #228be6;background:#f1f3f5}svg{max-width:100%}
@media (prefers-color-scheme:dark){body{color:#e9ecef;background:#1a1b1e}
.verdict{background:#25262b}td,th{border-color:#373a40}}
"""
WIDTH, HEIGHT, EDGE = 640, 260, 54
COLOURS = {"feasible": "#2b8a3e", "infeasible": "#e03131", "pruned": "#868e96", "failed": "#e8590c"}
WORDS = {"feasible": "held", "infeasible": "lost steps", "pruned": "not tried", "failed": "failed"}


def html_of(record: StudyRecord) -> str:
    """The report of a study that is over or runs."""
    document = record.document
    about = (
        f"{record.device_name} ({record.model.upper()}), axis {document.axis}; {_when(record.started_unix_s)}, "
        f"by {record.by or 'nobody named'}; study {record.id}, seed {document.seed}, {record.runs} runs, "
        f"{plain(record.way_fullsteps, 4)} full steps of way"
    )
    parts = [
        f"<h1>{_text(document.title)}</h1>",
        f"<p>{_text(about)}</p>",
        f'<p class="verdict">{_text(record.verdict or record.message or record.state)}</p>',
    ]
    if record.left:
        parts.append("<h2>What is not as before</h2>" + _list(record.left))
    if record.findings:
        parts.append("<h2>Found</h2>" + _findings(record))
    if record.evidence is not None:
        parts.append("<h2>How sure</h2>" + _evidence(record.evidence) + _pairs_plot(record))
    best = record.trial(record.best)
    if record.baseline_setting and record.baseline_figures is not None:
        parts.append("<h2>Before and best</h2>" + _settings(record, best))
    if record.trials:
        parts.append("<h2>What was tried</h2>" + _history(record) + _scatter(record) + _trials(record))
    if record.next:
        parts.append(f"<h2>Next</h2><p>{_text(record.next)}</p>")
    body = "\n".join(parts)
    title = _text(f"{document.title}, {record.device_name}")
    return (
        f'<!doctype html>\n<html lang="en"><meta charset="utf-8"><title>{title}</title><style>{STYLE}</style>\n'
        f"<body>\n{body}\n</body></html>\n"
    )


def _text(text: object) -> str:
    return html.escape(str(text))


def _when(unix_s: float) -> str:
    return time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime(unix_s))


def _list(lines: Sequence[str]) -> str:
    return "<ul>" + "".join(f"<li>{_text(line)}</li>" for line in lines) + "</ul>"


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    head = "".join(f"<th>{_text(name)}</th>" for name in heads)
    body = "".join("<tr>" + "".join(f"<td>{_text(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><tr>{head}</tr>{body}</table>"


def _number(value: float | None, digits: int = 4) -> str:
    return "" if value is None else plain(value, digits)


def _findings(record: StudyRecord) -> str:
    rows = []
    for one in record.findings:
        between = "" if one.interval is None else f"{_number(one.interval.low)} to {_number(one.interval.high)}"
        value = f"{_number(one.value)} {one.unit}".strip()
        rows.append((one.name, one.text, value, between, one.sure, "" if one.remedy is None else one.remedy.label))
    return _table(("what", "", "value", "95 %", "how sure", "cure"), rows)


def _evidence(evidence: Evidence) -> str:
    low, high = evidence.interval_s.low, evidence.interval_s.high
    return _table(
        ("", ""),
        (
            ("pairs", str(evidence.pairs)),
            ("before, mean", f"{plain(evidence.baseline_s, 5)} s"),
            ("best, mean", f"{plain(evidence.winner_s, 5)} s"),
            ("difference", f"{plain(evidence.difference_s * 1e3, 4)} ms ({100 * evidence.share:.3g} %)"),
            ("its 95 % interval", f"{plain(low * 1e3, 4)} to {plain(high * 1e3, 4)} ms"),
            ("p", f"{evidence.p:.3g}"),
            ("test", evidence.test),
            ("lost steps", f"in {evidence.lost_runs} of {evidence.runs} runs"),
            ("loss rate, 95 % bound", f"below {100 * evidence.loss_rate_max:.2g} %"),
        ),
    )


def _settings(record: StudyRecord, best: Trial | None) -> str:
    rows = []
    for name, value in record.baseline_setting.items():
        unit = record.units.get(name, "")
        rows.append((f"{name} [{unit}]", plain(value, 6), "" if best is None else plain(best.setting[name], 6)))

    def figures(of: Figures | None, name: str) -> str:
        return "" if of is None else _number(getattr(of, name))

    found = None if best is None else best.figures
    rows.append(("time [s]", figures(record.baseline_figures, "time_s"), figures(found, "time_s")))
    rows.append(
        (
            "peak deviation [full steps]",
            figures(record.baseline_figures, "deviation_fullsteps"),
            figures(found, "deviation_fullsteps"),
        )
    )
    return _table(("", "before", "best"), rows)


def _trials(record: StudyRecord) -> str:
    names = list(record.units)
    rows = [
        (
            str(trial.number),
            *(plain(trial.setting[name], 5) for name in names),
            WORDS[trial.state],
            _number(trial.figures.time_s),
            _number(trial.figures.deviation_fullsteps, 3),
            trial.why,
        )
        for trial in record.trials
    ]
    heads = ("trial", *(f"{name} [{record.units[name]}]" for name in names), "", "time [s]", "deviation", "why")
    return _table(heads, rows)


# --- plots ------------------------------------------------------------------------------------------


class _Axis:
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
        """Five values to be written."""
        shown = [self._from + (self._to - self._from) * (index + 0.5) / 5 for index in range(5)]
        return [10**value for value in shown] if self._log else shown


def _frame(x: _Axis, y: _Axis, x_name: str, y_name: str, marks: str) -> str:
    ticks = "".join(
        f'<text x="{x.at(value):.1f}" y="{HEIGHT - EDGE + 18}" text-anchor="middle">{plain(value, 3)}</text>'
        for value in x.ticks()
    ) + "".join(
        f'<text x="{EDGE - 6}" y="{y.at(value) + 4:.1f}" text-anchor="end">{plain(value, 3)}</text>'
        for value in y.ticks()
    )
    return (
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{_text(y_name)} over {_text(x_name)}" '
        f'font-size="12" fill="currentColor"><rect x="{EDGE}" y="10" width="{WIDTH - EDGE - 10}" '
        f'height="{HEIGHT - EDGE - 10}" fill="none" stroke="#adb5bd"/>{ticks}{marks}'
        f'<text x="{WIDTH / 2}" y="{HEIGHT - 12}" text-anchor="middle">{_text(x_name)}</text>'
        f'<text transform="translate(13 {HEIGHT / 2 - 20}) rotate(-90)" text-anchor="middle">{_text(y_name)}</text>'
        "</svg>"
    )


def _mark(x: float, y: float, state: str, title: str) -> str:
    colour = COLOURS[state]
    if state == "feasible":
        shape = f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{colour}">'
        return f"{shape}<title>{_text(title)}</title></circle>"
    cross = f"M{x - 4:.1f} {y - 4:.1f}l8 8M{x + 4:.1f} {y - 4:.1f}l-8 8"
    return f'<path d="{cross}" stroke="{colour}" stroke-width="2"><title>{_text(title)}</title></path>'


def _tried(record: StudyRecord) -> list[Trial]:
    return [trial for trial in record.trials if trial.state in ("feasible", "infeasible")]


def _history(record: StudyRecord) -> str:
    tried = [(trial, trial.figures.time_s or trial.expected_s or 0.0) for trial in _tried(record)]
    if len(tried) < 2:
        return ""
    x = _Axis([trial.number for trial, _ in tried], EDGE, WIDTH - 10)
    y = _Axis([value for _, value in tried], HEIGHT - EDGE, 10)
    marks = "".join(
        _mark(x.at(trial.number), y.at(value), trial.state, f"trial {trial.number}: {plain(value, 4)} s, {trial.why}")
        for trial, value in tried
    )
    return _frame(x, y, "trial", "time [s]", marks)


def _scatter(record: StudyRecord) -> str:
    tried, names = _tried(record), list(record.units)
    if len(tried) < 2 or len(names) < 2:
        return ""
    first, second = names[:2]
    x = _Axis([trial.setting[first] for trial in tried], EDGE, WIDTH - 10, log=True)
    y = _Axis([trial.setting[second] for trial in tried], HEIGHT - EDGE, 10, log=True)
    marks = "".join(
        _mark(x.at(trial.setting[first]), y.at(trial.setting[second]), trial.state, f"trial {trial.number}")
        for trial in tried
    )
    return _frame(x, y, f"{first} [{record.units[first]}]", f"{second} [{record.units[second]}]", marks)


def _pairs_plot(record: StudyRecord) -> str:
    if len(record.pairs) < 2:
        return ""
    differences = [(pair.winner_s - pair.baseline_s) * 1e3 for pair in record.pairs]
    x = _Axis(list(range(1, len(differences) + 1)), EDGE, WIDTH - 10)
    y = _Axis([*differences, 0.0], HEIGHT - EDGE, 10)
    zero = f'<path d="M{EDGE} {y.at(0):.1f}H{WIDTH - 10}" stroke="#868e96"/>'
    marks = zero + "".join(
        _mark(x.at(index), y.at(value), "feasible", f"pair {index}: {plain(value, 4)} ms")
        for index, value in enumerate(differences, 1)
    )
    return _frame(x, y, "pair", "difference [ms]", marks)
