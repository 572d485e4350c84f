"""The motion that a command makes of the ramp's registers, by the planner of SixPoint."""

from __future__ import annotations

from ...devices.core.planned_motion import PlannedMotion
from ...devices.core.sixpoint_plans import move_plan, turn_plan
from ...devices.tmc5xxx.ramp import Ramp
from ...devices.tmc5xxx.roles import roles_of, signed
from ..rules import MotionStart, Settings, known


def expected(held: Settings, start: MotionStart, target: int | None, velocity: int) -> PlannedMotion:
    """The motion from `start` to `target` [microsteps], or to `velocity`. Raises ValueError."""
    ramp = Ramp(known(held, start.axis, roles_of(held.model).axes[start.axis].ramp), held.clock_hz)
    if target is None:
        wanted_pps = velocity * ramp.velocity_unit_pps
        plan = turn_plan(ramp.sixpoint(vmax=abs(velocity) or 1), wanted_pps, start.velocity_pps)
    else:
        plan = move_plan(ramp.sixpoint(), signed(target - start.position), start.velocity_pps)
    if plan is None:
        raise ValueError("the registers of the ramp made no motion")
    return PlannedMotion(start.axis, start.at_s, start.position, plan)
