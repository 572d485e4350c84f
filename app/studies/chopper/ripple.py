"""How much a shaft shakes at constant speed: encoder less position, of one run."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ...procedures.procedure import Failed
from ..moves import Sampled

LEAST_SAMPLES = 60
SLOW = 3
"""Degree of the polynomial that takes away what changes slowly on the way: lag, eccentricity of the encoder."""
SAMPLES_HZ = 1000.0
OFF_BEAT = 0.382
"""Samples come so far off a whole number a period: no order of the electrical angle stands still among them."""


def rate_for(period_hz: float) -> float:
    """How often to sample a motor whose electrical period comes so often [Hz]."""
    return period_hz * (max(round(SAMPLES_HZ / period_hz), 2) - OFF_BEAT)


def ripple_of(run: Sampled, low: float, high: float, full_step: int) -> float:
    """Root mean square of what is faster than a polynomial on the way from `low` to `high` [full steps].

    Raises Failed where too few samples came.
    """
    counts = np.isfinite(run.encoder) & (run.position >= low) & (run.position <= high)
    position, off = run.position[counts], (run.encoder - run.position)[counts]
    if len(off) < LEAST_SAMPLES:
        raise Failed(
            f"{len(off)} samples came of a run, {LEAST_SAMPLES} are needed: the link is too slow, or something else "
            "keeps it busy"
        )
    scaled = (position - (low + high) / 2) / ((high - low) / 2)
    slow = np.polynomial.polynomial.Polynomial.fit(scaled, off, SLOW)
    return float(np.std(off - slow(scaled))) / full_step


def together(by_speed: Sequence[float], least: float) -> float:
    """One figure of all speeds: their geometric mean, each `least` at the least (what the encoder can show at all)."""
    return math.exp(sum(math.log(max(each, least)) for each in by_speed) / len(by_speed))
