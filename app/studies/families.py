"""Which registers make the ramp of each family, as far as studies can set it."""

from __future__ import annotations

from collections.abc import Mapping

from ..devices.core.device import Device
from ..errors import WrongState
from .ramp_settings import RampRegisters
from .tmc5xxx.ramp import RAMP as SIX_POINT
from .tmc4361.ramp import RAMP as S_RAMP

RAMPS: Mapping[str, RampRegisters] = {"tmc5xxx": SIX_POINT, "tmc4361": S_RAMP}


def ramp_of(device: Device) -> RampRegisters:
    """The registers of its ramp. Raises WrongState for a family that no study sets."""
    found = RAMPS.get(device.family.family)
    if found is None:
        raise WrongState(
            f"no study sets the ramp of a {device.family.title} yet", "a chip with an encoder input can be tuned"
        )
    return found
