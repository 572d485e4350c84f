"""What the ADC of a chip measures of its drive, in its own steps (KLIPPER, of the TMC2240)."""

from __future__ import annotations

SUPPLY_V, ZERO_C, PER_C, MOST = 9.732e-3, 2038, 7.7, (1 << 13) - 1


def supply(volts: float) -> int:
    """ADC_VSUPPLY for `volts` [V]."""
    return _measured(volts / SUPPLY_V)


def temperature(celsius: float) -> int:
    """ADC_TEMP at `celsius` [degC]."""
    return _measured(ZERO_C + PER_C * celsius)


def _measured(value: float) -> int:
    return min(max(round(value), 0), MOST)
