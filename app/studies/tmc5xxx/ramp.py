"""The registers of a TMC5xxx that make a ramp: one speed and acceleration, or six points (DS-TMC5160 12.1)."""

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

# Without V1 (and V2) neither A1, D1 nor A2, D2 have a part in the ramp.
RAMP = RampRegisters({SPEED: ("VMAX",), ACCELERATION: ("AMAX", "DMAX")}, off={"V1": 0, "V2": 0}, brake=("DMAX",))
SIX_POINTS = RampRegisters(
    {
        SPEED: ("VMAX",),
        ACCELERATION: ("AMAX",),
        KNEE: ("V1",),
        KNEE_ACCELERATION: ("A1",),
        DECELERATION: ("DMAX",),
        KNEE_DECELERATION: ("D1",),
    },
    off={"V2": 0},
    brake=("DMAX", "D1"),
    shares=SHARES,
    time_s=six_point_time("VSTART", "VSTOP"),
)
