"""Velocities in people's units as the chip counts them, by the pulse divider."""

from __future__ import annotations

from ...calc.units.mechanics import Mechanics
from ...calc.units.tmc428 import MAX_VELOCITY, pulse_rate_hz
from ...errors import OutOfRange
from ...number_text import plain
from ..core.axis_units import velocity_unit_in


def to_chip_velocity(
    mechanics: Mechanics, value: float, unit: str, pulse_div: int, clock_hz: float, v_max: int
) -> tuple[int, list[str]]:
    """A velocity as -v_max..v_max, and what to know about it.

    Raises OutOfRange with the limits in `unit` (nothing is clipped, and nothing becomes a standstill),
    UsageError for a unit that the axis does not have.
    """
    one = one_chip_unit(mechanics, unit, pulse_div, clock_hz)
    exact = value / one
    limit = min(v_max, MAX_VELOCITY)
    # Rounded up by a hair: 30.517578125 pps * 2047 has to fit although a client sent it with fewer digits.
    if not abs(exact) <= limit + 1e-6 * limit:
        raise OutOfRange(
            "velocity", value, -limit * one, limit * one, f"{unit}; v_max is {v_max}, pulse_div {pulse_div}"
        )
    chip = max(-limit, min(limit, round(exact)))
    if chip == 0 and value:
        raise OutOfRange("velocity", value, one, limit * one, f"{unit}; less than one chip unit is a standstill")
    if chip and abs(chip / exact - 1) > 0.01:
        return chip, [f"rounded to {chip} chip units, {plain(chip * one, 6)} {unit}"]
    return chip, []


def one_chip_unit(mechanics: Mechanics, unit: str, pulse_div: int, clock_hz: float) -> float:
    """How much of `unit` velocity 1 is. Raises UsageError for a unit that the axis does not have."""
    return velocity_unit_in(unit, mechanics, pulse_rate_hz(1, pulse_div, clock_hz))
