"""What parameters mean that count in units of the ramp generator: a TMC5xxx's until the module is told otherwise, or a
TMC429's with its dividers."""

from __future__ import annotations

from ...calc.units.tmc5xxx import acceleration_unit_pps2, velocity_unit_pps
from ...registers.model import Register
from ..rules import Counted
from ..tmc428.physical import physical as by_dividers


def physical(held: Counted, row: Register, value: int) -> tuple[float, str] | None:
    """`value` of the parameter `row` in people's units."""
    if row.internal_range is None:
        return by_dividers(held, row, value)
    if held.field("unit_mode", 0) != 0:
        return float(value), row.unit
    one = velocity_unit_pps if row.unit == "pps" else acceleration_unit_pps2
    return value * one(held.clock_hz), row.unit
