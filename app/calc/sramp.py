"""The S-ramp of the TMC4361 in continuous time, exact: seven phases with four bows, from rest or from any state.

    phase         B1          B12   B2       B23  B3        B34    B4
    acceleration  ASTART..AMAX AMAX  AMAX..0  0   0..-DMAX  -DMAX  -DMAX..-DFINAL     (v > 0, signs flip for v < 0)
    jerk          BOW1        0     -BOW2    0    -BOW3     0      BOW4

Slopes are as fast as the limits allow, VMAX is kept as long as possible, positioning ends exactly on the target
(002, 8.2). The chip works this out every 64 clocks; this is what its units and rules mean, without its rounding.

What the data sheet leaves open, and the reading here:
- ASTART and VSTART belong to a start from rest, VSTOP and DFINAL to a stop at rest (002, 8.2.1 says so of VSTART and
  VSTOP). A slope from one velocity to another begins and ends with acceleration 0.
- A reversal runs through velocity 0 on one slope: until there it brakes (DMAX, BOW3, BOW4), from there it
  accelerates (AMAX, BOW1, BOW2).
- "The starting acceleration becomes altered" where the slope does not fit VMAX (8.2.2): it is lowered until BOW2 ends
  on VMAX; in a short move until the move ends on the target.
- VSTOP while positioning: the velocity at the target is at most VSTOP, the acceleration whatever it is there.

Source: 002 (TMC4361 data sheet), 8.2, 8.2.1, 8.2.2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

from app.calc.sramp_plan import JerkPiece, LimitUse, RampWarning, SRampCurve, SRampMotion, SRampPlan

__all__ = [
    "JerkPiece",
    "LimitUse",
    "RampWarning",
    "SRamp",
    "SRampCurve",
    "SRampMotion",
    "SRampPlan",
    "default_bow",
]

POSITION_LIMIT = 1 << 32


@dataclass(frozen=True)
class SRamp:
    """The registers of an S-ramp in pps, pps^2 and pps^3; none negative, and vmax, amax, dmax and the bows above 0.

    use_astart_and_vstart : a start with VSTART begins with ASTART and a bow B1, not with AMAX (GENERAL_CONF bit 0)

    Raises ValueError for a number below 0 or not finite, and for a 0 with which the motor never gets anywhere.
    """

    vmax: float
    amax: float
    dmax: float
    bow1: float
    bow2: float
    bow3: float
    bow4: float
    vstart: float = 0.0
    vstop: float = 0.0
    astart: float = 0.0
    dfinal: float = 0.0
    use_astart_and_vstart: bool = False

    def __post_init__(self) -> None:
        for field in fields(self):
            number = getattr(self, field.name)
            if not (math.isfinite(number) and number >= 0):
                raise ValueError(f"{field.name} is finite and not below 0, got {number}")
        if not self.vmax > 0:
            raise ValueError(
                "vmax is above 0: with VMAX = 0 alone an S-ramp in positioning mode cannot be stopped either; "
                "change to velocity mode, or write VMAX = 1 first (002, 8.2.2)"
            )
        for name in ("amax", "dmax"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} is above 0: with 0 the velocity never changes")
        for name in ("bow1", "bow2", "bow3", "bow4"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} is above 0: with 0 the acceleration never changes, and VMAX is out of reach")


def default_bow(amax: float, vmax: float) -> float:
    """AMAX^2 / VMAX [pps^3]: the bow with which a slope from 0 to VMAX just touches AMAX, and B12 takes no time.

    Raises ValueError unless both are above 0 and finite.
    """
    for name, number in (("amax", amax), ("vmax", vmax)):
        if not (number > 0 and math.isfinite(number)):
            raise ValueError(f"{name} is above 0 and finite, got {number}")
    return amax * amax / vmax
