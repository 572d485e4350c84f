"""Which registers are configuration, and in which order they are safe to write."""

from __future__ import annotations

from ...registers.model import Register
from ..rules import Counted, ProfileRules


def physical(held: Counted, row: Register, value: int) -> tuple[float, str] | None:
    """A velocity, which counts in the clock."""
    return (value * held.clock_hz / (1 << 24), "pps") if row.unit == "fCLK/2^24 pps" else None


RULES = ProfileRules(
    # VACTUAL is what the motor was last told to do. NODECONF is of the line that the chip is on.
    state=frozenset({"VACTUAL", "OTP_PROG", "FACTORY_CONF", "NODECONF"}),
    state_fields=frozenset({"test_mode"}),
    # Currents before the chopper that lets them flow (CHOPCONF.toff).
    order=("current", "microsteps", "general", "thresholds", "stealthchop", "driver"),
    physical=physical,
)
