"""Parameters 165 and 166 of the boards with a TMC5xxx: two fields of CHOPCONF each, by CHM.

With CHM set the firmware means the hysteresis, without it fast decay and sine offset: the other way round than the
chips. What else each board's firmware does amiss stays as well, since a client sees it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

CHM, UPPER = 1 << 14, 1 << 11
"""Bits of CHOPCONF; the second is the highest one of the fast decay time."""
_LOW_SHIFT, _LOW = 4, 0x70
_HIGH_SHIFT, _HIGH = 7, 0x780
"""Fields at the same place: HSTRT and the fast decay time's lower bits; HEND and the sine offset."""

Reader = Callable[[int], int]
Writer = Callable[[int, int], int]
"""CHOPCONF and what is written to the parameter, to CHOPCONF."""


def _low(word: int) -> int:
    return (word & _LOW) >> _LOW_SHIFT


def _high(word: int) -> int:
    return (word & _HIGH) >> _HIGH_SHIFT


def _with_low(word: int, value: int) -> int:
    return word & ~_LOW | value << _LOW_SHIFT & _LOW


def _with_high(word: int, value: int) -> int:
    return word & ~_HIGH | value << _HIGH_SHIFT & _HIGH


def _upper(word: int) -> int:
    return 8 if word & UPPER else 0


def _with_upper(word: int, on: int) -> int:
    return word & ~UPPER | (UPPER if on else 0)


def _either_way(if_chm: Reader, if_not: Reader) -> Reader:
    return lambda word: if_chm(word) if word & CHM else if_not(word)


def _written_either_way(if_chm: Writer, if_not: Writer) -> Writer:
    return lambda word, value: if_chm(word, value) if word & CHM else if_not(word, value)


def _decay_of_5130(word: int, value: int) -> int:
    """The fourth bit gets into the field above as well, where a 1 stays."""
    return _with_upper(word, value & 8) & ~_LOW | (value & 0xF) << _LOW_SHIFT


END_READ: Mapping[str, Reader] = MappingProxyType(
    {
        "tmc5031": _either_way(_high, lambda word: _low(word) | _upper(word)),
        "tmc5062": _either_way(_high, lambda word: _low(word) | _upper(word)),
        "tmc5072": _either_way(_high, _low),
        # two of them combine what they find with a comparison, or mask it after shifting
        "tmc5130": _either_way(_high, lambda word: 8 if _low(word) or _upper(word) else 0),
        "tmc5160": _either_way(lambda word: word >> 7 & _HIGH, lambda word: word >> 4 & _LOW | (8 if word & 11 else 0)),
        # without CHM it reads register 6 instead of CHOPCONF, which is 0 unless X_COMPARE repeats
        "tmc5240": _either_way(lambda word: word >> 7 & _HIGH, lambda word: 8 if word & 11 else 0),
    }
)
"""165, of each board."""
END_WRITTEN: Mapping[str, Writer] = MappingProxyType(
    {
        "tmc5031": _written_either_way(_with_high, _with_low),
        "tmc5062": _written_either_way(_with_high, lambda word, value: _with_low(_with_upper(word, value & 8), value)),
        "tmc5072": _written_either_way(_with_high, lambda word, value: _with_low(_with_upper(word, value & 8), value)),
        "tmc5130": _written_either_way(_with_high, _decay_of_5130),
        "tmc5160": _written_either_way(_with_high, lambda word, value: _with_low(_with_upper(word, 0), value)),
        "tmc5240": _written_either_way(_with_high, lambda word, value: _with_low(_with_high(word, value & 8), value)),
    }
)
START_READ: Mapping[str, Reader] = MappingProxyType(
    {
        "tmc5031": _either_way(_low, _high),
        "tmc5062": _either_way(_low, lambda word: _high(word) | _upper(word)),
        "tmc5072": _either_way(_low, lambda word: _high(word) | _upper(word)),
        "tmc5130": _either_way(_low, lambda word: 8 if _high(word) or _upper(word) else 0),
        "tmc5160": _either_way(lambda word: word >> 4 & _LOW, lambda word: word >> 7 & _HIGH | _upper(word)),
        "tmc5240": _either_way(lambda word: word >> 4 & _LOW, lambda word: word >> 7 & _HIGH | _upper(word)),
    }
)
"""166."""
START_WRITTEN = _written_either_way(_with_low, _with_high)
