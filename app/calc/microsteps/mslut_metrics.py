"""What an MSLUT wave does to the motor, before it is sent: angle, torque ripple, amplitude, harmonics, rounding.

The coil current of a table value is value - mirror / 2: the complement's half count is in both halves, so the power-on
wave is an unbiased sine. That is a reading, as is the angle of position p, (p + 1/2) * 360/1024 degrees; both follow
from the table's mirror axes, which lie between the entries.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .mslut import ENTRIES, POSITIONS, Wave

MICROSTEP_DEG = 360.0 / POSITIONS
ANGLE_ORDERS = (4, 8, 12, 16)
HARMONICS = 15
AMPLITUDE_HEADROOM = 248


@dataclass(frozen=True, slots=True)
class AngleOrder:
    """The angle error's part amplitude_deg * sin(order * theta), electrical; the table's symmetry leaves no cosine."""

    order: int
    amplitude_deg: float
    amplitude_microsteps: float


@dataclass(frozen=True, slots=True)
class MslutMetrics:
    """Figures over an electrical period; angles are electrical degrees, or microsteps of 1/1024 period.

    `angle_error_deg` has 256 entries, position 0..255: the other quarters repeat it. `vector_length` likewise.
    `torque_ripple` is (max - min) / mean of the vector length, which is that of a motor whose flux is a pure sine.
    `quantisation_*` compare the table's values with those before rounding [counts], None where there are none; the
    half count by which the power-on wave stays below its formula is in neither. `harmonics` are those of the current,
    1..15, relative to the first; `largest_step_ratio` and `smallest_step_ratio` are the turns from one microstep to the
    next over the ideal one. Where a vector has no length, there are no angles (None).
    """

    amplitude_min: float
    amplitude_mean: float
    amplitude_max: float
    torque_ripple: float | None
    torque_ripple_rms: float | None
    angle_error_deg: tuple[float, ...] | None
    vector_length: tuple[float, ...]
    angle_error_max_deg: float | None
    angle_error_rms_deg: float | None
    angle_error_max_microsteps: float | None
    angle_error_rms_microsteps: float | None
    worst_position: int | None
    angle_orders: tuple[AngleOrder, ...] | None
    largest_step_ratio: float | None
    smallest_step_ratio: float | None
    quantisation_max: float | None
    quantisation_rms: float | None
    harmonics: tuple[float, ...] | None
    thd: float | None
    warnings: tuple[str, ...]


def mslut_metrics(wave: Wave, ideal: ArrayLike | None = None) -> MslutMetrics:
    """The figures of a wave, encodable or not. `ideal` are its 256 values before rounding [counts].

    Raises ValueError for an `ideal` of another shape.
    """
    sine: NDArray[np.float64] = wave.period().astype(np.float64) - wave.mirror / 2
    cosine = np.roll(sine, -ENTRIES)
    length = np.hypot(sine, cosine)
    mean = float(length.mean())
    harmonics, thd = _harmonics(sine)
    rounding = None if ideal is None else _rounding(wave, np.asarray(ideal, dtype=np.float64))
    error = _angle_error(sine, cosine) if length.min() > 0 else None
    sizes = None if error is None else 1.0 + _wrapped(np.roll(error, -1) - error) / MICROSTEP_DEG
    worst_deg = None if error is None else float(np.abs(error).max())
    rms_deg = None if error is None else float(np.sqrt(np.mean(error**2)))
    return MslutMetrics(
        amplitude_min=float(length.min()),
        amplitude_mean=mean,
        amplitude_max=float(length.max()),
        torque_ripple=float(np.ptp(length)) / mean if mean > 0 else None,
        torque_ripple_rms=float(length.std()) / mean if mean > 0 else None,
        angle_error_deg=None if error is None else tuple(error[:ENTRIES].tolist()),
        vector_length=tuple(length[:ENTRIES].tolist()),
        angle_error_max_deg=worst_deg,
        angle_error_rms_deg=rms_deg,
        angle_error_max_microsteps=None if worst_deg is None else worst_deg / MICROSTEP_DEG,
        angle_error_rms_microsteps=None if rms_deg is None else rms_deg / MICROSTEP_DEG,
        # the last digits of atan2 must not choose among equals
        worst_position=None if error is None else int(np.round(np.abs(error), 9)[:ENTRIES].argmax()),
        angle_orders=None if error is None else _orders(error),
        largest_step_ratio=None if sizes is None else float(sizes.max()),
        smallest_step_ratio=None if sizes is None else float(sizes.min()),
        quantisation_max=None if rounding is None else float(np.abs(rounding).max()),
        quantisation_rms=None if rounding is None else float(np.sqrt(np.mean(rounding**2))),
        harmonics=harmonics,
        thd=thd,
        warnings=tuple(_warnings(wave, sizes)),
    )


def _angle_error(sine: NDArray[np.float64], cosine: NDArray[np.float64]) -> NDArray[np.float64]:
    return _wrapped(np.degrees(np.arctan2(sine, cosine)) - (np.arange(POSITIONS) + 0.5) * MICROSTEP_DEG)


def _wrapped(angle_deg: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray((angle_deg + 180.0) % 360.0 - 180.0)


def _orders(error_deg: NDArray[np.float64]) -> tuple[AngleOrder, ...]:
    theta = 2 * math.pi * (np.arange(POSITIONS) + 0.5) / POSITIONS
    parts = ((order, 2 * float(np.mean(error_deg * np.sin(order * theta)))) for order in ANGLE_ORDERS)
    return tuple(AngleOrder(order, part, part / MICROSTEP_DEG) for order, part in parts)


def _rounding(wave: Wave, ideal: NDArray[np.float64]) -> NDArray[np.float64]:
    if ideal.shape != (ENTRIES,):
        raise ValueError(f"a quarter wave has {ENTRIES} values before rounding too, not {ideal.shape}")
    return np.asarray(wave.values) - ideal


def _harmonics(current: NDArray[np.float64]) -> tuple[tuple[float, ...] | None, float | None]:
    amplitude = np.abs(np.fft.rfft(current))
    amplitude[-1] /= math.sqrt(2)  # the Nyquist line has no mirror image, so half the power of the others
    if not amplitude[1] > 1e-9 * max(1.0, float(np.abs(current).max())) * current.size:
        return None, None
    relative = amplitude / amplitude[1]
    return tuple(relative[1 : HARMONICS + 1].tolist()), float(np.sqrt(np.sum(relative[2:] ** 2)))


def _warnings(wave: Wave, sizes: NDArray[np.float64] | None) -> list[str]:
    found: list[str] = []
    if max(wave.values) > AMPLITUDE_HEADROOM:
        found.append(f"the peak of {max(wave.values)} is above {AMPLITUDE_HEADROOM}: less headroom for the regulator")
    if sizes is None:
        found.append("at one position neither phase has a current, so the motor has no angle there")
    elif sizes.min() < 0:
        found.append(f"{int(np.sum(sizes < 0))} of {POSITIONS} microsteps turn the field backwards")
    return found
