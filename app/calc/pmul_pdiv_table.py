"""From p to the pair pmul/pdiv, for one or for many inputs at once, and the limits of a_max.

`pmul_pdiv` designs one pair with its neighbours on top of this. Source: TMC428 data sheet (001), 8.7.1,
8.11.1 and the program of chapter 19; TMC4210 (000), 6.1.7.1.1 and 6.1.9.2.2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

MAX_DIVIDER = 13
MAX_A = 2047
MAX_PDIV = 13

# What each data sheet takes off p (001 8.11.1: about 5 %; 000 6.1.9.2.2: about 1 %).
REDUCTIONS = {"tmc428": 0.05, "tmc4210": 0.01}

# The braking distance is counted in 19 bits. At v_max up to 2048/sqrt(2) half the distance is enough (001 8.7.1).
V_MAX_OF_HALF_LIMIT = 1448


@dataclass(frozen=True)
class PmulPdivTable:
    """Many designs at once, every array in the broadcast shape. -1 and NaN stand where no pair represents p."""

    p_ideal: NDArray[np.float64]
    p_reduced: NDArray[np.float64]
    pmul: NDArray[np.int64]
    p_mul: NDArray[np.int64]
    pdiv: NDArray[np.int64]
    p: NDArray[np.float64]
    quality: NDArray[np.float64]


def default_reduction(chip: str) -> float:
    """The part of p that the chip's data sheet takes off [-]. Raises ValueError for another chip."""
    if chip not in REDUCTIONS:
        raise ValueError(f"chip is one of {', '.join(REDUCTIONS)}, got {chip!r}")
    return REDUCTIONS[chip]


def a_max_lower_limit(ramp_div: int, pulse_div: int, v_max: int = 2047) -> int:
    """Smallest a_max above 0 that brakes within 2^19 steps: 2^(ramp_div-pulse_div-1), at least 1.

    Half of it where `v_max` is at most 1448. More than 2047 means that only a_max = 0 is left.

    Raises ValueError unless the dividers are 0..13 and `v_max` 0..2047. Source: 001, 8.7.1; 000, 6.1.7.1.1.
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

    Raises ValueError unless the dividers are 0..13. Source: 001, 8.7.1; 000, 6.1.7.1.1.
    """
    _check_dividers(ramp_div, pulse_div)
    exponent = ramp_div - pulse_div + 12
    return (1 << exponent) - 1 if exponent >= 0 else 0


def design_many(a_max: ArrayLike, ramp_div: ArrayLike, pulse_div: ArrayLike, reduction: ArrayLike) -> PmulPdivTable:
    """The pairs of many inputs at once: arrays that broadcast, each within the ranges of `design`.

    Raises ValueError outside the ranges. Equal to `design` (and to the loop over pdiv of 001, chapter 19) for
    every element: scaling by powers of two is exact, so the exponent of p alone decides about pdiv.
    """
    a = _whole_array("a_max", a_max, MAX_A)
    ratio = _whole_array("ramp_div", ramp_div, MAX_DIVIDER) - _whole_array("pulse_div", pulse_div, MAX_DIVIDER)
    part = np.asarray(reduction, dtype=np.float64)
    if not np.all((part >= 0) & (part < 1)):
        raise ValueError("reduction is 0 to less than 1")
    p_ideal = np.ldexp(a.astype(np.float64), -7 - ratio)
    p_reduced = np.asarray(p_ideal * (1.0 - part))
    mantissa, exponent = np.frexp(p_reduced)  # p_reduced = mantissa * 2^exponent, mantissa in [0.5, 1)
    pdiv = np.asarray(5 - exponent.astype(np.int64))
    fits = (pdiv >= 0) & (pdiv <= MAX_PDIV) & (p_reduced > 0)
    p_mul = np.where(fits, (mantissa * 256.0).astype(np.int64), -1)
    p = np.where(fits, np.ldexp(p_mul.astype(np.float64), np.where(fits, exponent - 8, 0)), np.nan)
    quality = np.divide(p, p_ideal, out=np.full(p.shape, np.nan), where=fits)
    return PmulPdivTable(
        p_ideal=np.broadcast_to(p_ideal, p.shape),
        p_reduced=p_reduced,
        pmul=np.where(fits, p_mul - 128, -1),
        p_mul=p_mul,
        pdiv=np.where(fits, pdiv, -1),
        p=p,
        quality=quality,
    )


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
