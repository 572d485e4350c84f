"""Positions and rates of an axis in people's units, with our errors instead of the calculators'."""

from __future__ import annotations

from ...calc.units.mechanics import POSITION_UNITS, RATE_UNITS, Mechanics
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


def velocity_unit_in(unit: str, mechanics: Mechanics, pps: float) -> float:
    """How much of `unit` a chip unit of velocity is, that of `pps`. Raises UsageError for one that the axis lacks."""
    if unit == CHIP:
        return 1.0
    spelled = SPELLINGS.get(unit, unit)
    if spelled not in RATE_UNITS:
        raise UsageError(f"{unit!r} is no unit of velocity; there are {', '.join((*RATE_UNITS, CHIP))}")
    try:
        return float(mechanics.from_microsteps(pps, spelled))
    except ValueError as error:
        raise UsageError(str(error)) from error
