"""Gains of a position loop whose output is a velocity, around a motor that hangs on its field as a pendulum.

Open loop L(s) = (P + I / s) / s * w^2 / (s^2 + 2 d w s + w^2) * exp(-T s): the steps are the integral of the velocity
that is asked for, the rotor follows its field, and the encoder tells where it is. The rotor's resonance bounds P by the
gain margin, the phase margin bounds I. Both are kept by the worst of a set of plants, not by their mean.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

LOW, HIGH, POINTS = 1e-3, 10.0, 4000
"""Frequencies as shares of the resonance."""
HALVINGS = 40
STEPS_A_RADIAN = 20
"""Of the resonance, where friction is in a step: so often it is looked whether the rotor stands."""


@dataclass(frozen=True, slots=True)
class Plant:
    """w [rad/s], damping, delay [s]."""

    w: float
    damping: float
    delay_s: float

    def response(self, omega: FloatArray) -> ComplexArray:
        """Encoder over field."""
        s = 1j * omega
        return np.asarray(self.w**2 / (s * s + 2 * self.damping * self.w * s + self.w**2) * np.exp(-s * self.delay_s))


@dataclass(frozen=True, slots=True)
class Gains:
    """P [1/s], I [1/s^2]."""

    proportional: float
    integral: float

    def open_loop(self, plant: Plant, omega: FloatArray) -> ComplexArray:
        """L(j omega)."""
        s = 1j * omega
        return np.asarray((self.proportional + self.integral / s) / s * plant.response(omega))


@dataclass(frozen=True, slots=True)
class Margins:
    """gain : how many times more gain it takes to oscillate; phase_deg; bandwidth_hz : where the open loop is 1."""

    gain: float
    phase_deg: float
    bandwidth_hz: float


def margins(gains: Gains, plant: Plant) -> Margins:
    """Of one loop: the least of all crossings."""
    omega = np.geomspace(LOW * plant.w, HIGH * plant.w, POINTS)
    loop = gains.open_loop(plant, omega)
    size, phase = np.abs(loop), np.unwrap(np.angle(loop))
    phase += 2 * math.pi * round((-math.pi - phase[0]) / (2 * math.pi) + 0.25)
    crossing = np.flatnonzero((size[:-1] >= 1) & (size[1:] < 1))
    turning = np.flatnonzero((phase[:-1] >= -math.pi) & (phase[1:] < -math.pi))
    over = float(np.max(size[turning])) if len(turning) else 0.0
    if not len(crossing):
        return Margins(1 / over if over else math.inf, 180.0, 0.0)
    least = float(np.min(phase[crossing + 1]))
    first = int(crossing[0])
    return Margins(1 / over if over else math.inf, math.degrees(least + math.pi), float(omega[first]) / (2 * math.pi))


def worst(gains: Gains, plants: Sequence[Plant]) -> Margins:
    """The least margins of all of them, and the least bandwidth."""
    found = [margins(gains, plant) for plant in plants]
    return Margins(
        min(one.gain for one in found), min(one.phase_deg for one in found), min(one.bandwidth_hz for one in found)
    )


def gains_for(plants: Sequence[Plant], gain_margin: float, phase_margin_deg: float) -> Gains:
    """The greatest gains with which the worst of the plants keeps both margins."""

    def with_integral(proportional: float) -> Gains:
        low, high = 0.0, proportional**2
        for _ in range(HALVINGS // 2):
            middle = (low + high) / 2
            kept = worst(Gains(proportional, middle), plants).phase_deg >= phase_margin_deg
            low, high = (middle, high) if kept else (low, middle)
        return Gains(proportional, low)

    least, most = 0.0, min(2 * plant.w for plant in plants)
    for _ in range(HALVINGS // 2):
        middle = (least + most) / 2
        gains = with_integral(middle)
        kept = gains.integral > 0 and worst(gains, plants).gain >= gain_margin
        least, most = (middle, most) if kept else (least, middle)
    return with_integral(least)


def open_loop_curves(gains: Gains, plant: Plant, points: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Frequency [Hz], gain [dB] and phase [deg] of the open loop, from 1/100 of the resonance to 3 times it."""
    omega = np.geomspace(plant.w / 100, 3 * plant.w, points)
    loop = gains.open_loop(plant, omega)
    phase = np.unwrap(np.angle(loop))
    phase -= 2 * math.pi * math.ceil(phase[0] / (2 * math.pi))
    return omega / (2 * math.pi), 20 * np.log10(np.abs(loop)), np.degrees(phase)


def step_answer(gains: Gains, plant: Plant, time_s: FloatArray, friction: float = 0.0) -> FloatArray:
    """Answer of the closed loop to a step of 1, at times that are evenly apart.

    friction : by how much the field has to lead the rotor before it turns, as a share of the step
    """
    from scipy import linalg  # not its `signal`, which the image leaves out

    # the delay as a lag of the first order: it is far shorter than anything that shows in a step
    w, d, lag = plant.w, plant.damping, max(plant.delay_s, 1e-6)
    between_s = float(time_s[1] - time_s[0])
    pieces = max(1, math.ceil(between_s * w * STEPS_A_RADIAN)) if friction > 0 else 1

    def advance(way: int) -> FloatArray:
        """To the next moment: while it turns up (1), down (-1) or stands (0)."""
        motion = np.zeros((6, 6))  # place, speed, field as it acts, field, integral of the error, and what stays 1
        if way:
            motion[0, 1] = 1.0
            motion[1] = [-w * w, -2 * d * w, w * w, 0.0, 0.0, -way * friction * w * w]
        motion[2, 2:4] = [-1 / lag, 1 / lag]
        motion[3, [0, 4, 5]] = [-gains.proportional, gains.integral, gains.proportional]
        motion[4, [0, 5]] = [-1.0, 1.0]
        return np.asarray(linalg.expm(motion * (between_s / pieces)))

    by_way = {way: advance(way) for way in (-1, 0, 1)}
    way, state = 1 if friction <= 0 else 0, np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    answer = np.empty(len(time_s))
    for at in range(len(time_s)):
        answer[at] = state[0]
        for _ in range(pieces):
            lead = state[2] - state[0]
            if way == 0 and abs(lead) > friction:
                way = 1 if lead > 0 else -1
            state = by_way[way] @ state
            if friction > 0 and state[1] * way < 0:
                way, state[1] = 0, 0.0
    return answer
