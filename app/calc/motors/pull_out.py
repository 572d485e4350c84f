"""The most that a stepper motor accelerates its load with, from the way of a rotor that just falls out of step.

While it slips its torque goes through its greatest. Over the load angle it is a sine, less what friction and back-EMF
take, which grows as the speed does: with time. So the rotor's way is a start, a speed, and twice the integral of that,
which a linear least squares fit finds. Nothing is derived twice from an encoder's counts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

SLIPPED_RAD = math.radians(190.0)
"""Electrical load angle up to which a slip is looked at: beyond, the speeds of field and rotor part."""
SPAN = 0.8
"""So many periods of the rotor's swing before that belong to it."""
ROUNDS = 4
SAMPLES_LEAST = 14
DOUBT_SHARE = 0.1
"""A second harmonic is taken no further than this share: behind it the samples are too few for it."""
FIELD_SAMPLES = 3
"""So many before and after the most tell the speed of the field there."""
WORST_SHARE = 0.15
"""A fit whose 95 % interval is wider than this is none."""


@dataclass(frozen=True, slots=True)
class PullOut:
    """acceleration : the most that the motor gave the rotor beyond its friction; half : of its 95 % interval by noise;
    doubt : what the same fit with a second harmonic tells otherwise [rad/s^2]; speed : at which that was, midway from
    rotor to field: back-EMF and friction grow with the one, what the inductance takes with the other [rad/s]"""

    acceleration: float
    half: float
    doubt: float
    speed: float


@dataclass(frozen=True, slots=True)
class _Fit:
    top: float
    half: float
    speed: float
    swing: float
    at: int
    inside: bool


def pull_out(time_s: FloatArray, field_rad: FloatArray, rotor_rad: FloatArray, periods: float) -> PullOut | None:
    """What a slip tells; None where none can be seen, or not clearly.

    field_rad, rotor_rad : angles of the shaft, rising, the same when no torque acts [rad]
    periods : electrical ones of a turn, 50 of a motor of 200 full steps
    """
    angle = (field_rad - rotor_rad) * periods
    slipped = np.flatnonzero(angle > SLIPPED_RAD)
    if not len(slipped):
        return None
    end = int(slipped[0])
    begin = least = max(0, end - SAMPLES_LEAST)
    if end + 1 - begin < SAMPLES_LEAST:
        return None
    for _ in range(ROUNDS):
        fit = _fitted(time_s[begin : end + 1], angle[begin : end + 1], rotor_rad[begin : end + 1], (1,))
        if fit is None:
            return None
        swing_s = 2 * math.pi / math.sqrt(periods * max(fit.swing, fit.top))
        begin = min(int(np.searchsorted(time_s, time_s[end] - SPAN * swing_s)), least)
    whole = slice(begin, end + 1)
    fit, other = (_fitted(time_s[whole], angle[whole], rotor_rad[whole], orders) for orders in ((1,), (1, 2)))
    if fit is None or fit.top <= 0 or not fit.inside or fit.half > WORST_SHARE * fit.top:
        return None
    doubt = DOUBT_SHARE * fit.top if other is None else min(abs(other.top - fit.top), DOUBT_SHARE * fit.top)
    around = slice(max(begin, begin + fit.at - FIELD_SAMPLES), begin + fit.at + FIELD_SAMPLES + 1)
    field = float(np.ptp(field_rad[around]) / np.ptp(time_s[around]))
    return PullOut(fit.top, fit.half, doubt, (fit.speed + field) / 2)


def _fitted(time_s: FloatArray, angle: FloatArray, rotor_rad: FloatArray, orders: tuple[int, ...]) -> _Fit | None:
    """Torque over the load angle by so many harmonics; None where these samples cannot tell them apart."""
    from scipy import stats

    time = time_s - time_s[0]
    waves = [np.ones_like(angle), time - float(time.mean())]
    waves += [wave(order * angle) for order in orders for wave in (np.sin, np.cos)]
    matrix = np.stack([np.ones_like(time), time, *(_twice(wave, time) for wave in waves)], axis=1)
    free = len(time) - matrix.shape[1]
    fitted, _, rank, _ = np.linalg.lstsq(matrix, rotor_rad, rcond=None)
    if rank < matrix.shape[1] or free < 1:
        return None
    variance = float(np.sum((rotor_rad - matrix @ fitted) ** 2)) / free
    shown = np.stack(waves, axis=1)
    acceleration = shown @ fitted[2:]
    at = int(np.argmax(acceleration))
    slope = np.concatenate(([0.0, 0.0], shown[at]))
    spread = math.sqrt(max(0.0, float(slope @ np.linalg.pinv(matrix.T @ matrix) @ slope) * variance))
    return _Fit(
        top=float(acceleration[at]),
        half=float(stats.t.ppf(0.975, free)) * spread,
        speed=float(fitted[1] + _once(acceleration, time)[at]),
        swing=float(np.ptp(acceleration)) / 2,
        at=at,
        inside=0 < at < len(time) - 1,
    )


def _once(values: FloatArray, time_s: FloatArray) -> FloatArray:
    """Their integral from the first on, by trapezoids."""
    steps = (values[1:] + values[:-1]) / 2 * np.diff(time_s)
    return np.concatenate(([0.0], np.cumsum(steps)))


def _twice(values: FloatArray, time_s: FloatArray) -> FloatArray:
    return _once(_once(values, time_s), time_s)
