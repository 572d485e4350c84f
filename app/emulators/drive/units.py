"""Numbers as the chip holds them."""

from __future__ import annotations

SIGNED_32 = 1 << 31


def wrap32(value: int) -> int:
    """To a signed 32-bit number."""
    return (value + SIGNED_32) % (1 << 32) - SIGNED_32


def signed(value: int, bits: int) -> int:
    """The lowest `bits` bits of `value`, taken as two's complement."""
    half = 1 << (bits - 1)
    return (value + half) % (1 << bits) - half


def bits(value: int, low: int, width: int) -> int:
    """A field of a register."""
    return value >> low & ((1 << width) - 1)
