"""The encodable wave nearest to any wanted one: exact, by dynamic programming over segments and values.

A state is (segment, its pair of differences, value) after an entry; the cheapest way into each state is all that the
entries after it need to know. So the result is the best of all encodable waves with the wanted `mirror`, not a guess.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..driver_chain.ram_words import whole_number
from .mslut import CURRENT_MAX, CURRENT_MIN, ENTRIES, MIRROR_DEFAULT, SEGMENTS, STEP_MAX, STEP_MIN, VALUE_MAX, Wave

Norm = Literal["least_squares", "minimax"]
NORMS: tuple[Norm, ...] = get_args(Norm)

_PAIRS = STEP_MAX - STEP_MIN
_VALUES = VALUE_MAX + 1
_SAME = _PAIRS
"""Marks a state that was entered from its own segment."""
_NOISE = 1e-9
"""Distances that differ by less are equal: what a sum of squares leaves in its last digits."""


@dataclass(frozen=True, slots=True)
class Nearest:
    """An encodable wave and how far it is from the wanted one [counts]: root mean square and largest distance."""

    wave: Wave
    norm: Norm
    distance_rms: float
    distance_max: float


def nearest(wanted: ArrayLike, mirror: int = MIRROR_DEFAULT, norm: Norm = "least_squares") -> Nearest:
    """The encodable wave nearest to `wanted`, 256 finite numbers of any size [counts].

    "least_squares" makes the sum of squared distances smallest. "minimax" makes the largest distance smallest, and
    among the waves with that distance the sum of squares. Equal ones are decided for the lower value.

    Raises ValueError for a wrong shape, numbers that are not finite, an unknown norm, and a mirror for which there is
    no wave: the crossing of zero is a difference of the table too, so 2 * START_SIN - mirror has to be -1..3.
    """
    target = np.asarray(wanted, dtype=np.float64)
    if target.shape != (ENTRIES,) or not np.isfinite(target).all():
        raise ValueError(f"a quarter wave has {ENTRIES} finite values")
    if norm not in NORMS:
        raise ValueError(f"no norm is called {norm!r}; known: {', '.join(NORMS)}")
    mirror = whole_number("mirror", mirror, -STEP_MAX, 2 * VALUE_MAX - STEP_MIN)
    distance = np.abs(np.arange(_VALUES) - target[:, None])
    # beyond these the negative half would leave the current's 9 bits
    allowed = (np.arange(_VALUES) >= mirror - CURRENT_MAX) & (np.arange(_VALUES) <= mirror - CURRENT_MIN)
    distance[:, ~allowed] = np.inf
    if norm == "minimax":
        _, largest = _cheapest(distance, mirror, np.maximum)
        distance[distance > largest + _NOISE] = np.inf
    values, _ = _cheapest(distance**2, mirror, np.add)
    error = np.asarray(values) - target
    return Nearest(Wave(values, mirror), norm, float(np.sqrt(np.mean(error**2))), float(np.abs(error).max(initial=0.0)))


def _cheapest(cost: NDArray[np.float64], mirror: int, join: np.ufunc) -> tuple[tuple[int, ...], float]:
    """The values with the smallest cost, `cost` being (entry, value), and that cost; `join` adds one entry's."""
    best = np.full((SEGMENTS, _PAIRS, _VALUES), np.inf)
    for start in range(_VALUES):
        zero_step = 2 * start - mirror
        for pair in (zero_step - STEP_MIN - 1, zero_step - STEP_MIN):
            if 0 <= pair < _PAIRS:
                best[0, pair, start] = cost[0, start]
    bits = np.zeros((ENTRIES, SEGMENTS, _PAIRS, _VALUES), dtype=np.bool_)
    origins = np.full((ENTRIES, SEGMENTS, _PAIRS, _VALUES), _SAME, dtype=np.uint8)
    for index in range(1, ENTRIES):
        # a new segment may begin here, coming from any pair of the segment before
        earlier = best[:-1].min(axis=1)[:, None, :]
        begins = earlier < best[1:]
        origins[index, 1:] = np.where(begins, best[:-1].argmin(axis=1)[:, None, :], _SAME)
        best[1:] = np.where(begins, earlier, best[1:])
        for pair in range(_PAIRS):
            low, high = (_shifted(best[:, pair], pair + STEP_MIN + bit) for bit in (0, 1))
            bits[index, :, pair] = high <= low  # of equal ones the way that was lower before
            best[:, pair] = join(np.minimum(low, high), cost[index])
    return _traced(best, bits, origins)


def _traced(
    best: NDArray[np.float64], bits: NDArray[np.bool_], origins: NDArray[np.uint8]
) -> tuple[tuple[int, ...], float]:
    segment, pair, value = (int(place) for place in np.unravel_index(int(best.argmin()), best.shape))
    least = float(best[segment, pair, value])
    if not np.isfinite(least):
        raise ValueError("there is no encodable wave with that mirror")
    values = [value]
    for index in range(ENTRIES - 1, 0, -1):
        value -= pair + STEP_MIN + int(bits[index, segment, pair, value])
        values.append(value)
        origin = int(origins[index, segment, pair, value])
        if origin != _SAME:
            segment, pair = segment - 1, origin
    return tuple(reversed(values)), least


def _shifted(cost: NDArray[np.float64], by: int) -> NDArray[np.float64]:
    """Cost by the value before a step of `by`, as cost by the value after it."""
    shifted = np.full_like(cost, np.inf)
    if by > 0:
        shifted[:, by:] = cost[:, :-by]
    elif by < 0:
        shifted[:, :by] = cost[:, -by:]
    else:
        shifted[:] = cost
    return shifted
