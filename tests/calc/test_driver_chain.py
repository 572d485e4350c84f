"""Building a driver chain: DS-TMC428 chapter 11, Tables 11-1 to 11-3."""

from __future__ import annotations

from collections.abc import Mapping

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.driver_chain.chain import (
    KNOWN_DRIVERS,
    DriverSpec,
    Signal,
    build_chain,
    signal_code,
    signal_name,
)
from app.calc.driver_chain.ram_words import unpack_words

TABLE_11_1 = """
DAC_A_0 00  DAC_A_1 01  DAC_A_2 02  DAC_A_3 03  DAC_A_4 04  DAC_A_5 05  PH_A 06  FD_A 07
DAC_B_0 08  DAC_B_1 09  DAC_B_2 0A  DAC_B_3 0B  DAC_B_4 0C  DAC_B_5 0D  PH_B 0E  FD_B 0F
Zero 10  One 11  Direction 12  Step 13
"""

# position, NxM, signal code, RAM address, RAM data, signal, bit of the driver
TABLE_11_2 = """
 0 0 10 00 10 Zero    MDA | 12 0 10 0C 10 Zero    MDA | 24 0 07 18 07 FD_A    MDA
 1 0 05 01 05 DAC_A_5 CA3 | 13 0 05 0D 05 DAC_A_5 CA3 | 25 0 05 19 05 DAC_A_5 CA3
 2 0 04 02 04 DAC_A_4 CA2 | 14 0 04 0E 04 DAC_A_4 CA2 | 26 0 04 1A 04 DAC_A_4 CA2
 3 0 03 03 03 DAC_A_3 CA1 | 15 0 03 0F 03 DAC_A_3 CA1 | 27 0 03 1B 03 DAC_A_3 CA1
 4 0 02 04 02 DAC_A_2 CA0 | 16 0 02 10 02 DAC_A_2 CA0 | 28 0 02 1C 02 DAC_A_2 CA0
 5 0 06 05 06 PH_A    PHA | 17 0 06 11 06 PH_A    PHA | 29 0 06 1D 06 PH_A    PHA
 6 0 10 06 10 Zero    MDB | 18 0 10 12 10 Zero    MDB | 30 0 0F 1E 0F FD_B    MDB
 7 0 0D 07 0D DAC_B_5 CB3 | 19 0 0D 13 0D DAC_B_5 CB3 | 31 0 0D 1F 0D DAC_B_5 CB3
 8 0 0C 08 0C DAC_B_4 CB2 | 20 0 0C 14 0C DAC_B_4 CB2 | 32 0 0C 20 0C DAC_B_4 CB2
 9 0 0B 09 0B DAC_B_3 CB1 | 21 0 0B 15 0B DAC_B_3 CB1 | 33 0 0B 21 0B DAC_B_3 CB1
10 0 0A 0A 0A DAC_B_2 CB0 | 22 0 0A 16 0A DAC_B_2 CB0 | 34 0 0A 22 0A DAC_B_2 CB0
11 1 0E 0B 2E PH_B    PHB | 23 1 0E 17 2E PH_B    PHB | 35 1 0E 23 2E PH_B    PHB
"""

TABLE_11_3 = """
80000510 82000304 84000602 86000D10 88000B0C 8A002E0A 8C000510 8E000304 90000602
92000D10 94000B0C 96002E0A 98000507 9A000304 9C000602 9E000D0F A0000B0C A2002E0A
"""

EXAMPLE: list[str | Mapping[str, object]] = ["tmc236", "tmc236", {"driver": "tmc236", "fast_decay": True}]
"""The chain of section 11.2: fast decay is used by the third driver only."""


@pytest.mark.sheet("DS-TMC428", "11")
def test_signal_codes_of_table_11_1() -> None:
    words = TABLE_11_1.split()
    table = dict(zip(words[::2], (int(code, 16) for code in words[1::2]), strict=True))
    assert {signal.name: int(signal) for signal in Signal} == table
    for name, code in table.items():
        assert signal_code(name) == signal_code(name.upper()) == signal_code(code) == code
        assert signal_code(f"${code:02X}") == signal_code(f"0x{code:x}") == signal_code(str(code)) == code
        assert signal_name(code) == name


@pytest.mark.sheet("DS-TMC428", "11")
@pytest.mark.parametrize("code", range(0x14, 0x20))
def test_the_rest_of_table_11_1_has_no_signal(code: int) -> None:
    assert signal_code(signal_name(code)) == code
    chain = build_chain([{"driver": "custom", "signals": [code, "One"]}])
    assert chain.bits[0].signal == f"unused_{code:02X}"
    assert any(f"{code:#04x}" in text for text in chain.warnings)


@pytest.mark.sheet("DS-TMC428", "11.2")
@pytest.mark.parametrize("family_member", ["tmc236", "tmc239", "tmc246", "tmc249", "TMC249"])
def test_the_example_is_table_11_2(family_member: str) -> None:
    chain = build_chain([family_member, family_member, {"driver": family_member, "fast_decay": True}])
    rows = [row.split() for line in TABLE_11_2.strip().splitlines() for row in line.split("|")]
    expected = {
        (
            int(position),
            int(position) // 12,
            bool(int(nxm)),
            int(code, 16),
            int(address, 16),
            int(data, 16),
            signal,
            bit,
        )
        for position, nxm, code, address, data, signal, bit in rows
    }
    assert len(expected) == chain.length_bits == len(chain.bits) == 36
    assert expected == {
        (bit.position, bit.motor, bit.next_motor, bit.code, bit.ram_address, bit.ram_data, bit.signal, bit.bit_name)
        for bit in chain.bits
    }
    assert chain.lsmd == 0b10
    assert chain.warnings == ()


@pytest.mark.sheet("DS-TMC428", "11.2")
def test_the_example_goes_out_as_table_11_3() -> None:
    assert [f"{word:08X}" for word in build_chain(EXAMPLE).datagrams] == TABLE_11_3.split()


@pytest.mark.sheet("DS-TMC428", "10")
def test_ram_words_hold_the_even_cell_low_and_the_odd_cell_high() -> None:
    chain = build_chain(EXAMPLE)
    assert chain.ram_words[:6] == (0x0510, 0x0304, 0x0602, 0x0D10, 0x0B0C, 0x2E0A)
    assert chain.ram_words[18:] == (0,) * 14
    assert unpack_words(chain.ram_words) == chain.ram_cells
    assert len(chain.ram_words) == 32


@pytest.mark.sheet("DS-TMC428", "9.7")
@pytest.mark.parametrize(("drivers", "lsmd"), [(1, 0b00), (2, 0b01), (3, 0b10)])
def test_lsmd_of_table_9_2(drivers: int, lsmd: int) -> None:
    assert build_chain(["tmc249"] * drivers).lsmd == lsmd


def test_signals_may_be_names_or_numbers_with_bit_names() -> None:
    spec = {"driver": "custom", "signals": ["Zero", 0x13, "$12", "dac_a_5"], "bit_names": ["EN", "STEP", "DIR", "REF"]}
    chain = build_chain([spec])
    assert [bit.signal for bit in chain.bits] == ["Zero", "Step", "Direction", "DAC_A_5"]
    assert [bit.bit_name for bit in chain.bits] == ["EN", "STEP", "DIR", "REF"]
    assert chain.ram_cells[:5] == (0x10, 0x13, 0x12, 0x25, 0)
    assert chain == build_chain(
        [DriverSpec("custom", signals=("Zero", 0x13, "$12", "dac_a_5"), bit_names=("EN", "STEP", "DIR", "REF"))]
    )
    assert chain == build_chain([{key: value for key, value in spec.items() if key != "driver"}])


def test_an_odd_chain_pairs_its_last_cell_with_zero() -> None:
    chain = build_chain([{"driver": "custom", "signals": ["One", "Step", "Zero"]}])
    assert [f"{word:08X}" for word in chain.datagrams] == ["80001311", "82000030"]


signals = st.lists(st.integers(0, 31), min_size=1, max_size=21)
specs = st.one_of(
    st.builds(DriverSpec, st.sampled_from(sorted(KNOWN_DRIVERS)), st.booleans()),
    st.builds(lambda codes: DriverSpec("custom", signals=tuple(codes)), signals),
)


@given(drivers=st.lists(specs, min_size=1, max_size=3))
def test_every_chain_has_one_nxm_a_driver_at_its_last_bit(drivers: list[DriverSpec]) -> None:
    chain = build_chain(drivers)
    assert sum(bit.next_motor for bit in chain.bits) == len(drivers) == chain.lsmd + 1
    assert chain.bits[-1].next_motor
    assert (
        [bit.position for bit in chain.bits]
        == [bit.ram_address for bit in chain.bits]
        == list(range(chain.length_bits))
    )
    assert [bit.motor for bit in chain.bits] == sorted(bit.motor for bit in chain.bits)
    assert chain.ram_cells[: chain.length_bits] == tuple(bit.code | bit.next_motor << 5 for bit in chain.bits)
    assert not any(chain.ram_cells[chain.length_bits :])
    written = enumerate(chain.ram_words[: len(chain.datagrams)])
    assert chain.datagrams == tuple((0x40 + index) << 25 | word for index, word in written)
    assert len(chain.datagrams) == (chain.length_bits + 1) // 2


def test_64_bits_fit_and_65_do_not() -> None:
    full = build_chain([{"driver": "custom", "signals": ["Zero"] * 40}, "tmc236", "tmc236"])
    assert full.length_bits == len(full.ram_cells) == 64
    assert any("last 48" in text for text in full.warnings)
    with pytest.raises(ValueError, match="65 bits"):
        build_chain([{"driver": "custom", "signals": ["Zero"] * 41}, "tmc236", "tmc236"])
    with pytest.raises(ValueError, match="65 bits"):
        build_chain([{"driver": "custom", "signals": ["Zero"] * 65}])


@pytest.mark.sheet("DS-TMC428", "2.2")
@pytest.mark.parametrize(("extra", "warned"), [(24, False), (25, True)])
def test_more_than_48_bits_lose_status(extra: int, warned: bool) -> None:
    chain = build_chain(["tmc246", "tmc246", {"driver": "custom", "signals": ["Zero"] * extra}])
    assert any("last 48" in text for text in chain.warnings) == warned


@pytest.mark.parametrize("count", [0, 4])
def test_a_chain_has_one_to_three_drivers(count: int) -> None:
    with pytest.raises(ValueError, match=rf"1\.\.3 drivers, not {count}"):
        build_chain(["tmc236"] * count)


def test_an_unknown_driver_is_answered_with_the_known_ones() -> None:
    with pytest.raises(
        ValueError, match="'tmc2100'; known: tmc236, tmc239, tmc246, tmc249, tmc260, tmc261, tmc262, tmc2660, custom"
    ):
        build_chain(["tmc236", "tmc2100"])


@pytest.mark.parametrize(
    ("spec", "complaint"),
    [
        ({"driver": "custom", "signals": ["DAC_A_6"]}, "no signal is called 'DAC_A_6'; known: DAC_A_0, .*Step"),
        ({"driver": "custom", "signals": [32]}, r"signal code is 32, allowed is 0\.\.31"),
        ({"driver": "custom", "signals": [-1]}, r"allowed is 0\.\.31"),
        ({"driver": "custom", "signals": ["0x20"]}, r"allowed is 0\.\.31"),
        ({"driver": "custom", "signals": ["$"]}, "no signal"),
        ({"driver": "custom", "signals": [True]}, "not True"),
        ({"driver": "custom", "signals": [1.0]}, "not 1.0"),
        ({"driver": "custom", "signals": "Zero"}, "list"),
        ({"driver": "custom", "signals": []}, "needs a list"),
        ({"driver": "custom"}, "needs a list"),
        ({"driver": "custom", "signals": ["FD_A"], "fast_decay": True}, "known drivers"),
        ({"driver": "custom", "signals": ["Zero", "One"], "bit_names": ["A"]}, "2 bits, but 1 bit names"),
        ({"driver": "custom", "signals": ["Zero"], "bit_names": [1]}, "list of text"),
        ({"driver": "tmc236", "signals": ["Zero"]}, "'custom'"),
        ({"driver": "tmc236", "fast_decay": 1}, "true or false"),
        ({"driver": "tmc236", "decay": True}, "not decay"),
        ({"driver": 236}, "text, not 236"),
        ({"fast_decay": True}, "text, not None"),
        (236, "name or a mapping"),
        (None, "name or a mapping"),
    ],
)
def test_what_is_no_driver_is_refused(spec: str | Mapping[str, object], complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        build_chain([spec])
