"""What a new setting gains, and what is given up for it, in words."""

from __future__ import annotations

from ...number_text import plain
from ..proof import LEVEL
from ..record import DeviationEvidence, Evidence


def effects_told(evidence: Evidence, smallest_gain: float) -> str:
    """The effects of a setting that is shown to be better, with their intervals; of two objectives the gain first.

    smallest_gain : what is less than this share is no difference
    """
    other = evidence.deviation
    if other is None:
        return _time(evidence)
    faster, calmer = evidence.significant, other.significant
    if faster and calmer:
        return f"{_time(evidence)} and {_deviation(other)}"
    gained, beside = (_time(evidence), _deviation(other)) if faster else (_deviation(other), _time(evidence))
    low, p = (
        (other.interval_fullsteps.low / (other.baseline_fullsteps or 1.0), other.p)
        if faster
        else (evidence.interval_s.low / evidence.baseline_s, evidence.p)
    )
    shown = low > smallest_gain and p < LEVEL
    return f"{gained}, {'for' if shown else 'perhaps'} {beside}"


def _time(evidence: Evidence) -> str:
    """The least digits tell how much faster; what it is slower is told as more time."""
    old, new, between = evidence.baseline_s, evidence.winner_s, evidence.interval_s
    less = evidence.share <= 0
    low, high = (-between.high, -between.low) if less else (between.low, between.high)
    share = f"{100 * abs(evidence.share):.3g} % {'faster' if less else 'more time'}"
    return (
        f"{share} ({plain(old, 4)} s to {plain(new, 4)} s; 95 %: "
        f"{plain(low * 1e3, 3)} to {plain(high * 1e3, 3)} ms {'less' if less else 'more'})"
    )


def _deviation(of: DeviationEvidence) -> str:
    less, between = of.share <= 0, of.interval_fullsteps
    low, high = (-between.high, -between.low) if less else (between.low, between.high)
    word = "less" if less else "more"
    return (
        f"{100 * abs(of.share):.3g} % {word} deviation ({plain(of.baseline_fullsteps, 3)} to "
        f"{plain(of.winner_fullsteps, 3)} full steps; 95 %: {plain(low, 2)} to {plain(high, 2)} {word})"
    )
