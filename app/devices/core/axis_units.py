"""Positions and rates of an axis in people's units, with our errors instead of the calculators'."""

from __future__ import annotations

from ...calc.units.mechanics import POSITION_UNITS, Mechanics
from ...errors import UsageError

CHIP = "chip"
SPELLINGS = {"fullsteps_per_s": "fullsteps/s", "rad_per_s": "rad/s", "deg_per_s": "deg/s", "mm_per_s": "mm/s"}
"""Units as an address or a JSON key spells them."""


def to_position(mechanics: Mechanics, value: float, unit: str) -> int:
    """A position or distance as whole microsteps. Raises UsageError for a unit that the axis does not have."""
    if unit not in POSITION_UNITS:
        raise UsageError(f"{unit!r} is no unit of position; there are {', '.join(POSITION_UNITS)}")
    try:
        return round(mechanics.to_microsteps(value, unit))
    except (ValueError, OverflowError) as error:
        raise UsageError(str(error)) from error
