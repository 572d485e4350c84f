"""What a report tells of an own search: how sure it is, before and best, and what was tried."""

from __future__ import annotations

from ...html_report import EDGE, HEIGHT, WIDTH, PlotAxis, differences_plot, frame, mark, number, table
from ...number_text import counted, plain
from ..fastest_move.report import WORDS
from ..record import StudyRecord
from .figures import NAMES, named, value_of
from .found import CustomFound, CustomTried


def sections(record: StudyRecord) -> list[str]:
    """Each with its heading."""
    found = record.custom
    if found is None or found.before is None:
        return []
    parts = []
    if found.effects:
        parts.append("<h2>How sure</h2>" + _evidence(found) + _differences(found))
    best = next((one for one in found.tried if one.number == record.best), None)
    parts.append("<h2>Before and best</h2>" + _settings(record, best) + _figures(found, best))
    if record.trials:
        parts.append("<h2>What was tried</h2>" + _history(record, found) + _trials(record, found))
    return parts


def _evidence(found: CustomFound) -> str:
    rows = [
        (
            named(one.figure),
            plain(one.baseline, 5),
            plain(one.winner, 5),
            plain(one.difference, 4),
            f"{plain(one.interval.low, 4)} to {plain(one.interval.high, 4)}",
            f"{one.p:.3g}",
            "better" if one.significant else "may be worse" if one.worse else "not shown",
        )
        for one in found.effects
    ]
    bound = "" if found.loss_rate_max is None else f"; loss rate below {100 * found.loss_rate_max:.2g} %, 95 %"
    heads = ("", "before", "best", "difference", "95 %", "p (Wilcoxon)", "")
    proved = f"{counted(len(found.pairs), 'pair')}, no step lost in {counted(found.runs, 'run')}"
    return table(heads, rows) + f"<p>{proved}{bound}</p>"


def _differences(found: CustomFound) -> str:
    plots = []
    for index, figure in enumerate(found.objectives):
        differences = [pair.winner[index] - pair.baseline[index] for pair in found.pairs]
        plots.append(differences_plot(differences, NAMES[figure][1] or NAMES[figure][0]))
    return "".join(plots)


def _settings(record: StudyRecord, best: CustomTried | None) -> str:
    trial = None if best is None else record.trial(best.number)
    rows = [
        (f"{name} [{unit}]" if unit else name, plain(record.baseline_setting[name], 6))
        + (() if trial is None else (plain(trial.setting[name], 6),))
        for name, unit in record.units.items()
    ]
    return table(("", "before") + (() if trial is None else ("best",)), rows)


def _figures(found: CustomFound, best: CustomTried | None) -> str:
    assert found.before is not None
    rows = [
        (named(figure), number(value_of(found.before, figure)))
        + (() if best is None else (number(value_of(best.figures, figure)),))
        for figure in NAMES
    ]
    return table(("", "before") + (() if best is None else ("best",)), rows)


def _history(record: StudyRecord, found: CustomFound) -> str:
    """The first objective over the trials."""
    figure = found.objectives[0]
    states = {trial.number: trial.state for trial in record.trials}
    shown = [(one.number, value) for one in found.tried if (value := value_of(one.figures, figure)) is not None]
    if len(shown) < 2:
        return ""
    x = PlotAxis([number for number, _ in shown], EDGE, WIDTH - 10)
    y = PlotAxis([value for _, value in shown], HEIGHT - EDGE, 10)
    marks = "".join(
        mark(x.at(trial), y.at(value), states[trial], f"trial {trial}: {plain(value, 4)}") for trial, value in shown
    )
    return frame(x, y, "trial", named(figure), marks)


def _trials(record: StudyRecord, found: CustomFound) -> str:
    figures = {one.number: one.figures for one in found.tried}
    rows = [
        (
            str(trial.number),
            *(plain(trial.setting[name], 6) for name in record.units),
            WORDS[trial.state] if trial.state != "infeasible" else "did not hold",
            *(
                number(value_of(figures[trial.number], figure)) if trial.number in figures else ""
                for figure in found.objectives
            ),
            trial.why,
        )
        for trial in record.trials
    ]
    settings = (f"{name} [{unit}]" if unit else name for name, unit in record.units.items())
    return table(("trial", *settings, "", *(named(figure) for figure in found.objectives), "why"), rows)
