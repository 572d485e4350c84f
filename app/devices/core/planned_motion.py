"""A motion that a planner knows in closed form: exact at any time, whatever ramp it is."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...calc.ramps.curve import RampCurve
from .prediction import FloatArray, Prediction, wrapped

POSITION_BITS = 32


class Moment(Protocol):
    """A motion at some times: position [microsteps from the start], velocity [pps], acceleration [pps^2]."""

    @property
    def position(self) -> NDArray[np.float64]: ...

    @property
    def velocity_pps(self) -> NDArray[np.float64]: ...

    @property
    def acceleration_pps2(self) -> NDArray[np.float64]: ...


class Plan(Protocol):
    """What the planners answer: `calc.ramps.sixpoint_plan.MotionPlan`, `calc.ramps.sramp_plan.SRampPlan`."""

    @property
    def duration_s(self) -> float: ...

    @property
    def end_velocity_pps(self) -> float: ...

    def at(self, time_s: FloatArray, /) -> Moment:
        """The motion at times from its start [s]."""
        ...

    def curve(self, samples: int = ..., /) -> RampCurve:
        """The motion sampled evenly."""
        ...


class PlannedMotion(Prediction):
    """A motion by its plan, of 32-bit positions."""

    def __init__(self, axis: int, started_at_s: float, start_position: int, plan: Plan) -> None:
        super().__init__(axis, started_at_s, start_position, POSITION_BITS)
        self.plan = plan

    @property
    def duration_s(self) -> float:
        return self.plan.duration_s

    @property
    def ends(self) -> bool:
        return self.plan.end_velocity_pps == 0

    def _ramp(self, samples: int) -> RampCurve:
        return self.plan.curve(samples)

    def at(self, times_s: FloatArray) -> tuple[FloatArray, FloatArray]:
        motion = self.plan.at(times_s - self.started_at_s)
        outside = self.outside(times_s)
        position = wrapped(self.start_position + motion.position, POSITION_BITS)
        return np.where(outside, np.nan, position), np.where(outside, np.nan, motion.velocity_pps)

    def acceleration_at(self, times_s: FloatArray) -> FloatArray:
        """Acceleration at device times [pps^2], NaN where `at` has it."""
        motion = self.plan.at(times_s - self.started_at_s)
        return np.where(self.outside(times_s), np.nan, motion.acceleration_pps2)

    def outside(self, times_s: FloatArray) -> NDArray[np.bool_]:
        """Where this says nothing: before the start, and after something has changed the motion."""
        outside = times_s < self.started_at_s
        if self.ended_at_s is not None:
            outside |= times_s >= self.ended_at_s
        return outside
