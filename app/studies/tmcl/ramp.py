"""The parameters of a TMCL module that make a ramp, one of six points, or a hop (FM-PD42-1241 7.5)."""

from __future__ import annotations

from ..ramp_settings import (
    ACCELERATION,
    DECELERATION,
    KNEE,
    KNEE_ACCELERATION,
    KNEE_DECELERATION,
    SPEED,
    RampRegisters,
)
from ..sixpoint_ramp import SHARES, six_point_time

_ACCELERATIONS = ("maximum_acceleration", "maximum_deceleration")
_OFF = {"velocity_v1": 0}
# Without V1 neither A1 nor D1 have a part in the ramp. Without a SixPoint ramp there is one acceleration for both ways.
RAMP = RampRegisters(
    {SPEED: ("maximum_positioning_speed",), ACCELERATION: _ACCELERATIONS}, off=_OFF, brake=_ACCELERATIONS[1:]
)
SIX_POINTS = RampRegisters(
    {
        SPEED: ("maximum_positioning_speed",),
        ACCELERATION: _ACCELERATIONS[:1],
        KNEE: ("velocity_v1",),
        KNEE_ACCELERATION: ("acceleration_a1",),
        DECELERATION: _ACCELERATIONS[1:],
        KNEE_DECELERATION: ("deceleration_d1",),
    },
    brake=(_ACCELERATIONS[1], "deceleration_d1"),
    shares=SHARES,
    time_s=six_point_time("velocity_vstart", "velocity_vstop"),
)
# It starts and stops at full speed.
HOP = RampRegisters(
    {
        SPEED: ("maximum_positioning_speed", "velocity_vstart", "velocity_vstop", "minimum_speed"),
        ACCELERATION: _ACCELERATIONS,
    },
    off=_OFF,
    brake=_ACCELERATIONS[1:],
)
