"""What a ramp asks of a motor, beside what that can give: for ramps whose acceleration is a smooth curve."""

from __future__ import annotations

import numpy as np

from ...calc.motor_torque import StepperMotor
from ...calc.ramps.curve import RampCurve
from .sramp_schemas import RampTorque

_CURVE_POINTS = 120
_MOST_OVERLOAD = 1e6
"""Where the motor has no torque at all, the margin is minus infinity, which JSON cannot say."""


def torque_of(motor: StepperMotor, curve: RampCurve, vmax: float) -> RampTorque:
    """The torque at each sample of `curve`, and the motor's own curve up to half more than `vmax` [pps]."""
    available = motor.available_nm(curve.velocity_pps)
    # the last sample stands: what it takes to leave rest is no part of this motion
    margin = motor.margin(curve.velocity_pps, curve.acceleration_pps2)[:-1]
    least = int(np.argmin(margin))
    speed = np.linspace(0.0, 1.5 * vmax, _CURVE_POINTS)
    return RampTorque(
        available_nm=available.tolist(),
        required_nm=motor.required_nm(curve.velocity_pps, curve.acceleration_pps2).tolist(),
        margin=max(float(margin[least]), -_MOST_OVERLOAD),
        margin_at_s=float(curve.time_s[least]),
        speed_pps=speed.tolist(),
        curve_nm=motor.available_nm(speed).tolist(),
    )
