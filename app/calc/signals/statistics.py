"""What a stretch of a measurement comes down to: a few figures by which two of them are compared."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BAND = 0.02
"""Settled is what stays within this share of the way of where it ends."""


@dataclass(frozen=True, slots=True)
class Figures:
    """Of the samples that are there. Overshoot and settling are those of a step: None where the values go nowhere.

    peak : the value farthest from 0, with its sign
    overshoot : how far beyond its last value it went, in the direction of the step [unit of the channel]
    settling_s : from the first sample until it stays within 2 % of the step of its last value [s]
    """

    samples: int
    missing: int
    minimum: float | None
    maximum: float | None
    mean: float | None
    rms: float | None
    peak: float | None
    first: float | None
    last: float | None
    overshoot: float | None
    settling_s: float | None


def figures(time_s: FloatArray, values: FloatArray) -> Figures:
    """Figures of `values` [rows] at `time_s` [rows, s]; NaN is missing. All None where nothing is there."""
    there = np.isfinite(values)
    known, at_s = values[there], time_s[there]
    missing = int(len(values) - len(known))
    if not len(known):
        return Figures(0, missing, *[None] * 9)
    first, last = float(known[0]), float(known[-1])
    step = last - first
    overshoot = settling_s = None
    # A step ends elsewhere than it began; noise around one place has neither overshoot nor settling time.
    if abs(step) > 0.5 * float(np.ptp(known)):
        beyond = (known - last) * np.sign(step)
        overshoot = max(0.0, float(beyond.max()))
        outside = np.flatnonzero(np.abs(known - last) > BAND * abs(step))
        settling_s = float(at_s[min(outside[-1] + 1, len(at_s) - 1)] - at_s[0]) if len(outside) else 0.0
    return Figures(
        samples=len(known),
        missing=missing,
        minimum=float(known.min()),
        maximum=float(known.max()),
        mean=float(known.mean()),
        rms=float(np.sqrt(np.mean(known**2))),
        peak=float(known[np.abs(known).argmax()]),
        first=first,
        last=last,
        overshoot=overshoot,
        settling_s=settling_s,
    )
