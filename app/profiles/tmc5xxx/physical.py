"""What velocities and accelerations in registers mean: they count in the clock."""

from __future__ import annotations

from ...calc.units.tmc5xxx import acceleration_unit_pps2, velocity_unit_pps
from ...registers.model import Register
from ..rules import Counted


def physical(held: Counted, row: Register, value: int) -> tuple[float, str] | None:
    """`value` of the register `row` in people's units."""
    if row.unit == "fCLK/2^24 pps":
        return value * velocity_unit_pps(held.clock_hz), "pps"
    if row.unit == "fCLK^2/2^41 pps^2":
        return value * acceleration_unit_pps2(held.clock_hz), "pps^2"
    return None
