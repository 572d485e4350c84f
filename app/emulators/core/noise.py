"""What a bad wire does to bytes: bits flip, frames break off."""

from __future__ import annotations

import random


def flip(data: bytes, rate: float, noise: random.Random) -> bytes:
    """`data` with each bit flipped at probability `rate`."""
    if not rate:
        return data
    mask = sum(1 << bit for bit in range(8 * len(data)) if noise.random() < rate)
    return (int.from_bytes(data, "big") ^ mask).to_bytes(len(data), "big")


def cut(data: bytes, rate: float, noise: random.Random) -> bytes:
    """`data`, broken off somewhere inside at probability `rate`."""
    if len(data) > 1 and rate and noise.random() < rate:
        return data[: noise.randrange(1, len(data))]
    return data
