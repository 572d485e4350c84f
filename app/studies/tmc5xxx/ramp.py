"""The registers of a TMC5xxx that make a ramp: one speed and acceleration, or six points (DS-TMC5160 12.1)."""

from __future__ import annotations

from ..ramp_settings import ACCELERATION, KNEE, KNEE_ACCELERATION, SPEED, RampRegisters
from ..sixpoint_ramp import SHARES, six_point_time

_MOVING = {SPEED: ("VMAX",), ACCELERATION: ("AMAX", "DMAX")}
# Without V1 (and V2) neither A1, D1 nor A2, D2 have a part in the ramp.
RAMP = RampRegisters(_MOVING, off={"V1": 0, "V2": 0}, brake=("DMAX",))
SIX_POINTS = RampRegisters(
    {**_MOVING, KNEE: ("V1",), KNEE_ACCELERATION: ("A1", "D1")},
    off={"V2": 0},
    brake=("DMAX", "D1"),
    shares=SHARES,
    time_s=six_point_time("VSTART", "VSTOP"),
)
