"""What an encoder tells of a slow turn there and back: its ratio, the play between both ways, its eccentricity."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
NORMAL_95 = 1.96
BLOCKS = 20
"""Residuals of neighbouring samples are alike: they are counted as so many independent ones a way at the most."""


@dataclass(frozen=True, slots=True)
class EncoderFit:
    """Encoder over position. Amplitudes and play in microsteps, phases in radians of the shaft.

    ratio : counts of the encoder, in what it is set to be microsteps, a microstep of the position; 1 where it is right
    eccentricity : amplitude of what comes once a turn; None where less than a turn was seen
    twice : of what comes twice a turn
    """

    ratio: float
    ratio_interval: tuple[float, float]
    play: float
    play_interval: tuple[float, float]
    residual: float
    eccentricity: float | None
    eccentricity_interval: tuple[float, float] | None
    twice: float | None


def fit_encoder(position: FloatArray, encoder: FloatArray, forward: NDArray[np.bool_], turn: float) -> EncoderFit:
    """Fit one way there and back [microsteps], `forward` where it was there; `turn` is a turn of the motor.

    Least squares of encoder = a + ratio * position + play/2 * (there or back) + orders 1 and 2 of the shaft. Raises
    ValueError for fewer than 40 samples or a way of nothing.
    """
    if len(position) < 40 or np.ptp(position) <= 0:
        raise ValueError(f"a fit needs 40 samples of a way, got {len(position)} over {np.ptp(position):g} microsteps")
    middle = position.mean()
    whole = np.ptp(position) >= 0.95 * turn
    angle = 2 * math.pi * position / turn
    columns = [np.ones_like(position), position - middle, np.where(forward, 0.5, -0.5)]
    if whole:
        columns += [np.sin(angle), np.cos(angle), np.sin(2 * angle), np.cos(2 * angle)]
    design = np.stack(columns, axis=1)
    found, *_ = np.linalg.lstsq(design, encoder, rcond=None)
    residual = encoder - design @ found
    independent = min(len(position), 2 * BLOCKS)
    freedom = max(independent - len(columns), 1)
    variance = float(residual @ residual) / len(position) * independent / freedom
    covariance = np.linalg.inv(design.T @ design * (independent / len(position))) * variance
    half = NORMAL_95 * np.sqrt(np.diag(covariance))

    def between(at: int) -> tuple[float, float]:
        return float(found[at] - half[at]), float(found[at] + half[at])

    once = twice = None
    once_interval = None
    if whole:
        once, twice = float(np.hypot(found[3], found[4])), float(np.hypot(found[5], found[6]))
        wide = float(max(half[3], half[4]))
        once_interval = (max(0.0, once - wide), once + wide)
    return EncoderFit(
        ratio=float(found[1]),
        ratio_interval=between(1),
        play=float(found[2]),
        play_interval=between(2),
        residual=float(np.sqrt(np.mean(residual**2))),
        eccentricity=once,
        eccentricity_interval=once_interval,
        twice=twice,
    )
