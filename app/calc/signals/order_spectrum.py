"""Ripple by order: how much of a deviation comes once, twice, ... in an electrical period, from samples at any times.

Least squares at the known angle of each sample, so times need not be even, and gaps are nothing; orders beyond half the
rate of samples can be told as long as no other looks the same at these samples. What is left is looked at by frequency
(Lomb and Scargle): a rotor that swings by itself does so beside all orders.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

LEAST_PERIODS, LEAST_SAMPLES, SAMPLES_A_FIGURE = 4.0, 40, 3
ALIKE_MAX = 50.0
"""Condition of the fit from which on two orders look the same at these samples."""
SHAFT = 0.9
"""Of a turn: from so much on, what comes once and twice a turn can be told from a drift."""
DRIFT = 5
"""Power up to which a part of a turn drifts."""
LINES = 400
"""Frequencies at which what is left is looked at."""


@dataclass(frozen=True, slots=True)
class OrderSpectrum:
    """Of one run at one speed, in the unit of the deviation.

    amplitudes : complex, real part that of the cosine, less imaginary part that of the sine; by order, those that can
        be told alone
    ripple : root mean square of the deviation, without its mean, drift, and what comes once and twice a turn
    rest : root mean square of what no order explains
    rest_hz, rest_amplitude : its strongest frequency [Hz]; 0 where there is no time to tell any
    """

    amplitudes: dict[int, complex]
    ripple: float
    rest: float
    rest_hz: float
    rest_amplitude: float


def order_spectrum(
    time_s: FloatArray, angle: FloatArray, shaft: FloatArray, deviation: FloatArray, orders: Sequence[int]
) -> OrderSpectrum:
    """The spectrum of one run. angle, shaft : electrical one and that of the shaft [rad] at each sample; orders : what
    matters most first: where some look the same at these samples, the last are left out.

    Raises ValueError where there are too few samples.
    """
    width = float(np.ptp(angle)) if len(angle) else 0.0
    if width < LEAST_PERIODS * 2 * math.pi or len(time_s) < LEAST_SAMPLES:
        raise ValueError(f"{len(time_s)} samples of {width / (2 * math.pi):.2g} electrical periods are too few")
    drift = _drift(shaft)
    told = list(orders)
    while told:
        design = np.hstack([drift, _waves(angle, told)])
        if len(time_s) >= SAMPLES_A_FIGURE * design.shape[1] and np.linalg.cond(design) < ALIKE_MAX:
            break
        told.pop()
    else:
        design = drift
    found, *_ = np.linalg.lstsq(design, deviation, rcond=None)
    left = deviation - design @ found
    slow = drift.shape[1]
    cosines, sines = found[slow::2], found[slow + 1 :: 2]
    hz, amplitude = _strongest(time_s, left)
    return OrderSpectrum(
        amplitudes={order: complex(c, -s) for order, c, s in zip(told, cosines, sines, strict=True)},
        ripple=float(np.sqrt(np.mean((deviation - drift @ found[:slow]) ** 2))),
        rest=float(np.sqrt(np.mean(left**2))),
        rest_hz=hz,
        rest_amplitude=amplitude,
    )


def _drift(shaft: FloatArray) -> FloatArray:
    """Mean and drift, and what comes once and twice a turn: as such where there is a turn of it."""
    width = float(np.ptp(shaft))
    x = (2 * shaft - shaft.max() - shaft.min()) / (width or 1.0)
    if width < SHAFT * 2 * math.pi:
        return np.polynomial.legendre.legvander(x, DRIFT)
    columns = [np.ones_like(x), x, *(of(times * shaft) for times in (1, 2) for of in (np.cos, np.sin))]
    return np.stack(columns, axis=1)


def _waves(angle: FloatArray, orders: Sequence[int]) -> FloatArray:
    return np.stack([of(order * angle) for order in orders for of in (np.cos, np.sin)], axis=1)


def _strongest(time_s: FloatArray, left: FloatArray) -> tuple[float, float]:
    """Frequency [Hz] and amplitude of the strongest line of what is left, up to half the mean rate of samples.

    SciPy has it too, but in a part that the image leaves out.
    """
    span = float(np.ptp(time_s))
    if span <= 0 or not left.any():
        return 0.0, 0.0
    lines = np.linspace(2 / span, max(2.5 / span, 0.5 * len(time_s) / span), LINES)
    angle = 2 * math.pi * np.outer(lines, time_s - time_s[0])
    # turned so that cosine and sine at these samples are nothing to each other: each is fitted alone
    angle -= 0.5 * np.arctan2(np.sin(2 * angle).sum(axis=1), np.cos(2 * angle).sum(axis=1))[:, None]
    least = len(time_s) * np.finfo(np.float64).epsneg
    power = sum(
        (wave @ left) ** 2 / np.maximum((wave**2).sum(axis=1), least) for wave in (np.cos(angle), np.sin(angle))
    )
    at = int(np.argmax(power))
    return float(lines[at]), math.sqrt(2 * float(power[at]) / len(left))
