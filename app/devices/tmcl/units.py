"""Speeds and accelerations of the module in pps, whatever its unit mode (AP 255).

In unit mode 1 the module counts in pps and pps^2, in unit mode 0 in those of its driver chip, a
TMC5160 at `clock_hz` (FM-PD42-1241 7.4; formulas of the TMC5160 data sheet, chapter 12.1).
"""

from __future__ import annotations

INTERNAL, PPS = 0, 1


def speed_unit_pps(clock_hz: float, unit_mode: int | None) -> float:
    """What a speed of 1 is [pps]."""
    return clock_hz / 2 / (1 << 23) if unit_mode == INTERNAL else 1.0


def acceleration_unit_pps2(clock_hz: float, unit_mode: int | None) -> float:
    """What an acceleration of 1 is [pps^2]."""
    return clock_hz**2 / (512 * 256) / (1 << 24) if unit_mode == INTERNAL else 1.0


def read_back_tolerance(unit: str, value: int, clock_hz: float, microsteps: int) -> float:
    """How far a read-back may be from what was written by rounding alone, in unit mode 1.

    The driver chip keeps whole units of its own, and thresholds of speed as a time between steps.
    """
    if unit == "pps":
        step_time = 1.5 * value * value * (256 / microsteps) / clock_hz
        return 2 + step_time
    if unit == "pps^2":
        return 1.01 * acceleration_unit_pps2(clock_hz, INTERNAL) + 1
    return 8.0 if unit == "1/255" else 0.0
