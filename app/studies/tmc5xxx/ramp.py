"""The registers of a TMC5xxx that make a ramp of one speed and one acceleration (DS-TMC5160 12.1)."""

from __future__ import annotations

from ..ramp_settings import ACCELERATION, SPEED, RampRegisters

# Without V1 (and V2) neither A1, D1 nor A2, D2 have a part in the ramp.
RAMP = RampRegisters({SPEED: ("VMAX",), ACCELERATION: ("AMAX", "DMAX")}, off={"V1": 0, "V2": 0}, brake=("DMAX",))
