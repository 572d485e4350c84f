"""What velocities and accelerations in registers mean: the dividers are part of them."""

from __future__ import annotations

from ...calc.units.tmc428 import MAX_DIVIDER, acceleration_hz_s, pulse_rate_hz
from ...registers.model import Register
from ..rules import Counted


def physical(held: Counted, row: Register, value: int) -> tuple[float, str] | None:
    """`value` of the register `row` in people's units."""
    axis = row.axis or 0
    if row.unit.startswith("fCLK/(65536"):
        return pulse_rate_hz(value, _divider(held, "pulse_div", axis), held.clock_hz), "pps"
    if row.unit.startswith("fCLK^2/2^(pulse_div"):
        dividers = _divider(held, "pulse_div", axis), _divider(held, "ramp_div", axis)
        return acceleration_hz_s(value, *dividers, held.clock_hz), "pps^2"
    return None


def _divider(held: Counted, name: str, axis: int) -> int:
    code = held.field(name, axis)
    if code is None:
        raise KeyError(name)
    return min(code, MAX_DIVIDER)  # above it a divider has no meaning in the sheets
