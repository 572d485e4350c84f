"""A microstep table on its way into the chip and out of it: 64 values, 32 words, 32 datagrams."""

from __future__ import annotations

from collections.abc import Sequence

from ..driver_chain.ram_words import (
    AREA_TABLE,
    CELL_MAX,
    CELLS,
    WORDS,
    pack_cells,
    unpack_words,
    whole_number,
    write_datagrams,
)


def checked_values(values: Sequence[int]) -> tuple[int, ...]:
    """A table as 64 ints of 0..63 [DAC counts]: what a table drawn by hand has to be.

    Raises ValueError for any other length, for a value out of range and for one that is not whole.
    """
    if len(values) != CELLS:
        raise ValueError(f"a microstep table has {CELLS} values, this one has {len(values)}")
    return tuple(whole_number(f"table value {index}", value, 0, CELL_MAX) for index, value in enumerate(values))


def table_ram_words(values: Sequence[int]) -> tuple[int, ...]:
    """The 32 register words lut_00..lut_31 of a table. Raises ValueError as `checked_values`."""
    return pack_cells(checked_values(values))


def values_from_ram_words(words: Sequence[int]) -> tuple[int, ...]:
    """The 64 values of the 32 register words lut_00..lut_31, whatever their unused bits hold.

    Raises ValueError unless there are 32 words of 24 bits.
    """
    if len(words) != WORDS:
        raise ValueError(f"a microstep table has {WORDS} RAM words, these are {len(words)}")
    return unpack_words(words)


def table_datagrams(values: Sequence[int]) -> tuple[int, ...]:
    """The 32 datagrams of 32 bits that write a table into the chip (DS-TMC428 Tables 12-1 and 12-2).

    Raises ValueError as `checked_values`.
    """
    return write_datagrams(AREA_TABLE, table_ram_words(values))
