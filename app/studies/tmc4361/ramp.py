"""The registers of a TMC4361 that make a ramp of one speed and one acceleration (DS-TMC4361 6.3). With S-ramps the
bows stay as they are."""

from __future__ import annotations

from ..ramp_settings import RampRegisters

RAMP = RampRegisters(speed=("VMAX",), acceleration=("AMAX", "DMAX"), off={})
