"""What a report tells of a fastest move: how sure it is, before and best, and what was tried."""

from __future__ import annotations

from ...html_report import COLOURS, EDGE, HEIGHT, WIDTH, PlotAxis, differences_plot, frame, line, mark, number, table
from ...number_text import plain
from ..document import FastestMove
from ..record import DeviationEvidence, Evidence, Figures, StudyRecord, Trial

WORDS = {"feasible": "held", "infeasible": "lost steps", "pruned": "not tried", "failed": "failed"}


def sections(record: StudyRecord) -> list[str]:
    """Each with its heading."""
    parts = []
    if record.evidence is not None:
        differences = [(pair.winner_s - pair.baseline_s) * 1e3 for pair in record.pairs]
        parts.append("<h2>How sure</h2>" + _evidence(record.evidence) + differences_plot(differences, "ms"))
        if record.evidence.deviation is not None:
            parts.append(_deviation(record.evidence.deviation) + differences_plot(_off(record), "full steps"))
    if record.baseline_setting and record.baseline_figures is not None:
        parts.append("<h2>Before and best</h2>" + _settings(record, record.trial(record.best)))
    if record.front:
        parts.append("<h2>Time and deviation</h2>" + _front(record))
    if record.trials:
        parts.append("<h2>What was tried</h2>" + _history(record) + _scatter(record) + _trials(record))
    return parts


def _evidence(evidence: Evidence) -> str:
    low, high = evidence.interval_s.low, evidence.interval_s.high
    return table(
        ("", ""),
        (
            ("pairs", str(evidence.pairs)),
            ("before, mean", f"{plain(evidence.baseline_s, 5)} s"),
            ("best, mean", f"{plain(evidence.winner_s, 5)} s"),
            ("difference", f"{plain(evidence.difference_s * 1e3, 4)} ms ({100 * evidence.share:.3g} %)"),
            ("its 95 % interval", f"{plain(low * 1e3, 4)} to {plain(high * 1e3, 4)} ms"),
            ("p", f"{evidence.p:.3g}"),
            ("test", evidence.test),
            ("lost steps", f"in 0 of {evidence.runs} runs"),
            ("loss rate, 95 % bound", f"below {100 * evidence.loss_rate_max:.2g} %"),
        ),
    )


def _deviation(evidence: DeviationEvidence) -> str:
    low, high = evidence.interval_fullsteps.low, evidence.interval_fullsteps.high
    return table(
        ("peak deviation", ""),
        (
            ("before, mean", f"{plain(evidence.baseline_fullsteps, 4)} full steps"),
            ("best, mean", f"{plain(evidence.winner_fullsteps, 4)} full steps"),
            ("difference", f"{plain(evidence.difference_fullsteps, 3)} full steps ({100 * evidence.share:.3g} %)"),
            ("its 95 % interval", f"{plain(low, 3)} to {plain(high, 3)} full steps"),
            ("p", f"{evidence.p:.3g}"),
        ),
    )


def _off(record: StudyRecord) -> list[float]:
    """Deviation of each pair, new less old [full steps]."""
    told = [(pair.baseline_deviation_fullsteps, pair.winner_deviation_fullsteps) for pair in record.pairs]
    return [new - old for old, new in told if old is not None and new is not None]


def _front(record: StudyRecord) -> str:
    """Deviation over time of what held: the front as a line, the best one and what was before with their names."""
    held = [
        (trial, trial.figures.time_s, trial.figures.deviation_fullsteps)
        for trial in record.trials
        if trial.state == "feasible"
    ]
    known = [(trial, time_s, off) for trial, time_s, off in held if time_s is not None and off is not None]
    before = record.baseline_figures
    assert before is not None
    assert before.time_s is not None
    assert before.deviation_fullsteps is not None
    x = PlotAxis([before.time_s, *(time_s for _, time_s, _ in known)], EDGE, WIDTH - 10)
    y = PlotAxis([before.deviation_fullsteps, *(off for _, _, off in known)], HEIGHT - EDGE, 10)
    along = sorted((time_s, off) for trial, time_s, off in known if trial.number in record.front)
    marks = line([(x.at(time_s), y.at(off)) for time_s, off in along], COLOURS["feasible"], "front", dashed=True)
    for trial, time_s, off in known:
        said = f"trial {trial.number}: {plain(time_s, 4)} s, {plain(off, 3)} full steps"
        marks += mark(x.at(time_s), y.at(off), "feasible" if trial.number in record.front else "pruned", said)
        if trial.number == record.best:
            marks += _name(x.at(time_s), y.at(off), "best")
    marks += mark(x.at(before.time_s), y.at(before.deviation_fullsteps), "failed", "before")
    marks += _name(x.at(before.time_s), y.at(before.deviation_fullsteps), "before")
    numbers = ", ".join(str(number) for number in sorted(record.front))
    return frame(x, y, "time [s]", "peak deviation [full steps]", marks) + (
        f"<p>Trials that none beats in both: {numbers}. Each held when it was tried; only the best one was proved.</p>"
    )


def _name(x: float, y: float, name: str) -> str:
    return f'<text x="{x + 8:.1f}" y="{y - 6:.1f}">{name}</text>'


def _settings(record: StudyRecord, best: Trial | None) -> str:
    rows = []
    for name, value in record.baseline_setting.items():
        unit = record.units.get(name, "")
        rows.append((f"{name} [{unit}]", plain(value, 6), "" if best is None else plain(best.setting[name], 6)))

    def figures(of: Figures | None, name: str) -> str:
        return "" if of is None else number(getattr(of, name))

    found = None if best is None else best.figures
    rows.append(("time [s]", figures(record.baseline_figures, "time_s"), figures(found, "time_s")))
    before = [] if record.baseline_figures is None else record.baseline_figures.by_distance_s
    after = found.by_distance_s if found is not None else []
    for index, distance in enumerate(record.document.wanted(FastestMove).every_distance if before else ()):
        rows.append((f"by {distance} microsteps [s]", number(before[index]), number(after[index] if after else None)))
    rows.append(
        (
            "peak deviation [full steps]",
            figures(record.baseline_figures, "deviation_fullsteps"),
            figures(found, "deviation_fullsteps"),
        )
    )
    return table(("", "before", "best"), rows)


def _trials(record: StudyRecord) -> str:
    names = list(record.units)
    rows = [
        (
            str(trial.number),
            *(plain(trial.setting[name], 5) for name in names),
            WORDS[trial.state],
            number(trial.figures.time_s),
            number(trial.figures.deviation_fullsteps, 3),
            trial.why,
        )
        for trial in record.trials
    ]
    heads = ("trial", *(f"{name} [{record.units[name]}]" for name in names), "", "time [s]", "deviation", "why")
    return table(heads, rows)


def _tried(record: StudyRecord) -> list[Trial]:
    return [trial for trial in record.trials if trial.state in ("feasible", "infeasible")]


def _history(record: StudyRecord) -> str:
    tried = [(trial, trial.figures.time_s or trial.expected_s or 0.0) for trial in _tried(record)]
    if len(tried) < 2:
        return ""
    x = PlotAxis([trial.number for trial, _ in tried], EDGE, WIDTH - 10)
    y = PlotAxis([value for _, value in tried], HEIGHT - EDGE, 10)
    marks = "".join(
        mark(x.at(trial.number), y.at(value), trial.state, f"trial {trial.number}: {plain(value, 4)} s, {trial.why}")
        for trial, value in tried
    )
    return frame(x, y, "trial", "time [s]", marks)


def _scatter(record: StudyRecord) -> str:
    tried, names = _tried(record), list(record.units)
    if len(tried) < 2 or len(names) < 2:
        return ""
    first, second = names[:2]
    x = PlotAxis([trial.setting[first] for trial in tried], EDGE, WIDTH - 10, log=True)
    y = PlotAxis([trial.setting[second] for trial in tried], HEIGHT - EDGE, 10, log=True)
    marks = "".join(
        mark(x.at(trial.setting[first]), y.at(trial.setting[second]), trial.state, f"trial {trial.number}")
        for trial in tried
    )
    return frame(x, y, f"{first} [{record.units[first]}]", f"{second} [{record.units[second]}]", marks)
