"""What a report tells of torque over speed: the curve with its intervals, and the ramp below it."""

from __future__ import annotations

from ...html_report import COLOURS, EDGE, HEIGHT, WIDTH, PlotAxis, frame, line, mark, number, table
from ...number_text import plain
from ..record import StudyRecord
from .found import TorqueFound


def sections(record: StudyRecord) -> list[str]:
    """Each with its heading."""
    found = record.torque
    if found is None or not found.points:
        return []
    return ["<h2>Torque over speed</h2>" + _plot(found) + _ramp(found) + _points(found)]


def _plot(found: TorqueFound) -> str:
    rows = []
    for point in found.points:
        middle, around, unit = point.acceleration_radps2, point.interval_radps2, "rad/s^2"
        if point.torque_nm is not None and point.interval_nm is not None:
            middle, around, unit = point.torque_nm, point.interval_nm, "N m"
        rows.append((point.speed_rps, middle, around))
    x = PlotAxis([0.0, *(speed for speed, _, _ in rows)], EDGE, WIDTH - 10)
    y = PlotAxis([0.0, *(around.high for _, _, around in rows)], HEIGHT - EDGE, 10)
    marks = line([(x.at(speed), y.at(middle)) for speed, middle, _ in rows], COLOURS["feasible"], "torque over speed")
    for speed, middle, around in rows:
        whisker = f"M{x.at(speed):.1f} {y.at(around.low):.1f}V{y.at(around.high):.1f}"
        marks += f'<path d="{whisker}" stroke="{COLOURS["feasible"]}" stroke-width="2"/>'
        marks += mark(x.at(speed), y.at(middle), "feasible", f"{plain(speed, 3)} turns/s: {plain(middle, 4)} {unit}")
    name = "torque [N m]" if unit == "N m" else "acceleration [rad/s^2]"
    return frame(x, y, "speed [turns/s]", name, marks)


def _ramp(found: TorqueFound) -> str:
    if found.margin is None:
        return ""
    asked, times = plain(found.margin.acceleration_radps2, 4), plain(found.margin.times, 3)
    return f"<p>The ramp asks for {asked} rad/s^2; at its worst speed {times} times that is there.</p>"


def _points(found: TorqueFound) -> str:
    rows = [
        (
            plain(point.speed_rps, 4),
            plain(point.acceleration_radps2, 4),
            f"{plain(point.interval_radps2.low, 4)} to {plain(point.interval_radps2.high, 4)}",
            number(point.torque_nm),
            ""
            if point.interval_nm is None
            else f"{plain(point.interval_nm.low, 4)} to {plain(point.interval_nm.high, 4)}",
            str(point.slips),
        )
        for point in found.points
    ]
    return table(("turns/s", "rad/s^2", "95 %", "N m", "95 %", "slips"), rows)
