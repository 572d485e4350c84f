"""The registers of a TMC4361 that make a ramp of one speed and one acceleration (DS-TMC4361 6.3).

With S-ramps of one jerk too: all four bows alike.
"""

from __future__ import annotations

from ..ramp_settings import ACCELERATION, JERK, SPEED, RampRegisters

S_SHAPED = 2
RAMP = RampRegisters(
    {SPEED: ("VMAX",), ACCELERATION: ("AMAX", "DMAX"), JERK: ("BOW1", "BOW2", "BOW3", "BOW4")},
    only={JERK: ("RAMP_PROFILE", S_SHAPED)},
)
