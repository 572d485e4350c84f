"""How good a position loop is: a mark for each thing that was measured or worked out, and the worst of them.

Limits of the margins: K. J. Astrom and R. M. Murray, Feedback Systems, 2008 (phase 30 to 60 degrees, gain 2 to 5).
Those of overshoot, settling and load are ours: what a step of a bench axis shows as calm, as bearable, or as neither.
"""

from __future__ import annotations

from collections.abc import Iterator

from ...number_text import plain
from .found import Graded, LoopFound, Mark

MARKS: tuple[Mark, ...] = ("good", "fair", "poor")
"""From the best to the worst."""
PHASE_DEG, GAIN = (45.0, 30.0), (2.0, 1.5)
OVERSHOOT = (0.3, 0.5)
SETTLING_CYCLES = (2.0, 4.0)
"""Of the bandwidth."""
LOAD_FULLSTEPS = (0.25, 1.0)
"""Without a loop the shaft lags by a full step where its load takes all its torque."""


def graded(found: LoopFound) -> list[Graded]:
    """Each thing that is known of it."""
    return [Graded(what=what, figure=figure, mark=mark) for what, figure, mark in _marks(found)]


def worst_mark(of: list[Graded]) -> Mark:
    """A loop is as good as its worst thing."""
    return max((one.mark for one in of), key=MARKS.index)


def _marks(found: LoopFound) -> Iterator[tuple[str, str, Mark]]:
    phase, gain, overshoot = round(found.phase_margin_deg, 1), round(found.gain_margin, 2), found.overshoot
    yield "phase margin of the worst plant", f"{plain(phase, 3)} deg", _mark(-phase, *(-each for each in PHASE_DEG))
    yield "gain margin of the worst plant", plain(gain, 3), _mark(-gain, *(-each for each in GAIN))
    if overshoot is not None:
        high = overshoot.interval.high
        yield "overshoot", f"{100 * high:.3g} % at the most (95 %)", _mark(high, *OVERSHOOT)
        if found.settling_s is None:
            yield "settling", f"not within {plain(found.step.time_s[-1], 3) if found.step else 0} s", "poor"
        else:
            cycles = found.settling_s * found.bandwidth_hz
            figure = f"{plain(1e3 * found.settling_s, 3)} ms, {plain(cycles, 2)} cycles of the bandwidth"
            yield "settling", figure, _mark(cycles, *SETTLING_CYCLES)
    if (load := found.load) is not None:
        figure = f"off by {plain(load.deviation_fullsteps, 3)} full steps at the most"
        yield "under the load of its own acceleration", figure, _mark(load.deviation_fullsteps, *LOAD_FULLSTEPS)


def _mark(value: float, good: float, fair: float) -> Mark:
    return "good" if value <= good else "fair" if value <= fair else "poor"
