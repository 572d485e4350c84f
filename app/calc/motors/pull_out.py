"""The most that a stepper motor accelerates its load with, from the way of a rotor that just falls out of step.

While it slips its torque goes through its greatest. Over the load angle it is a sine, less what friction and back-EMF
take, which grows as the speed does: with time. So the rotor's way is a start, a speed, and twice the integral of that: a
linear least squares fit. Nothing is derived twice from an encoder's counts.
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
WORST_SHARE = 0.15
"""A fit whose 95 % interval is wider than this is none."""


@dataclass(frozen=True, slots=True)
class PullOut:
    """acceleration : the most that the motor gave the rotor beyond its friction, half : of its 95 % interval [rad/s^2];
    speed : at which that was [rad/s]"""

    acceleration: float
    half: float
    speed: float


def pull_out(time_s: FloatArray, field_rad: FloatArray, rotor_rad: FloatArray, periods: float) -> PullOut | None:
    """What a slip tells; None where none can be seen, or not clearly.

    field_rad, rotor_rad : angles of the shaft, rising, the same when no torque acts [rad]
    periods : electrical ones of a turn, 50 of a motor of 200 full steps
    """
    from scipy import stats

    angle = (field_rad - rotor_rad) * periods
    slipped = np.flatnonzero(angle > SLIPPED_RAD)
    if not len(slipped):
        return None
    end, swing_s = int(slipped[0]), 0.0
    found: PullOut | None = None
    begin = max(0, end - SAMPLES_LEAST)
    for _ in range(ROUNDS):
        if swing_s:
            begin = min(int(np.searchsorted(time_s, time_s[end] - SPAN * swing_s)), max(0, end - SAMPLES_LEAST))
        time, e, way = (each[begin : end + 1] for each in (time_s, angle, rotor_rad))
        if len(time) < SAMPLES_LEAST:
            return None
        time = time - time[0]
        waves = [np.ones_like(e), np.sin(e), np.cos(e), time - float(time.mean())]
        matrix = np.stack([np.ones_like(time), time, *(_twice(wave, time) for wave in waves)], axis=1)
        fitted, _, rank, _ = np.linalg.lstsq(matrix, way, rcond=None)
        if rank < matrix.shape[1]:
            return None
        free = len(time) - matrix.shape[1]
        variance = float(np.sum((way - matrix @ fitted) ** 2)) / free
        shown = np.stack(waves, axis=1)
        acceleration = shown @ fitted[2:]
        at = int(np.argmax(acceleration))
        slope = np.concatenate(([0.0, 0.0], shown[at]))
        spread = math.sqrt(float(slope @ np.linalg.inv(matrix.T @ matrix) @ slope) * variance)
        speed = fitted[1] + _once(acceleration, time)[at]
        half = float(stats.t.ppf(0.975, free)) * spread
        inside = 0 < at < len(time) - 1
        found = PullOut(float(acceleration[at]), half, float(speed)) if inside else None
        swing_s = 2 * math.pi / math.sqrt(periods * max(float(np.ptp(acceleration)) / 2, float(acceleration[at])))
    if found is None or found.acceleration <= 0 or found.half > WORST_SHARE * found.acceleration:
        return None
    return found


def _once(values: FloatArray, time_s: FloatArray) -> FloatArray:
    """Their integral from the first on, by trapezoids."""
    steps = (values[1:] + values[:-1]) / 2 * np.diff(time_s)
    return np.concatenate(([0.0], np.cumsum(steps)))


def _twice(values: FloatArray, time_s: FloatArray) -> FloatArray:
    return _once(_once(values, time_s), time_s)
