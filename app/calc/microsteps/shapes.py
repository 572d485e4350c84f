"""The wave shapes from which a microstep table is made: circle (sine), box, rhomb, and what lies between.

Source: DS-TMC428 12.3. Shapes are functions of the position in the quarter period, t = phi / (pi/2), so
that the straight ones are exact in floating point (the sheet's phi would put 32/64 just below 1/2).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

SIGMA_RANGE = (-1.0, 1.0)
SIGMA_RANGE_OF_THE_SHEET = (-0.5, 0.5)


def quarter_positions(count: int = 64) -> NDArray[np.float64]:
    """The positions t = i / count, i = 0..count-1, so phi_i = t * pi/2 [rad]; the quarter's end is not among them."""
    return np.arange(count) / count


def circle(t: ArrayLike) -> NDArray[np.float64]:
    """sin(phi) at t = phi / (pi/2), any shape: current vectors lie on the unit circle."""
    return np.sin(np.asarray(t, dtype=np.float64) * (math.pi / 2))


def box(t: ArrayLike) -> NDArray[np.float64]:
    """A trapezoid: straight up to 1/sqrt(2) at phi = pi/4, then flat. Current vectors lie on a square.

    The square stands inside the unit circle and touches it with its corners. The slope of the sheet
    is 4 / (pi * sqrt(2)) per radian, which is sqrt(2) per quarter period.
    """
    return np.minimum(np.asarray(t, dtype=np.float64) * math.sqrt(2), 1 / math.sqrt(2))


def rhomb(t: ArrayLike) -> NDArray[np.float64]:
    """A triangle: straight up to 1 at phi = pi/2. Current vectors lie on a square that stands on its corner."""
    return np.array(t, dtype=np.float64)


def f_sigma(t: ArrayLike, sigma: float) -> NDArray[np.float64]:
    """The shape function at t = phi / (pi/2) in 0..1, any shape; values 0..1.

    `sigma` 0 is the circle, +1 the box, -1 the rhomb, and between them the straight mixture. In the
    rhomb branch sigma itself is negative, so the bracket is (circle - rhomb), the other way round
    than in the box branch. Raises ValueError for sigma outside -1..1 (also NaN) and t outside 0..1.
    """
    if not SIGMA_RANGE[0] <= sigma <= SIGMA_RANGE[1]:
        raise ValueError(f"sigma is {sigma}, allowed is {SIGMA_RANGE[0]:g}..{SIGMA_RANGE[1]:g}")
    at = np.asarray(t, dtype=np.float64)
    if not np.all((at >= 0) & (at <= 1)):
        raise ValueError("a shape is defined for t = phi / (pi/2) in 0..1")
    if sigma > 0:
        return np.asarray(circle(at) + sigma * (box(at) - circle(at)))
    if sigma < 0:
        return np.asarray(circle(at) + sigma * (circle(at) - rhomb(at)))
    return circle(at)
