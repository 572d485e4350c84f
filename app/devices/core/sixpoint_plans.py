"""The motion expected of a SixPoint ramp generator, from any state; None where its parameters make none."""

from __future__ import annotations

from ...calc.ramps.sixpoint import MotionPlan, SixPoint, position_plan, velocity_plan


def move_plan(ramp: SixPoint | None, distance: int, speed_pps: float) -> MotionPlan | None:
    """To a target `distance` microsteps away, from a velocity [pps]."""
    try:
        return None if ramp is None else position_plan(ramp, distance, speed_pps)
    except ValueError:
        return None


def turn_plan(ramp: SixPoint | None, target_pps: float, speed_pps: float) -> MotionPlan | None:
    """To a velocity with its sign [pps], and on at that; from another one [pps]."""
    try:
        return None if ramp is None else velocity_plan(ramp, target_pps, speed_pps)
    except ValueError:
        return None
