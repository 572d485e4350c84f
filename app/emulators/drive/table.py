"""The microstep table: from MSLUT's difference bits to coil currents."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

PEAK = 248
"""What the default wave reaches either way, half a count offset included."""


def decode(words: Sequence[int], select: int, start: int) -> tuple[int, ...]:
    """The whole wave, 1024 entries of about -248..247, from MSLUT[0..7], MSLUTSEL and MSLUTSTART.

    Bit i of the words says by which of two neighbouring amounts entry i differs from entry i - 1; MSLUTSEL says which
    two in which of four segments. Bit 0 acts where the wave crosses zero at 512: the negative half is the complement
    of the positive one, as register dumps of real chips show.
    """
    borders = [select >> shift & 0xFF for shift in (8, 16, 24)]
    widths = [select >> 2 * segment & 3 for segment in range(4)]
    steps = [widths[sum(i >= border for border in borders)] - 1 + (words[i >> 5] >> (i & 31) & 1) for i in range(256)]
    quarter = [start & 0xFF]
    for step in steps[1:]:
        quarter.append(quarter[-1] + step)
    mirror = 2 * (start & 0xFF) - steps[0]
    half = quarter + quarter[::-1]
    return (*half, *(mirror - value for value in half))


def currents(wave: Sequence[int]) -> NDArray[np.float64]:
    """Share of the peak current at each entry. The half count makes the default wave an unbiased sine (a reading)."""
    return (np.asarray(wave, dtype=np.float64) + 0.5) / PEAK


@lru_cache(maxsize=64)
def wave_of(words: tuple[int, ...], select: int, start: int) -> tuple[tuple[int, ...], NDArray[np.float64]]:
    """Both of the above, kept: a chip that is reset goes through the same ten writes every time."""
    wave = decode(words, select, start)
    return wave, currents(wave)
