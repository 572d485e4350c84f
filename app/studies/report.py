"""The report of a study as one HTML file: text, tables and plots (SVG), no script, nothing from elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..html_report import moment, number, page, table, text
from ..number_text import counted, plain
from .chopper import report as chopper
from .closed_loop import report as closed_loop
from .custom_search import report as custom_search
from .document import FastestMove, Kind, LeastCurrent, told_twin
from .fastest_move import report as fastest_move
from .first_look import report as first_look
from .identification import report as identification
from .least_current import report as least_current
from .microstep_calibration import report as microstep_calibration
from .record import Finding, StudyRecord
from .resonance_map import report as resonance_map
from .scored_move import report as scored_move
from .stallguard import report as stallguard
from .stealthchop import report as stealthchop
from .torque_curve import report as torque_curve

SECTIONS: dict[Kind, Callable[[StudyRecord], list[str]]] = {
    "chopper": chopper.sections,
    "closed_loop": closed_loop.sections,
    "custom_search": custom_search.sections,
    "first_look": first_look.sections,
    "fastest_move": fastest_move.sections,
    "identification": identification.sections,
    "least_current": least_current.sections,
    "microstep_calibration": microstep_calibration.sections,
    "resonance_map": resonance_map.sections,
    "scored_move": scored_move.sections,
    "stallguard": stallguard.sections,
    "stealthchop": stealthchop.sections,
    "torque_curve": torque_curve.sections,
}
"""What each kind has to tell beside its verdict and findings."""
LARGE = {"H", "N m", "N m s", "V s/rad"}
"""Units of which a motor has thousandths."""


def html_of(record: StudyRecord) -> str:
    """The report of a study that is over or runs."""
    document = record.document
    about = (
        f"{record.device_name} ({record.model.upper()}), axis {document.axis}; {moment(record.started_unix_s)}, "
        f"by {record.by or 'nobody named'}; study {record.id}, seed {document.seed}, {counted(record.runs, 'run')}, "
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
    parts += _twin(record) + SECTIONS[document.study.kind](record)
    if record.next:
        parts.append(f"<h2>Next</h2><p>{text(record.next)}</p>")
    return page(f"{document.title}, {record.device_name}", parts)


def _twin(record: StudyRecord) -> list[str]:
    """Where the motor of its twin is from, or why it had none; nothing where its document says so itself."""
    study = record.document.study
    twin = told_twin(study.twin) if isinstance(study, FastestMove | LeastCurrent) else None
    told = f"Tried first on an emulated twin: {twin.source}." if twin and twin.source else ""
    if record.no_twin:
        told = f"Nothing was tried on an emulated twin first: {record.no_twin}."
    return [f"<h2>Twin</h2><p>{text(told)}</p>"] if told else []


def _list(lines: Sequence[str]) -> str:
    return "<ul>" + "".join(f"<li>{text(line)}</li>" for line in lines) + "</ul>"


def _unit_for(finding: Finding) -> tuple[float, str]:
    """By what a figure is multiplied, and its unit then: a motor has g cm2 and mH."""
    value, unit = finding.value or 0.0, finding.unit
    if unit.startswith("kg m2"):
        return 1e7, unit.replace("kg m2", "g cm2", 1)
    if unit in LARGE and 0 < abs(value) < 0.1:
        return 1e3, f"m{unit}"
    return 1.0, unit


def _findings(record: StudyRecord) -> str:
    rows = []
    for one in record.findings:
        times, unit = _unit_for(one)
        low_high = () if one.interval is None else (one.interval.low, one.interval.high)
        between = " to ".join(number(times * end) for end in low_high)
        value = "" if one.value is None else f"{number(times * one.value)} {unit}".strip()
        rows.append((one.name, one.text, value, between, one.sure, "" if one.remedy is None else one.remedy.label))
    return table(("what", "", "value", "95 %", "how sure", "cure"), rows)
