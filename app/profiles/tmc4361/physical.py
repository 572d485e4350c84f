"""What numbers in registers of the ramp mean: some count in clocks where direct units are on."""

from __future__ import annotations

from ...calc.units.tmc4361 import FORMATS, Units
from ...registers.model import Register
from ..rules import Counted


def physical(held: Counted, row: Register, value: int) -> tuple[float, str] | None:
    """`value` of the register `row` in people's units."""
    if row.name not in FORMATS:
        return None
    direct = bool(held.field("direct_acc_val_en", 0)), bool(held.field("direct_bow_val_en", 0))
    return Units(held.clock_hz, *direct).from_raw(row.name, value), FORMATS[row.name].quantity.unit
