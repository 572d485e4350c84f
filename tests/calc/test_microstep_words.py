"""A microstep table as RAM words and datagrams (DS-TMC428 Tables 12-1 and 12-2), there and back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.microsteps.table import (
    checked_values,
    design_table,
    table_datagrams,
    table_ram_words,
    values_from_ram_words,
)

TABLE_12_2 = """
C0000200 C2000503 C4000806 C6000B09 C8000E0C CA001110 CC001413 CE001716
D0001A18 D2001D1B D400201E D6002221 D8002524 DA002726 DC002A29 DE002C2B
E0002E2D E200302F E4003231 E6003433 E8003635 EA003837 EC003938 EE003B3A
F0003C3B F2003D3C F4003E3D F6003E3E F8003F3F FA003F3F FC003F3F FE003F3F
"""

tables = st.lists(st.integers(0, 63), min_size=64, max_size=64)


@pytest.mark.sheet("DS-TMC428", "12")
def test_the_sine_table_goes_out_as_table_12_2() -> None:
    assert [f"{word:08X}" for word in table_datagrams(design_table().values)] == TABLE_12_2.split()


@pytest.mark.sheet("DS-TMC428", "12")
@pytest.mark.parametrize(
    ("word", "odd", "even"),
    [(0, 2, 0), (1, 5, 3), (2, 8, 6), (3, 11, 9), (4, 14, 12), (27, 62, 62), (28, 63, 63), (31, 63, 63)],
)
def test_rows_of_table_12_1(word: int, odd: int, even: int) -> None:
    assert table_datagrams(design_table().values)[word] == 0b11 << 30 | word << 25 | odd << 8 | even


def values_written(datagrams: Sequence[int]) -> tuple[int, ...]:
    """What the datagrams write, in whatever order they come."""
    words = {datagram >> 25 & 31: datagram & 0xFF_FFFF for datagram in datagrams}
    return values_from_ram_words([words[index] for index in range(32)])


@pytest.mark.sheet("DS-TMC428", "12")
def test_table_12_2_reads_back_as_the_sine_table() -> None:
    words = [int(word, 16) for word in TABLE_12_2.split()]
    assert values_written(words) == design_table().values


@given(
    values=tables, noise=st.lists(st.integers(0, 0xFF_FFFF), min_size=32, max_size=32), order=st.permutations(range(32))
)
def test_every_table_survives_words_and_datagrams(values: list[int], noise: list[int], order: Sequence[int]) -> None:
    bits_that_mean_nothing = 0xFF_FFFF & ~0x3F3F
    words = [word | other & bits_that_mean_nothing for word, other in zip(table_ram_words(values), noise, strict=True)]
    assert values_from_ram_words(words) == tuple(values)
    datagrams = [
        word | other & bits_that_mean_nothing for word, other in zip(table_datagrams(values), noise, strict=True)
    ]
    assert values_written([datagrams[index] for index in order]) == tuple(values)


@given(values=tables)
def test_datagrams_write_each_ram_address_of_the_table_once(values: list[int]) -> None:
    datagrams = table_datagrams(values)
    assert [word >> 25 for word in datagrams] == list(range(0x60, 0x80))
    assert not any(word >> 24 & 1 for word in datagrams)


def test_numpy_integers_are_whole_numbers() -> None:
    values = np.arange(64)
    assert checked_values(values.tolist()) == checked_values(list(values)) == tuple(range(64))


@pytest.mark.parametrize("length", [0, 63, 65])
def test_another_length_is_refused(length: int) -> None:
    with pytest.raises(ValueError, match=f"64 values, this one has {length}"):
        table_datagrams([0] * length)


@pytest.mark.parametrize("value", [-1, 64, 1.0, 0.5, float("nan"), True, "1", None])
def test_a_value_that_is_no_dac_count_is_refused_with_its_place(value: object) -> None:
    values: list[object] = [0] * 64
    values[17] = value
    with pytest.raises(ValueError, match=r"table value 17 is .*0\.\.63"):
        checked_values(values)  # type: ignore[arg-type]


@pytest.mark.parametrize("words", [[0] * 31, [0] * 33, []])
def test_another_number_of_ram_words_is_refused(words: list[int]) -> None:
    with pytest.raises(ValueError, match="32 RAM words"):
        values_from_ram_words(words)


@pytest.mark.parametrize("word", [-1, 1 << 24])
def test_a_ram_word_beyond_24_bits_is_refused(word: int) -> None:
    with pytest.raises(ValueError, match="RAM word 31"):
        values_from_ram_words([0] * 31 + [word])
