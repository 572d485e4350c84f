"""The motion that a command makes of a module's parameters."""

from __future__ import annotations

from ...devices.core.planned_motion import PlannedMotion
from ...devices.core.sixpoint_plans import move_plan, turn_plan
from ...devices.tmcl.prediction import ramp_of
from ...devices.tmcl.roles import RegisterRoles
from ...devices.tmcl.units import SCALINGS
from ...registers.model import to_signed
from ...registers.tmcl.modules import MODULES
from ..rules import MotionStart, Settings, known


def expected(held: Settings, start: MotionStart, target: int | None, velocity: int) -> PlannedMotion:
    """The motion from `start` to `target` [microsteps], or to `velocity` [as the module counts]. Raises ValueError."""
    module = MODULES[held.model]
    roles, scaling = RegisterRoles(module), SCALINGS[module.counting]
    values = known(held, start.axis, (row.name for row in (*roles.counting, *roles.ramp)))
    counted = [values[row.name] for row in roles.counting]
    speed_pps = scaling.speed_unit_pps(held.clock_hz, counted)
    by_number = {row.address: values[row.name] for row in roles.ramp}
    wait = held.field(roles.ramp_wait.name, start.axis)
    ramp = ramp_of(
        roles,
        by_number if wait is None else {**by_number, roles.ramp_wait.address: wait},
        speed_pps,
        scaling.acceleration_unit_pps2(held.clock_hz, counted),
    )
    if target is None:
        plan = turn_plan(ramp, velocity * speed_pps, start.velocity_pps)
    else:
        bits = module.position_bits
        plan = move_plan(ramp, to_signed((target - start.position) % (1 << bits), bits), start.velocity_pps)
    if plan is None:
        raise ValueError("the parameters of the ramp made no motion")
    return PlannedMotion(start.axis, start.at_s, start.position, plan)
