"""What every ramp calculator answers with: a motion sampled over time, its phases and how it ended."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

MAX_SAMPLES = 1_000_000


@dataclass(frozen=True)
class Phase:
    """A stretch of a motion: from `start_s` to `end_s` [s], from `start_velocity_pps` to `end_velocity_pps` [pps].

    `start_position`, `end_position` : microsteps from the start of the move.
    """

    name: str
    start_s: float
    end_s: float
    start_position: float
    end_position: float
    start_velocity_pps: float
    end_velocity_pps: float

    @property
    def duration_s(self) -> float:
        return self.end_s - self.start_s


@dataclass(frozen=True)
class RampCurve:
    """A motion from t = 0 to its end; the last sample is the end.

    duration_s : time of the whole motion [s]
    shape : "trapezoid" where a stretch of the highest velocity is reached, "triangle" where braking begins before
        that, else the ramp mode's name ("velocity", "hold") or "rest"
    phases : in order, without gaps
    time_s, position, velocity_pps, acceleration_pps2 : all of one length [samples]; [s], [microsteps from the
        start], [pps], [pps^2]
    overshoot_steps : farthest beyond the target [microsteps]
    settled : whether the motor rests at the target at the end
    settling_s : from the first arrival at the target until rest [s]
    velocity_256 : the ramp generator's velocity in 1/256 chip units [samples]; None for ideal ramps
    """

    duration_s: float
    shape: str
    phases: tuple[Phase, ...]
    time_s: FloatArray
    position: FloatArray
    velocity_pps: FloatArray
    acceleration_pps2: FloatArray
    overshoot_steps: int
    settled: bool
    settling_s: float = 0.0
    velocity_256: NDArray[np.int64] | None = None


def check_samples(samples: int) -> None:
    """Raise ValueError unless `samples` is a whole number of 2 to `MAX_SAMPLES`."""
    if samples != int(samples) or not 2 <= samples <= MAX_SAMPLES:
        raise ValueError(f"samples is a whole number of 2 to {MAX_SAMPLES}, got {samples}")
