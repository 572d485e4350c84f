"""How messages write a number: as a user would type it, never with an exponent that hides what it is."""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal

_EXACT_BELOW = 1e15
"""Whole numbers below this are written with all their digits."""
_TINY = 1e-6


def plain(value: float, digits: int = 6) -> str:
    """`value` with so many significant digits, whole numbers in full: 2000000, not 2e+06.

    >>> plain(2e6), plain(12345678), plain(1234567.89), plain(0.1 + 0.2), plain(1.5e-9)
    ('2000000', '12345678', '1234568', '0.3', '1.5e-09')
    """
    value = float(value)
    if not math.isfinite(value):
        return str(value)
    size = abs(value)
    if size >= _EXACT_BELOW or 0 < size < _TINY:
        return f"{value:.{digits}g}"
    if value == round(value) or size >= 10**digits:
        return str(round(value))
    return format(Decimal(f"{value:.{digits}g}"), "f")


def counted(count: float | Sequence[float], one: str, digits: int = 6) -> str:
    """A number of things, or several such numbers; `one` is the singular of what is counted.

    >>> counted(1, "turn"), counted(0.5, "turn"), counted([0.5, 1], "turn")
    ('1 turn', '0.5 turns', '0.5, 1 turns')
    """
    number = ", ".join(plain(each, digits) for each in (count if isinstance(count, Sequence) else [count]))
    return f"{number} {one if number == '1' else f'{one}s'}"


def times(count: int) -> str:
    """How often.

    >>> times(1), times(3)
    ('once', '3 times')
    """
    return "once" if count == 1 else f"{count} times"
