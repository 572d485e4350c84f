"""The ramp expected of a module: SixPoint to a target, a trapezoid to a speed.

A module on a wire has no clock that anybody could read. A motion is taken to start half a round trip
before the answer to its command was there, which on a quiet line is some 0.1 ms beside the truth.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from app.calc.ramp_curve import RampCurve
from app.calc.sixpoint import MotionPlan, SixPoint, position_plan, velocity_plan
from app.devices.pd42 import rows
from app.devices.prediction import FloatArray, Prediction, wrapped

POSITION_BITS = 32
RAMP_WAIT_S = 512 / 16e6
"""Unit of the ramp wait time, AP 21 (5160: TZEROWAIT) [s]."""


class PlannedMotion(Prediction):
    """A motion by its plan, exact at any time."""

    def __init__(self, axis: int, started_at_s: float, start_position: int, plan: MotionPlan) -> None:
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
        outside = times_s < self.started_at_s
        if self.ended_at_s is not None:
            outside |= times_s >= self.ended_at_s
        position = wrapped(self.start_position + motion.position, POSITION_BITS)
        return np.where(outside, np.nan, position), np.where(outside, np.nan, motion.velocity_pps)


def sixpoint(known: Mapping[int, int], speed_unit: float, acceleration_unit: float) -> SixPoint | None:
    """The ramp of axis parameters as last seen, by number; None where some were never seen, or nothing would move."""
    if any(row.address not in known for row in rows.RAMP):
        return None
    speed = {row.address: known[row.address] * speed_unit for row in rows.RAMP}
    rate = {row.address: known[row.address] * acceleration_unit for row in rows.RAMP}
    try:
        return SixPoint(
            v_max=speed[rows.MAX_SPEED.address],
            a_max=rate[rows.MAX_ACCELERATION.address],
            d_max=rate[rows.MAX_DECELERATION.address],
            v_start=speed[rows.VSTART.address],
            a1=rate[rows.A1.address],
            v1=speed[rows.V1.address],
            d1=rate[rows.D1.address],
            v_stop=speed[rows.VSTOP.address],
            t_zero_wait_s=known.get(rows.RAMP_WAIT.address, 0) * RAMP_WAIT_S,
        )
    except ValueError:
        return None


def move_plan(ramp: SixPoint | None, distance: int, speed_pps: float) -> MotionPlan | None:
    """To a target; None where the parameters make no motion."""
    try:
        return None if ramp is None else position_plan(ramp, distance, speed_pps)
    except ValueError:
        return None


def turn_plan(ramp: SixPoint | None, target_pps: float, speed_pps: float) -> MotionPlan | None:
    """To a speed; None where the parameters make no motion."""
    try:
        return None if ramp is None else velocity_plan(ramp, target_pps, speed_pps)
    except ValueError:
        return None
