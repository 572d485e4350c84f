"""What a slow turn there and back tells of an axis: what the encoder counts, and what lies between both ways."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .ring_down import Fitted

# scipy is imported where it is used: the server starts without it.

FloatArray = NDArray[np.float64]

PARTS = 12
"""Of each way: what is left of the fit is taken as independent between them."""
ELECTRICAL = (1, 2, 4)
"""Orders of the electrical angle at which a motor stands beside its field."""
LEAST_SAMPLES = 400
TOLD = 5
"""Columns, the first ones, of what is told: the others are there to be taken out."""
MIXED_MAX = 0.01
"""How much of another order's amplitude may be in what is told: positions are whole microsteps, which mixes some."""


@dataclass(frozen=True, slots=True)
class SlowTurn:
    """A turn there and back. ratio : encoder over position; apart : position ahead of the encoder, there less back;
    eccentricity : once a turn [all in microsteps]."""

    ratio: Fitted
    apart: Fitted
    eccentricity: Fitted
    residual: float


def fit_slow_turn(
    position: FloatArray, encoder: FloatArray, forward: NDArray[np.bool_], turn: float, period: float
) -> SlowTurn:
    """Fit whole turns there and back [microsteps]; `period` is an electrical one.

    Orders of the electrical angle that the samples cannot tell from each other are shared out between them. Raises
    ValueError for too little, and where what is told cannot be told from such an order.
    """
    from scipy import stats

    if len(position) < LEAST_SAMPLES or np.ptp(position) < 0.95 * turn:
        raise ValueError(f"a fit needs {LEAST_SAMPLES} samples of a whole turn, got {len(position)}")
    x = position - position.mean()
    columns = [np.ones_like(x), x / turn, np.where(forward, -0.5, 0.5)]
    shaft, angle = 2 * math.pi * position / turn, 2 * math.pi * position / period
    columns += [of(order * shaft) for order in (1, 2) for of in (np.sin, np.cos)]
    for way in (forward, ~forward):
        columns += [of(order * angle) * way for order in ELECTRICAL for of in (np.sin, np.cos)]
    design = np.stack(columns, axis=1)
    found, *_ = np.linalg.lstsq(design, encoder, rcond=None)
    residual = encoder - design @ found
    influence = np.linalg.pinv(design, rcond=1e-9)
    if not np.allclose((influence @ design)[:TOLD], np.eye(TOLD, design.shape[1]), atol=MIXED_MAX):
        raise ValueError("the samples lie at the same places of the electrical period: turn a little slower")
    part = np.minimum((PARTS * (position - position.min()) / np.ptp(position)).astype(int), PARTS - 1) + PARTS * forward
    errors = []
    for at in range(2 * PARTS):
        one = part == at
        told = influence[:, one]
        # How far all moves where that part is left out: of parts that it was fitted to a fit leaves too little.
        errors.append(np.linalg.solve(np.eye(len(told)) - told @ design[one], told @ residual[one]))
    half = float(stats.t.ppf(0.975, 2 * PARTS - 8)) * np.linalg.norm(errors, axis=0)
    return SlowTurn(
        Fitted(float(found[1]) / turn, float(half[1]) / turn),
        Fitted(float(found[2]), float(half[2])),
        Fitted(float(math.hypot(found[3], found[4])), float(max(half[3], half[4]))),
        float(np.sqrt(np.mean(residual**2))),
    )
