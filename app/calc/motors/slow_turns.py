"""What slow turns there and back tell of an axis: what the encoder counts, and friction told apart from backlash.

Friction holds the rotor behind its field by asin(friction / torque), so less current makes it more; backlash before the
encoder stays what it is. Turns with two currents tell one from the other.
"""

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
VIBRATES = 0.006
"""Friction of a rotor that vibrates as it turns is told wrong by up to such a share of the holding torque, which no
residual shows (so it was for 25 of 26 emulated motors). Backlash is wrong by twice that angle then."""
MOST_SHARE = 0.9
"""Friction beyond this share of the torque is none that a motor turns against."""


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
    """Fit whole turns there and back [microsteps]; `period` is an electrical one. Raises ValueError for too little."""
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
    inverse = np.linalg.inv(design.T @ design)
    part = np.minimum((PARTS * (position - position.min()) / np.ptp(position)).astype(int), PARTS - 1) + PARTS * forward
    scores = np.array([design[part == at].T @ residual[part == at] for at in range(2 * PARTS)])
    variance = np.diag(inverse @ (scores.T @ scores) @ inverse)
    half = float(stats.t.ppf(0.975, 2 * PARTS - 8)) * np.sqrt(variance)
    return SlowTurn(
        Fitted(float(found[1]) / turn, float(half[1]) / turn),
        Fitted(float(found[2]), float(half[2])),
        Fitted(float(math.hypot(found[3], found[4])), float(max(half[3], half[4]))),
        float(np.sqrt(np.mean(residual**2))),
    )


@dataclass(frozen=True, slots=True)
class Torn:
    """Friction as a share of the holding torque, and backlash [rad electrical]."""

    friction: Fitted
    backlash: Fitted


def at_standstill(slow: Torn, fast: Torn) -> Torn:
    """What is left at no speed at all, of turns at a speed and at twice that: viscous friction adds to the friction in
    proportion to the speed, and the time that a current needs to follow adds to what looks like backlash."""
    return Torn(
        _less(slow.friction, fast.friction).wider(VIBRATES), _less(slow.backlash, fast.backlash).wider(2 * VIBRATES)
    )


def _less(at_speed: Fitted, at_twice: Fitted) -> Fitted:
    return Fitted(2 * at_speed.value - at_twice.value, math.hypot(2 * at_speed.half, at_twice.half))


def _hysteresis(friction: float, detent: float, torque: float) -> float:
    """Between both ways, mean over the electrical angle [rad electrical]; all as shares of one torque."""
    angle = np.arange(64) * (2 * math.pi / 64)
    share = np.clip((friction + detent * np.sin(4 * angle)) / torque, -1.0, 1.0)
    return 2 * float(np.mean(np.arcsin(share)))


def friction_and_backlash(full: Fitted, less: Fitted, torque: float, detent: float = 0.0) -> Torn:
    """Friction as a share of the holding torque, and backlash [rad electrical], from what is between both ways with the
    full current and with `torque` of it [rad electrical]; `detent` is a share of the holding torque too.

    Raises ValueError where the difference is none that friction makes.
    """
    from scipy import optimize

    def more(friction: float) -> float:
        return _hysteresis(friction, detent, torque) - _hysteresis(friction, detent, 1.0)

    def friction_of(apart: float) -> float:
        most = MOST_SHARE * torque
        if apart > more(most):
            raise ValueError(f"with less current the rotor lags {apart:.3g} rad more: more than friction does")
        if apart <= 0:
            return 0.0
        return float(optimize.brentq(lambda friction: more(friction) - apart, 0.0, most))

    def both(of_full: float, of_less: float) -> tuple[float, float]:
        friction = friction_of(of_less - of_full)
        return friction, of_full - _hysteresis(friction, detent, 1.0)

    friction, backlash = both(full.value, less.value)
    moved = (both(full.value + full.half, less.value), both(full.value, less.value + less.half))
    halves = [
        math.hypot(moved[0][at] - (friction, backlash)[at], moved[1][at] - (friction, backlash)[at]) for at in (0, 1)
    ]
    return Torn(Fitted(friction, halves[0]), Fitted(backlash, halves[1]))
