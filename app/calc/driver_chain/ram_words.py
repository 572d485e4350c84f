"""The on-chip RAM of the TMC428: 6-bit cells, two to a register word, in datagrams and out of them.

Source: DS-TMC428 chapter 10, Table 10-1. A word's even cell is in bits 5..0, its odd cell in bits 13..8;
the rest of the 24 data bits means nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

CELLS = 64
"""Cells in each of the two areas."""
WORDS = 32
"""Register words in each of the two areas."""
CELL_MAX = 63

AREA_CHAIN = 0x40
"""First address (RRS as bit 6) of the driver chain configuration."""
AREA_TABLE = 0x60
"""First address (RRS as bit 6) of the microstep table."""


def whole_number(name: str, value: object, lowest: int, highest: int) -> int:
    """`value` as an int. Raises ValueError unless it is an integer (numpy's too) in lowest..highest."""
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | np.integer):
        raise ValueError(f"{name} is {value!r}, but has to be a whole number {lowest}..{highest}")  # noqa: TRY004
    if not lowest <= value <= highest:
        raise ValueError(f"{name} is {value}, allowed is {lowest}..{highest}")
    return int(value)


def pack_cells(cells: Sequence[int]) -> tuple[int, ...]:
    """Cells in the order of their RAM address to register words; an odd last cell is paired with 0.

    Raises ValueError for a cell outside 0..63.
    """
    checked = [whole_number(f"RAM cell {index}", cell, 0, CELL_MAX) for index, cell in enumerate(cells)]
    if len(checked) % 2:
        checked.append(0)
    return tuple(odd << 8 | even for even, odd in zip(checked[::2], checked[1::2], strict=True))


def unpack_words(words: Iterable[int]) -> tuple[int, ...]:
    """Register words to cells; bits that mean nothing may hold anything.

    Raises ValueError for a word that is not 24 bits.
    """
    cells: list[int] = []
    for index, word in enumerate(words):
        checked = whole_number(f"RAM word {index}", word, 0, 0xFF_FFFF)
        cells += [checked & CELL_MAX, checked >> 8 & CELL_MAX]
    return tuple(cells)


def write_datagrams(area: int, words: Sequence[int]) -> tuple[int, ...]:
    """The 32-bit datagrams that write `words` from the start of `area` on."""
    return tuple((area + index) << 25 | word for index, word in enumerate(words))
