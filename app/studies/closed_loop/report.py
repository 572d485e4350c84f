"""What a report tells of a closed loop: its Bode and Nichols plots, a step, and how sure."""

from __future__ import annotations

from ...html_report import EDGE, HEIGHT, WIDTH, PlotAxis, frame, line, number, table
from ...number_text import plain
from ..record import StudyRecord
from .found import LoopFound, LoopStep

MEASURED, EXPECTED = "#e8590c", "#1971c2"


def sections(record: StudyRecord) -> list[str]:
    """Each with its heading."""
    found = record.loop
    if found is None:
        return []
    loop = found.open_loop
    parts = [
        "<h2>Plant and loop</h2>" + _figures(found),
        "<h2>Bode</h2>"
        + _curve(loop.frequency_hz, loop.gain_db, "frequency [Hz]", "open loop [dB]", log=True)
        + _curve(loop.frequency_hz, loop.phase_deg, "frequency [Hz]", "phase [deg]", log=True),
        "<h2>Nichols</h2>" + _curve(loop.phase_deg, loop.gain_db, "phase [deg]", "open loop [dB]", log=False),
    ]
    if found.grade is not None:
        rows = [(one.what, one.figure, one.mark) for one in found.grades]
        parts.append(f"<h2>How good: {found.grade}</h2>" + table(("", "", ""), rows))
    if found.step is not None:
        parts.append("<h2>A step</h2>" + _step(found.step))
    return parts


def _figures(found: LoopFound) -> str:
    rows = [
        ("resonance", f"{plain(found.resonance_hz.value, 4)} Hz"),
        ("damping", plain(found.damping_ratio.value, 3)),
        (
            "what the fit leaves",
            f"{plain(found.ringing.residual_deg, 3)} deg electrical, alike {plain(found.alike, 2)}",
        ),
        ("P", f"{plain(found.proportional_per_s, 4)} 1/s"),
        ("I", f"{plain(found.integral_per_s2, 4)} 1/s^2"),
        ("phase margin of the worst plant", f"{plain(found.phase_margin_deg, 3)} deg"),
        ("gain margin of the worst plant", plain(found.gain_margin, 3)),
        ("bandwidth of the worst plant", f"{plain(found.bandwidth_hz, 3)} Hz"),
        ("overshoot, expected", f"{100 * found.expected_overshoot:.3g} %"),
    ]
    if found.overshoot is not None:
        low, high = 100 * found.overshoot.interval.low, 100 * found.overshoot.interval.high
        rows.append(("overshoot, measured", f"{100 * found.overshoot.value:.3g} %, 95 %: {low:.3g} to {high:.3g} %"))
        rows.append(("settled after", f"{number(found.settling_s)} s"))
    if (effect := found.effect) is not None:
        rows.append((f"difference to before, mean of {effect.pairs} pairs", f"{plain(effect.difference_s, 4)} s"))
        low, high = effect.interval_s.low, effect.interval_s.high
        rows.append(("its 95 % interval", f"{plain(low, 4)} to {plain(high, 4)} s; p {effect.p:.3g}"))
    return table(("", ""), rows)


def _curve(xs: list[float], ys: list[float], x_name: str, y_name: str, *, log: bool) -> str:
    x, y = PlotAxis(xs, EDGE, WIDTH - 10, log=log), PlotAxis(ys, HEIGHT - EDGE, 10)
    points = [(x.at(a), y.at(b)) for a, b in zip(xs, ys, strict=True)]
    return frame(x, y, x_name, y_name, line(points, EXPECTED, y_name))


def _step(step: LoopStep) -> str:
    x, y = PlotAxis(step.time_s, EDGE, WIDTH - 10), PlotAxis([*step.measured, *step.expected], HEIGHT - EDGE, 10)
    drawn = "".join(
        line([(x.at(t), y.at(value)) for t, value in zip(step.time_s, curve, strict=True)], colour, name)
        for curve, colour, name in ((step.measured, MEASURED, "measured"), (step.expected, EXPECTED, "expected"))
    )
    legend = f'<p><b style="color:{MEASURED}">measured</b>, <b style="color:{EXPECTED}">expected</b></p>'
    return frame(x, y, "time [s]", "encoder, share of the step", drawn) + legend
