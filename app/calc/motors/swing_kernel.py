"""How a rotor swings around a field that stands or turns, compiled: pendulum, detent, viscous and Coulomb friction,
play."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ...kernels import Kernels

FloatArray = NDArray[np.float64]

# What `p` holds: w^2 [1/s^2], viscous friction over inertia [1/s], Coulomb friction, sine and cosine of the detent
# torque as shares of the holding torque, and play between shaft and encoder [rad electrical].
SQUARE, VISCOUS, FRICTION, SINE, COSINE, PLAY = range(6)
PARAMETERS: Final = 6

compiled = Kernels(__file__).compiled


@compiled
def swing(
    p: FloatArray, field: float, rate: float, place: float, speed: float, behind: float, dt: float, seen: FloatArray
) -> None:
    """Fill `seen` with where the encoder sees the rotor, every `dt` [s] from its start at `place` with `speed` on.

    field, place, seen : [rad electrical]; rate, speed : of field and rotor [rad/s]; behind : how far the rotor is ahead
    of the encoder at first.
    Semi-implicit Euler: its frequency is off by (w dt)^2 / 24.
    """
    square, half = p[SQUARE], p[PLAY] / 2.0
    damp, held = 1.0 / (1.0 + p[VISCOUS] * dt), p[FRICTION] * square * dt
    of_sine, of_cosine = p[SINE], p[COSINE]
    for index in range(len(seen)):
        seen[index] = place - behind
        sine, cosine = math.sin(place), math.cos(place)
        twice = 2.0 * sine * cosine
        sine_4, cosine_4 = 2.0 * twice * (1.0 - 2.0 * sine * sine), 1.0 - 2.0 * twice * twice
        torque = math.sin(field + rate * dt * index - place) - of_sine * sine_4 - of_cosine * cosine_4
        new = (speed + torque * square * dt) * damp
        if new > held:
            speed = new - held
        elif new < -held:
            speed = new + held
        else:
            speed = 0.0
        place += speed * dt
        behind = min(max(behind + speed * dt, -half), half)
