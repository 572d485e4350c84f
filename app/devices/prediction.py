"""The ramp that the calculators expect for a motion under way, on device time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class PredictedPhase:
    """A named part of the ramp, from its start [s]."""

    name: str
    start_s: float
    end_s: float


@dataclass(frozen=True, slots=True)
class Prediction:
    """`time_s` counts from `started_at_s` (device time); positions are absolute microsteps."""

    axis: int
    started_at_s: float
    duration_s: float
    time_s: NDArray[np.float64]
    position: NDArray[np.float64]
    velocity_pps: NDArray[np.float64]
    phases: tuple[PredictedPhase, ...]
    ended_at_s: float | None = None
    """When something changed the motion (a stop, a write, a switch): from then on the ramp says nothing."""
    ended_by: str = ""
