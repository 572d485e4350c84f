"""A velocity over time that a user has drawn: what it asks for, and the points that are sent for it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class VelocityProfile:
    """Knots of v(t), between which velocity is linear.

    time_s : rising from 0 [s, n]
    velocity_pps : 0 at the first and at the last of them [microsteps/s, n]

    Raises ValueError for anything else.
    """

    time_s: FloatArray
    velocity_pps: FloatArray

    @classmethod
    def of(cls, time_s: ArrayLike, velocity_pps: ArrayLike) -> VelocityProfile:
        time, velocity = np.asarray(time_s, dtype=np.float64), np.asarray(velocity_pps, dtype=np.float64)
        if time.ndim != 1 or time.shape != velocity.shape or len(time) < 2:
            raise ValueError(f"a profile is two points or more, a time and a velocity each, not {time.shape}")
        if not (np.isfinite(time).all() and np.isfinite(velocity).all()):
            raise ValueError("times and velocities are finite numbers")
        if time[0] != 0:
            raise ValueError(f"a profile begins at 0 s, not at {time[0]:g} s")
        falls = np.flatnonzero(np.diff(time) <= 0)
        if len(falls):
            after = int(falls[0]) + 1
            raise ValueError(
                f"times rise: point {after} at {time[after]:g} s does not come after {time[after - 1]:g} s"
            )
        for where, held in (("begins", velocity[0]), ("ends", velocity[-1])):
            if held != 0:
                raise ValueError(f"a profile {where} at rest, not at {held:g} pps")
        return cls(time, velocity)

    @property
    def duration_s(self) -> float:
        return float(self.time_s[-1])

    @property
    def peak_pps(self) -> float:
        """The greatest speed, either way."""
        return float(np.abs(self.velocity_pps).max())

    @property
    def acceleration_pps2(self) -> float:
        """The greatest change of velocity, up or down [microsteps/s^2]."""
        return float(np.abs(np.diff(self.velocity_pps) / np.diff(self.time_s)).max())

    def points(self, rate_hz: float | None) -> tuple[FloatArray, FloatArray]:
        """Times [s] and velocities [pps] to send: `rate_hz` of them a second, or the knots themselves."""
        if rate_hz is None:
            return self.time_s, self.velocity_pps
        count = int(np.floor(self.duration_s * rate_hz * (1 + 1e-12)))
        time = np.arange(count + 1) / rate_hz
        if self.duration_s - time[-1] > 1e-9:
            time = np.append(time, self.duration_s)
        velocity = np.interp(time, self.time_s, self.velocity_pps)
        velocity[-1] = 0.0
        return time, velocity


def held_positions(time_s: FloatArray, velocity_pps: FloatArray) -> FloatArray:
    """How far a motor has gone at each point, each velocity held until the next [microsteps, n], from 0 on."""
    return np.concatenate(([0.0], np.cumsum(velocity_pps[:-1] * np.diff(time_s))))
