"""From RAM back to a table: round trips, noise, and what may be wrong with a chain."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.driver_chain.chain import KNOWN_DRIVERS, DriverSpec, build_chain, decode_chain
from app.calc.driver_chain.ram_words import pack_cells, unpack_words

MEANS_NOTHING = 0xFF_FFFF & ~0x3F3F

noise = st.lists(st.integers(0, 0xFF_FFFF), min_size=32, max_size=32)
drivers_lists = st.lists(
    st.one_of(
        st.builds(DriverSpec, st.sampled_from(sorted(KNOWN_DRIVERS)), st.booleans()),
        st.builds(
            lambda codes: DriverSpec("custom", signals=tuple(codes)),
            st.lists(st.integers(0, 31), min_size=1, max_size=21),
        ),
    ),
    min_size=1,
    max_size=3,
)


def sent_bits(cells: tuple[int, ...], lsmd: int, limit: int = 1000) -> int | None:
    """Bits that the chip sends, by walking as chapter 10 tells; None if it is still sending at `limit`."""
    motor = 0
    for bit in range(limit):
        if cells[bit % 64] & 0x20:
            if motor == lsmd:
                return bit + 1
            motor += 1
    return None


@given(drivers=drivers_lists, other=noise, behind=st.lists(st.integers(0, 63), min_size=64, max_size=64))
def test_a_chain_that_was_built_is_read_again(drivers: list[DriverSpec], other: list[int], behind: list[int]) -> None:
    chain = build_chain(drivers)
    # whatever stands in unused bits and behind the last NxM
    cells = chain.ram_cells[: chain.length_bits] + tuple(behind[chain.length_bits :])
    words = [word | bits & MEANS_NOTHING for word, bits in zip(pack_cells(cells), other, strict=True)]
    decoded = decode_chain(words, chain.lsmd)
    assert decoded.bits == chain.bits
    assert decoded.length_bits == chain.length_bits
    assert decoded.lsmd == chain.lsmd
    rebuilt = build_chain(decoded.drivers)
    assert (rebuilt.ram_words, rebuilt.lsmd) == (chain.ram_words, chain.lsmd)
    for before, after in zip(drivers, decoded.drivers, strict=True):
        if before.driver in KNOWN_DRIVERS:
            known = KNOWN_DRIVERS[before.driver]
            family = next(name for name, one in KNOWN_DRIVERS.items() if one.plain == known.plain)
            tells_decay = known.plain != known.fast_decay
            assert (after.driver, after.fast_decay) == (family, before.fast_decay and tells_decay)


@given(words=noise, lsmd=st.integers(0, 3))
def test_any_noise_has_the_length_that_the_chip_would_send(words: list[int], lsmd: int) -> None:
    decoded = decode_chain(words, lsmd)
    cells = unpack_words(words)
    assert decoded.length_bits == sent_bits(cells, lsmd)
    assert len(decoded.bits) == min(decoded.length_bits or 64, 64)
    assert tuple(bit.ram_data for bit in decoded.bits) == cells[: len(decoded.bits)]
    assert len(decoded.drivers) == sum(bit.next_motor for bit in decoded.bits)


@given(lsmd=st.integers(0, 3), ends=st.sets(st.integers(0, 63), max_size=5))
def test_findings_tell_endless_and_too_long_chains(lsmd: int, ends: set[int]) -> None:
    cells = [0x30 if address in ends else 0x10 for address in range(64)]
    decoded = decode_chain(pack_cells(cells), lsmd)
    kinds = {finding.kind for finding in decoded.findings}
    assert ("endless" in kinds) == (not ends) == (decoded.length_bits is None)
    assert ("few_nxm" in kinds) == (0 < len(ends) <= lsmd)
    assert ("over_64_bits" in kinds) == (decoded.length_bits is not None and decoded.length_bits > 64)
    assert ("status_cut" in kinds) == (decoded.length_bits is not None and 48 < decoded.length_bits <= 64)
    assert decoded.length_bits == sent_bits(tuple(cells), lsmd)


@pytest.mark.sheet("DS-TMC428", "11")
def test_without_nxm_the_chip_sends_endlessly() -> None:
    decoded = decode_chain([0x1111] * 32, 0)
    assert decoded.length_bits is None
    assert len(decoded.bits) == 64
    assert decoded.drivers == ()
    assert [finding.kind for finding in decoded.findings] == ["endless"]


@pytest.mark.sheet("DS-TMC428", "11")
def test_unused_codes_are_found_with_their_positions() -> None:
    cells = [0x14, 0x13, 0x1F, 0x31] + [0x15] * 60
    (finding,) = decode_chain(pack_cells(cells), 0).findings
    assert (finding.kind, finding.positions) == ("unused_codes", (0, 2))
    assert "sent as 1" in finding.text


@pytest.mark.sheet("DS-TMC428", "9.7")
def test_lsmd_three_is_not_allowed_by_table_9_2() -> None:
    decoded = decode_chain([0x3030] * 32, 3)
    assert [finding.kind for finding in decoded.findings] == ["lsmd_not_allowed"]
    assert decoded.length_bits == 4


@pytest.mark.sheet("DS-TMC428", "10")
def test_a_smaller_lsmd_ends_the_datagram_earlier() -> None:
    chain = build_chain(["tmc236", "tmc249", "tmc246"])
    assert [decode_chain(chain.ram_words, lsmd).length_bits for lsmd in range(3)] == [12, 24, 36]


def test_a_known_driver_is_recognised_with_its_bit_names() -> None:
    chain = build_chain([{"driver": "tmc249", "fast_decay": True}, {"signals": ["Step", "Direction"]}])
    decoded = decode_chain(chain.ram_words, chain.lsmd)
    assert decoded.drivers == (
        DriverSpec("tmc236", fast_decay=True),
        DriverSpec("custom", signals=("Step", "Direction")),
    )
    assert [bit.bit_name for bit in decoded.bits[:3]] == ["MDA", "CA3", "CA2"]
    assert [bit.bit_name for bit in decoded.bits[12:]] == ["", ""]


@pytest.mark.parametrize(
    ("words", "lsmd", "complaint"),
    [
        ([0] * 31, 0, "32 RAM words"),
        ([0] * 64, 0, "32 RAM words"),
        ([0] * 31 + [1 << 24], 0, "RAM word 31"),
        ([-1] + [0] * 31, 0, "RAM word 0"),
        ([0] * 32, 4, "lsmd"),
        ([0] * 32, -1, "lsmd"),
        ([0] * 32, True, "lsmd"),
    ],
)
def test_what_is_no_chain_is_refused(words: list[int], lsmd: int, complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        decode_chain(words, lsmd)
