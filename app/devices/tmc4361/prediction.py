"""The ramp expected of a TMC4361, from any state, by the planners; None where the registers make none."""

from __future__ import annotations

from ...calc.ramps import sramp, sramp_trapezoid
from ...calc.ramps.sramp_plan import SRampPlan
from . import roles
from .ramp_parameters import RampParameters


def to_position(
    ramp: RampParameters, shape: int, vmax_pps: float, distance: int, v_pps: float, a_pps2: float
) -> SRampPlan | None:
    """To a target `distance` microsteps away, at `vmax_pps` at the most, from velocity and acceleration now."""
    try:
        if shape == roles.S_SHAPED:
            return sramp.position_plan(ramp.s_ramp(vmax_pps), distance, v_pps, a_pps2)
        if shape == roles.TRAPEZOID:
            return sramp_trapezoid.trapezoid_position_plan(ramp.trapezoid(vmax_pps), distance, v_pps, a_pps2)
        return sramp_trapezoid.hold_position_plan(vmax_pps, distance)
    except ValueError:
        return None


def to_velocity(ramp: RampParameters, shape: int, target_pps: float, v_pps: float, a_pps2: float) -> SRampPlan | None:
    """To a velocity with its sign, and on at that. VMAX is the target itself, so any other limit will do."""
    try:
        if shape == roles.S_SHAPED:
            return sramp.velocity_plan(ramp.s_ramp(abs(target_pps) or 1.0), target_pps, v_pps, a_pps2)
        if shape == roles.TRAPEZOID:
            trapezoid = ramp.trapezoid(abs(target_pps) or 1.0)
            return sramp_trapezoid.trapezoid_velocity_plan(trapezoid, target_pps, v_pps, a_pps2)
        return sramp_trapezoid.hold_velocity_plan(target_pps)
    except ValueError:
        return None
