"""The report of a study as one HTML file: text, tables and plots (SVG), no script, nothing from elsewhere."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from ..number_text import plain
from .chopper import report as chopper
from .closed_loop import report as closed_loop
from .document import Kind
from .fastest_move import report as fastest_move
from .identification import report as identification
from .least_current import report as least_current
from .microstep_calibration import report as microstep_calibration
from .record import StudyRecord
from .report_parts import number, table, text
from .resonance_map import report as resonance_map
from .scored_move import report as scored_move
from .stallguard import report as stallguard
from .torque_curve import report as torque_curve

STYLE = """
body{font:14px/1.45 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#1a1b1e;background:#fff}
h1{font-size:1.5rem}h2{font-size:1.1rem;margin-top:2rem}table{border-collapse:collapse;width:100%}
td,th{text-align:left;padding:.2rem .6rem;border-bottom:1px solid #dee2e6}td.n{text-align:right}
.verdict{font-size:1.1rem;padding:.6rem .8rem;border-left:4px solid #228be6;background:#f1f3f5}svg{max-width:100%}
@media (prefers-color-scheme:dark){body{color:#e9ecef;background:#1a1b1e}
.verdict{background:#25262b}td,th{border-color:#373a40}}
"""
SECTIONS: dict[Kind, Callable[[StudyRecord], list[str]]] = {
    "chopper": chopper.sections,
    "closed_loop": closed_loop.sections,
    "first_look": lambda _: [],
    "fastest_move": fastest_move.sections,
    "identification": identification.sections,
    "least_current": least_current.sections,
    "microstep_calibration": microstep_calibration.sections,
    "resonance_map": resonance_map.sections,
    "scored_move": scored_move.sections,
    "stallguard": stallguard.sections,
    "torque_curve": torque_curve.sections,
}
"""What each kind has to tell beside its verdict and findings."""


def html_of(record: StudyRecord) -> str:
    """The report of a study that is over or runs."""
    document = record.document
    about = (
        f"{record.device_name} ({record.model.upper()}), axis {document.axis}; {_when(record.started_unix_s)}, "
        f"by {record.by or 'nobody named'}; study {record.id}, seed {document.seed}, {record.runs} runs, "
        f"{plain(record.way_fullsteps, 4)} full steps of way"
    )
    parts = [
        f"<h1>{text(document.title)}</h1>",
        f"<p>{text(about)}</p>",
        f'<p class="verdict">{text(record.verdict or record.message or record.state)}</p>',
    ]
    if record.left:
        parts.append("<h2>What is not as before</h2>" + _list(record.left))
    if record.findings:
        parts.append("<h2>Found</h2>" + _findings(record))
    parts += SECTIONS[document.study.kind](record)
    if record.next:
        parts.append(f"<h2>Next</h2><p>{text(record.next)}</p>")
    body = "\n".join(parts)
    title = text(f"{document.title}, {record.device_name}")
    return (
        f'<!doctype html>\n<html lang="en"><meta charset="utf-8"><title>{title}</title><style>{STYLE}</style>\n'
        f"<body>\n{body}\n</body></html>\n"
    )


def _when(unix_s: float) -> str:
    return time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime(unix_s))


def _list(lines: Sequence[str]) -> str:
    return "<ul>" + "".join(f"<li>{text(line)}</li>" for line in lines) + "</ul>"


def _findings(record: StudyRecord) -> str:
    rows = []
    for one in record.findings:
        between = "" if one.interval is None else f"{number(one.interval.low)} to {number(one.interval.high)}"
        value = f"{number(one.value)} {one.unit}".strip()
        rows.append((one.name, one.text, value, between, one.sure, "" if one.remedy is None else one.remedy.label))
    return table(("what", "", "value", "95 %", "how sure", "cure"), rows)
