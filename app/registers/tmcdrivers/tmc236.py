"""What a TMC236, TMC239, TMC246 or TMC249 answers to each of its datagrams: twelve bits, and no registers.

Source: the drivers' data sheets (SPI protocol), as DS-TMC428 9.1 maps them (its figure 9-1 is of three TMC246/249). The
first bit that comes back is LD2. A TMC236 or TMC239 measures no load: its load bits are 0.
"""

from __future__ import annotations

BITS = 12
NAMES = frozenset(("tmc236", "tmc239", "tmc246", "tmc249"))
"""What a chain calls drivers with this answer."""
FLAGS = ("OCA", "OCB", "OLA", "OLB", "OCHS", "UV", "OTPW", "OT")
"""The lowest bits, the lowest first: overcurrent of a coil, open load, overcurrent of the high side, undervoltage,
warning of overtemperature, overtemperature."""
LOAD_FLAGS = ("LD0", "LD1", "LD2")
LOAD_LSB = 9
"""StallGuard's load value, 0..7: a stall is a value below a limit of the user's (STEPPYR)."""
PRESENT = 1 << 8
"""A bit that is always 1: without it nobody has answered."""


def load_of(answer: int) -> int:
    """The load value of an answer, 0..7: the less, the more load."""
    return answer >> LOAD_LSB & 7


def flags_of(answer: int) -> dict[str, bool]:
    """All bits that mean something, by name."""
    told = {name: bool(answer >> bit & 1) for bit, name in enumerate(FLAGS)}
    return told | {name: bool(answer >> LOAD_LSB + bit & 1) for bit, name in enumerate(LOAD_FLAGS)}
