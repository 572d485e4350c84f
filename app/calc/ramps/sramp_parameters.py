"""The registers of a TMC4361's S-ramp in physical units, and the bow to begin with."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np

from .curve import FloatArray


@dataclass(frozen=True)
class SRamp:
    """Velocities, accelerations and bows of an S-ramp; none negative, and vmax, amax, dmax and the bows above 0.

    vmax, vstart, vstop [pps], amax, dmax, astart, dfinal [pps^2], bow1, bow2, bow3, bow4 [pps^3]
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
                "change to velocity mode, or write VMAX = 1 first (DS-TMC4361 8.2.2)"
            )
        for name in ("amax", "dmax"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} is above 0: with 0 the velocity never changes")
        for name in ("bow1", "bow2", "bow3", "bow4"):
            if not getattr(self, name) > 0:
                raise ValueError(f"{name} is above 0: with 0 the acceleration never changes, and VMAX is out of reach")

    @cached_property
    def array(self) -> FloatArray:
        """As the kernel takes them."""
        return np.array([float(getattr(self, field.name)) for field in fields(self)])

    @property
    def start_acceleration(self) -> float:
        """What a start from rest asks for, before it is altered to fit VMAX (DS-TMC4361 8.2.1, 8.2.2) [pps^2]."""
        return self.amax if self.vstart > 0 and not self.use_astart_and_vstart else min(self.astart, self.amax)


def default_bow(amax: float, vmax: float) -> float:
    """AMAX^2 / VMAX [pps^3]: the bow with which a slope from 0 to VMAX just touches AMAX, and B12 takes no time.

    Raises ValueError unless both are above 0 and finite.
    """
    for name, number in (("amax", amax), ("vmax", vmax)):
        if not (number > 0 and math.isfinite(number)):
            raise ValueError(f"{name} is above 0 and finite, got {number}")
    return amax * amax / vmax
