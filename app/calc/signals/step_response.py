"""How well an axis followed: the figures of a recorded step response, or of an answer to a load.

The numbers are those of control engineering's textbooks: overshoot, settling time into a band, rms and
peak of the deviation, and the integral of its absolute value (IAE).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Score:
    """Distances in microsteps, times in seconds from t = 0 of the recording."""

    overshoot: float
    """Farthest beyond the target in the direction of the step; after a load: beyond the target on the rebound."""
    overshoot_ratio: float | None
    """Of the distance; None for a load."""
    arrival_s: float | None
    """When the command had arrived to stay; None for a load, or where it never did."""
    settling_s: float | None
    """From when on the encoder stays within `band` of the target; None where it is outside at the end."""
    rms: float
    peak: float
    iae: float
    final_error: float
    band: float


def score(
    time_s: FloatArray, target: float, commanded: FloatArray, encoder: FloatArray, band: float, distance: float = 0.0
) -> Score:
    """Score a recording; only what lies at t >= 0 counts.

    Parameters
    ----------
    time_s, commanded, encoder : array_like of float, one length [samples]
        Seconds from the step or the load; positions [microsteps]. Rows with NaN are left out.
    target : float
        Where the axis shall rest [microsteps].
    band : float
        How near the encoder has to be to count as settled [microsteps].
    distance : float
        Of the step, signed [microsteps]; 0 for a load.

    Raises ValueError where fewer than two samples are left, or `band` is not above 0.
    """
    if not band > 0:
        raise ValueError(f"band is above 0 microsteps, got {band}")
    known = (time_s >= 0) & np.isfinite(commanded) & np.isfinite(encoder)
    t, command, actual = time_s[known], commanded[known], encoder[known]
    if len(t) < 2:
        raise ValueError(f"a score needs two samples behind t = 0 at least, got {len(t)}")
    deviation = actual - command
    error = actual - target
    if distance:
        beyond = np.sign(distance) * error
    else:  # the rebound is on the other side of where the load has pushed the axis first
        pushed = error[np.argmax(np.abs(error))]
        beyond = -np.sign(pushed) * error
    overshoot = float(max(beyond.max(), 0.0))
    span_s = t[-1] - t[0]
    return Score(
        overshoot=overshoot,
        overshoot_ratio=overshoot / abs(distance) if distance else None,
        arrival_s=_stays_from(t, command == target) if distance else None,
        settling_s=_stays_from(t, np.abs(error) <= band),
        rms=float(np.sqrt(np.trapezoid(deviation**2, t) / span_s)) if span_s > 0 else float(abs(deviation[-1])),
        peak=float(np.abs(deviation).max()),
        iae=float(np.trapezoid(np.abs(deviation), t)),
        final_error=float(error[-1]),
        band=band,
    )


def _stays_from(t: FloatArray, good: NDArray[np.bool_]) -> float | None:
    """The time of the first sample from which on all are good; None where the last one is not."""
    bad = np.flatnonzero(~good)
    if not len(bad):
        return float(t[0])
    return None if bad[-1] == len(t) - 1 else float(t[bad[-1] + 1])
