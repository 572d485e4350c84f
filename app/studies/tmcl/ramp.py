"""The parameters of a TMCL module that make a ramp of one speed and one acceleration (FM-PD42-1241 7.5)."""

from __future__ import annotations

from ..ramp_settings import ACCELERATION, SPEED, RampRegisters

# Without V1 neither A1 nor D1 have a part in the ramp. Without a SixPoint ramp there is one acceleration for both ways.
RAMP = RampRegisters(
    {
        SPEED: ("maximum_positioning_speed",),
        ACCELERATION: ("maximum_acceleration", "maximum_deceleration"),
    },
    off={"velocity_v1": 0},
    brake=("maximum_deceleration",),
)
