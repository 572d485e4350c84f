"""What a report tells of StallGuard: rates, ROC and distributions of each speed."""

from __future__ import annotations

from ...html_report import EDGE, HEIGHT, WIDTH, PlotAxis, frame, line, table
from ...number_text import plain
from ..record import StudyRecord, Trial
from .found import Rate, StallAlone, StallFound, StallSpeed
from .setting import FILTER, THRESHOLD

FREE, STOPS = "#2b8a3e", "#e03131"


def sections(record: StudyRecord) -> list[str]:
    """Each with its heading."""
    found = record.stallguard
    if found is None:
        return []
    about = (
        f"<p>StallGuard{found.generation}. Load values are those at threshold 0; one more of the threshold adds "
        f"{plain(found.slope, 3)} to them. A free run is {plain(found.run_fullsteps)} full steps long; a stall that is "
        f"not told {plain(found.push_fullsteps)} full steps into the stop is missed. Rates are of held-out runs, "
        "their bounds one-sided, 95 % (Clopper and Pearson), by the threshold that is told beside. "
        "Alone: the threshold that suits that speed best by the runs that were measured, which it was chosen by.</p>"
    )
    parts = ["<h2>How sure</h2>" + about + _rates(record, found)]
    parts += [
        f"<h2>At {plain(one.speed_rps)} turns/s</h2>"
        + _distributions(one, found.level if one.own is None else one.own.level)
        + _roc(one)
        for one in found.speeds
        if one.roc
    ]
    return parts


def _rate(rate: Rate | None) -> str:
    return "not tried" if rate is None else f"{rate.wrong} of {rate.runs}: below {100 * rate.most:.2g} %"


def _alone(alone: StallAlone | None) -> str:
    if alone is None:
        return ""
    more = "" if alone.may_do else ", too many"
    return (
        f"{alone.threshold}{' with the filter' if alone.filtered else ''}: {alone.false} of {alone.free_runs} false, "
        f"{alone.missed} of {alone.stops} missed{more}"
    )


def _threshold(one: StallSpeed, best: Trial | None) -> str:
    """What is proved at a speed; empty where nothing is."""
    if one.own is not None:
        return f"{one.own.threshold}{' with the filter' if one.own.filtered else ''}, its own"
    if best is None or one.why:
        return ""
    return f"{plain(best.setting[THRESHOLD])}{' with the filter' if best.setting[FILTER] else ''}"


def _rates(record: StudyRecord, found: StallFound) -> str:
    best = record.trial(record.best)
    rows = [
        (
            plain(one.speed_rps),
            _threshold(one, best),
            *map(_rate, (one.false, one.missed, one.false_before, one.missed_before)),
            one.why,
            _alone(one.alone),
        )
        for one in found.speeds
    ]
    heads = (
        "turns/s",
        "threshold",
        "false stalls",
        "stalls missed",
        "false, before",
        "missed, before",
        "why not",
        "alone, not held out",
    )
    return table(heads, rows)


def _distributions(one: StallSpeed, level: float | None) -> str:
    x = PlotAxis([*one.values, *([] if level is None else [level])], EDGE, WIDTH - 10)
    y = PlotAxis([0.0, *one.free_share, *one.stop_share], HEIGHT - EDGE, 10)
    middles = [(low + high) / 2 for low, high in zip(one.values, one.values[1:], strict=False)]
    marks = "".join(
        line([(x.at(value), y.at(share)) for value, share in zip(middles, shares, strict=True)], colour, title)
        for shares, colour, title in (
            (one.free_share, FREE, "free runs"),
            (one.stop_share, STOPS, "against the stop"),
        )
    )
    if level is not None:
        marks += line([(x.at(level), HEIGHT - EDGE), (x.at(level), 10.0)], "#868e96", "a stall at or below this")
    return frame(x, y, "load value: green free runs, red against the stop", "share", marks)


def _roc(one: StallSpeed) -> str:
    points = [(0.0, 1.0), *((point.false, point.missed) for point in one.roc), (1.0, 0.0)]
    x = PlotAxis([0.0, 1.0], EDGE, WIDTH - 10)
    y = PlotAxis([0.0, 1.0], HEIGHT - EDGE, 10)
    marks = line([(x.at(false), y.at(missed)) for false, missed in points], FREE, "each threshold")
    return frame(x, y, "false stalls, share of free runs", "missed stalls, share", marks)
