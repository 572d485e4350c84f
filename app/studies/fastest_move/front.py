"""Two objectives, time and deviation under way: the front that nothing beats, and which setting of it is proposed."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..record import Figures, Trial
from ..search import unbeaten


def front_of(trials: Sequence[Trial]) -> list[Trial]:
    """Those that held which no other beats: nowhere worse and somewhere better."""
    held = [trial for trial in trials if trial.state == "feasible" and _known(trial.figures)]
    return unbeaten(held, lambda trial: _of(trial.figures))


def proposed(
    front: Sequence[Trial], before: Figures, smallest_gain: float, deviation_max_fullsteps: float | None
) -> Trial | None:
    """The setting of the front that is to be proved; None where none gains more than can be told.

    With a bound of the deviation the fastest that keeps it, faster than before unless that was beyond the bound. Else
    the knee of those that are faster than before, or, where none is, of those that deviate less.
    """
    time_s, deviation = _of(before)
    faster = [trial for trial in front if _of(trial.figures)[0] < time_s * (1 - smallest_gain)]
    if deviation_max_fullsteps is not None:
        among = faster if deviation <= deviation_max_fullsteps else front
        kept = [trial for trial in among if _of(trial.figures)[1] <= deviation_max_fullsteps]
        return min(kept, key=lambda trial: _of(trial.figures), default=None)
    calmer = [trial for trial in front if _of(trial.figures)[1] < deviation * (1 - smallest_gain)]
    return knee(faster or calmer)


def knee(front: Sequence[Trial]) -> Trial | None:
    """The one nearest to the least time with the least deviation, both as shares of their range among these; of those
    as near the fastest. None of none."""
    if not front:
        return None
    times, deviations = zip(*(_of(trial.figures) for trial in front), strict=True)

    def away(trial: Trial) -> tuple[float, float]:
        time_s, deviation = _of(trial.figures)
        return math.hypot(_share(time_s, times), _share(deviation, deviations)), time_s

    return min(front, key=away)


def _share(value: float, among: Sequence[float]) -> float:
    low, high = min(among), max(among)
    return (value - low) / (high - low) if high > low else 0.0


def _known(figures: Figures) -> bool:
    return figures.time_s is not None and figures.deviation_fullsteps is not None


def _of(figures: Figures) -> tuple[float, float]:
    assert figures.time_s is not None
    assert figures.deviation_fullsteps is not None
    return figures.time_s, figures.deviation_fullsteps
