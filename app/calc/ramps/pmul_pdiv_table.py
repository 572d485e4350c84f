"""From p to the pair pmul/pdiv, for one or for many inputs at once, and the limits of a_max.

`pmul_pdiv` designs one pair with its neighbours on top of this. Source: DS-TMC428 8.7.1,
8.11.1 and the program of chapter 19; TMC4210 (DS-TMC4210), 6.1.7.1.1 and 6.1.9.2.2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..tmc428.chips import CHIPS

FloatArray = NDArray[np.float64]

MAX_DIVIDER = 13
MAX_A = 2047
MAX_PDIV = 13

REDUCTIONS = {name: chip.reduction for name, chip in CHIPS.items()}
"""What each data sheet takes off p."""

# The braking distance is counted in 19 bits. At v_max up to 2048/sqrt(2) half the distance is enough (DS-TMC428 8.7.1).
V_MAX_OF_HALF_LIMIT = 1448

# a_max and ramp_div - pulse_div have 2048 * 27 different values together.
_DIFFERENT_INPUTS = (MAX_A + 1) * (2 * MAX_DIVIDER + 1)


@dataclass(frozen=True)
class PmulPdivTable:
    """Many designs at once, every array in the broadcast shape. -1 and NaN stand where no pair represents p.

    The pairs are there; the factors are worked out, when asked for, from them and from the inputs, which are not
    copied.
    """

    pmul: NDArray[np.int32]
    p_mul: NDArray[np.int32]
    pdiv: NDArray[np.int32]
    a_max: NDArray[np.int64]
    divider_ratio: NDArray[np.int64]
    """ramp_div - pulse_div"""
    reduction: FloatArray

    @property
    def p_ideal(self) -> FloatArray:
        return np.asarray(np.broadcast_to(_p_ideal(self.a_max, self.divider_ratio), self.pdiv.shape))

    @property
    def p_reduced(self) -> FloatArray:
        return np.asarray(self.p_ideal * (1.0 - self.reduction))

    @property
    def p(self) -> FloatArray:
        return np.where(self.pdiv >= 0, np.ldexp(self.p_mul.astype(np.float64), -3 - self.pdiv), np.nan)

    @property
    def quality(self) -> FloatArray:
        """Q = p / p_ideal."""
        found = self.pdiv >= 0
        return np.asarray(np.divide(self.p, self.p_ideal, out=np.full(found.shape, np.nan), where=found))


def default_reduction(chip: str) -> float:
    """The part of p that the chip's data sheet takes off [-]. Raises ValueError for another chip."""
    if chip not in REDUCTIONS:
        raise ValueError(f"chip is one of {', '.join(REDUCTIONS)}, got {chip!r}")
    return REDUCTIONS[chip]


def a_max_lower_limit(ramp_div: int, pulse_div: int, v_max: int = 2047) -> int:
    """Smallest a_max above 0 that brakes within 2^19 steps: 2^(ramp_div-pulse_div-1), at least 1.

    Half of it where `v_max` is at most 1448. More than 2047 means that only a_max = 0 is left.

    Raises ValueError unless the dividers are 0..13 and `v_max` 0..2047. Source: DS-TMC428 8.7.1; DS-TMC4210 6.1.7.1.1.
    """
    _check_dividers(ramp_div, pulse_div)
    _check_whole("v_max", v_max, 0, 2047)
    exponent = ramp_div - pulse_div - 1
    if exponent <= 0:
        return 1
    return 1 << (exponent - 1 if v_max <= V_MAX_OF_HALF_LIMIT else exponent)


def a_max_upper_limit(ramp_div: int, pulse_div: int) -> int:
    """Largest a_max whose p fits: 2^(ramp_div-pulse_div+12) - 1, at least 0.

    2047 and more mean no limit beyond the register's own range.

    Raises ValueError unless the dividers are 0..13. Source: DS-TMC428 8.7.1; DS-TMC4210 6.1.7.1.1.
    """
    _check_dividers(ramp_div, pulse_div)
    exponent = ramp_div - pulse_div + 12
    return (1 << exponent) - 1 if exponent >= 0 else 0


def design_many(a_max: ArrayLike, ramp_div: ArrayLike, pulse_div: ArrayLike, reduction: ArrayLike) -> PmulPdivTable:
    """The pairs of many inputs at once: arrays that broadcast, each within the ranges of `design`.

    Raises ValueError outside the ranges. Equal to `design` (and to the loop over pdiv of DS-TMC428 chapter 19) for
    every element: scaling by powers of two is exact, so the exponent of p alone decides about pdiv.
    """
    a = _whole_array("a_max", a_max, MAX_A)
    ratio = _whole_array("ramp_div", ramp_div, MAX_DIVIDER) - _whole_array("pulse_div", pulse_div, MAX_DIVIDER)
    part = np.asarray(reduction, dtype=np.float64)
    if not np.all((part >= 0) & (part < 1)):
        raise ValueError("reduction is 0 to less than 1")
    if part.ndim or max(a.size, ratio.size) <= _DIFFERENT_INPUTS:
        p_mul, pdiv = _pairs(a, ratio, part)
    else:
        # More inputs than there are different ones: work those out, then look each input up. (32 bits and few
        # passes, because fresh memory for large arrays is what takes the time here.)
        p_muls, pdivs = _pairs(np.arange(MAX_A + 1)[:, None], np.arange(-MAX_DIVIDER, MAX_DIVIDER + 1), part)
        row = np.add(np.multiply(a, pdivs.shape[1], dtype=np.int32), ratio, dtype=np.int32)
        row += MAX_DIVIDER
        p_mul, pdiv = np.take(p_muls, row), np.take(pdivs, row)
    pmul = np.maximum(p_mul - np.int32(128), np.int32(-1))
    return PmulPdivTable(pmul, p_mul, pdiv, a, ratio, part)


def _p_ideal(a: NDArray[np.int64], ratio: NDArray[np.int64]) -> FloatArray:
    return np.asarray(np.ldexp(a.astype(np.float64), -7 - ratio))


def _pairs(
    a: NDArray[np.int64], ratio: NDArray[np.int64], part: FloatArray
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """(p_mul, pdiv), -1 for none."""
    mantissa, exponent = np.frexp(_p_ideal(a, ratio) * (1.0 - part))  # p = mantissa * 2^exponent, mantissa 0.5 to 1
    pdiv = 5 - exponent.astype(np.int32)
    fits = (pdiv >= 0) & (pdiv <= MAX_PDIV) & (mantissa > 0)
    p_mul = (mantissa * 256.0).astype(np.int32)
    none = np.int32(-1)
    return np.where(fits, p_mul, none), np.where(fits, pdiv, none)


def _check_whole(name: str, value: int, low: int, high: int) -> None:
    if not low <= value <= high or value != int(value):
        raise ValueError(f"{name} is a whole number of {low} to {high}, got {value}")


def _check_dividers(ramp_div: int, pulse_div: int) -> None:
    _check_whole("ramp_div", ramp_div, 0, MAX_DIVIDER)
    _check_whole("pulse_div", pulse_div, 0, MAX_DIVIDER)


def _whole_array(name: str, values: ArrayLike, high: int) -> NDArray[np.int64]:
    array = np.asarray(values)
    whole = array.dtype.kind in "iu" or bool(np.all(array == np.floor(array)))
    if not whole or (array.size and not (array.min() >= 0 and array.max() <= high)):
        raise ValueError(f"{name} is a whole number of 0 to {high}")
    return array.astype(np.int64, copy=False)
