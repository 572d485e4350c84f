"""csCommonIndividual: one chip select for a chain, or one for each driver (DS-TMC428 9.7)."""

from __future__ import annotations

import pytest

from app.emulators.tmc428.chain import Selects, reply_bits
from tests.emulators.harness import (
    COVER,
    COVER_DATAGRAM,
    GLOBAL,
    HIGH_WORD,
    LOW_WORD,
    Bench,
    free_bench,
)

INDIVIDUAL = 1 << 7
PARTS = [[1, 0] * 6, [1, 1, 0] * 4, [0, 1, 1, 1] * 3]
STATUSES = [0xABC, 0x123, 0xDEF]


def bits(word: int) -> list[int]:
    return [word >> bit & 1 for bit in range(11, -1, -1)]


def sent(parts: list[list[int]]) -> list[int]:
    return [bit for part in parts for bit in part]


@pytest.mark.sheet("DS-TMC428", "9.7")
def test_parts_of_as_many_bits_as_drivers_have_come_back_alike_either_way() -> None:
    chained = Selects(chip=False, board=False).reply(PARTS, STATUSES)
    assert chained == reply_bits(sent(PARTS), STATUSES)
    assert Selects(chip=True, board=True).reply(PARTS, STATUSES) == chained


@pytest.mark.sheet("DS-TMC428", "9.7")
def test_with_selects_of_their_own_longer_parts_come_back_driver_by_driver() -> None:
    longer = [[*part, 1, 0, 1, 0] for part in PARTS]
    found = Selects(chip=True, board=True).reply(longer, STATUSES)
    for driver, part in enumerate(longer):
        assert found[16 * driver : 16 * driver + 16] == [*bits(STATUSES[driver]), *part[:4]]
    # in a chain the first driver's bits push those of all others on
    assert Selects(chip=False, board=False).reply(longer, STATUSES) == [
        *sent([bits(s) for s in STATUSES]),
        *sent(longer)[:12],
    ]


@pytest.mark.sheet("DS-TMC428", "9.7")
def test_where_board_and_chip_differ_only_the_first_select_counts() -> None:
    assert Selects(chip=False, board=True).reply(PARTS, STATUSES) == [*bits(STATUSES[0]), *sent(PARTS)[:24]]
    assert Selects(chip=True, board=False).reply(PARTS, STATUSES) == [*bits(STATUSES[0]), *[0] * 24]
    assert not Selects(chip=True, board=False).fit


def replied(bench: Bench) -> int:
    bench.write(COVER, 0)
    bench.write(COVER_DATAGRAM, 0)
    bench.seconds(0.01)
    # the 36 bits of one datagram; what came before is still above them
    return (bench.read(HIGH_WORD) << 24 | bench.read(LOW_WORD)) & (1 << 36) - 1


@pytest.mark.sheet("DS-TMC428", "9.7")
@pytest.mark.parametrize("wired", ["common", "individual"])
def test_the_emulated_chip_reads_its_drivers_as_board_and_bit_have_it(wired: str) -> None:
    bench = free_bench(chip_selects=wired)
    bench.patch(drivers=[{"axis": axis, "status": status} for axis, status in enumerate((0x101, 0x102, 0x104))])
    for bit in (0, INDIVIDUAL):
        bench.three_drivers(0x702 | bit)
        fits = (bit != 0) == (wired == "individual")
        word = replied(bench)
        assert (word == 0x101_102_104) == fits
        assert word >> 24 == 0x101
        assert [driver.selected for driver in bench.chain().drivers] == [fits] * 3


@pytest.mark.sheet("DS-TMC428", "9.7")
def test_individual_selects_are_low_active_whatever_the_polarity_bit_says() -> None:
    """nSCS_S drives the 74HC157 too: with a select that is high at rest, left and right switches keep their places."""
    levels = []
    for bits_ in (INDIVIDUAL, INDIVIDUAL | 1 << 2, 0, 1 << 2):
        bench = free_bench(chip_selects="individual" if bits_ & INDIVIDUAL else "common")
        bench.three_drivers(0x702 | 1 << 16 | 1 << 20 | bits_)
        bench.switch(0, left=True)
        bench.seconds(0.5)
        levels.append(bench.read(0x3E) & 3)
    assert levels[0] == levels[1] == levels[2]
    assert levels[3] != levels[2]


def test_the_register_reads_back_the_bit() -> None:
    bench = free_bench()
    bench.write(GLOBAL, 0x702 | INDIVIDUAL)
    assert bench.read(GLOBAL) & INDIVIDUAL
