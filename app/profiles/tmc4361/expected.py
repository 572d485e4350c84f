"""The motion that a command makes of the ramp's registers, by the planners of S-ramp, trapezoid and jump."""

from __future__ import annotations

from ...devices.core.planned_motion import PlannedMotion
from ...devices.tmc4361 import prediction, roles
from ...devices.tmc4361.departure import COUNTER
from ...devices.tmc4361.ramp_parameters import RampParameters
from ...errors import BenchError
from ...registers.model import to_raw
from ..rules import MotionStart, Settings, known


def expected(held: Settings, start: MotionStart, target: int | None, velocity: int) -> PlannedMotion:
    """The motion from `start` to `target` [microsteps], or to `velocity` [1/256 pps]. Raises ValueError."""
    found = known(held, roles.AXIS, (row.name for row in roles.RAMP))
    ramp = RampParameters({row.address: to_raw(found[row.name], row.width) for row in roles.RAMP})
    try:
        ramp.require_motion(ramp.shape)
    except BenchError as error:
        raise ValueError(str(error)) from error
    if any(ramp.gates()):
        raise ValueError("START_CONF had it wait for a start signal, of which the recording does not tell")
    if held.field("circular_movement_en", roles.AXIS):
        raise ValueError("in circular movement the shorter way round is taken, and X_RANGE cannot be read")
    now = start.velocity_pps, start.acceleration_pps2
    if target is None:
        plan = prediction.to_velocity(ramp, ramp.shape, velocity / 256, *now)
    else:
        way = COUNTER.way(target, start.position)
        plan = prediction.to_position(ramp, ramp.shape, abs(ramp.value(roles.VMAX)) / 256, way, *now)
    if plan is None:
        raise ValueError("the registers of the ramp made no motion")
    return PlannedMotion(roles.AXIS, start.at_s, start.position, plan)
