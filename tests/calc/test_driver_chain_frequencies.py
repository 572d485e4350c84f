"""How fast a chain is: DS-TMC428 9.7 and 2.1."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.driver_chain.chain import build_chain, chain_frequencies, decode_chain

CLOCK_HZ = 16e6
THREE = build_chain(["tmc236"] * 3)


@pytest.mark.sheet("DS-TMC428", "2.1")
def test_three_drivers_of_16_bits_make_20_thousand_full_steps() -> None:
    chain = build_chain([{"signals": ["Zero"] * 16}] * 3)
    found = chain_frequencies(chain, CLOCK_HZ, clk2_div=7)
    assert found.spi_clock_hz == CLOCK_HZ / 16
    assert found.full_step_max_hz == pytest.approx(16e6 / 16 / (3 * 16))
    assert round(found.full_step_max_hz, -4) == 20_000


@pytest.mark.sheet("DS-TMC428", "9.7")
@pytest.mark.parametrize(("clk2_div", "clocks_per_bit"), [(7, 16), (8, 18), (15, 32), (255, 512)])
def test_spi_clock(clk2_div: int, clocks_per_bit: int) -> None:
    assert chain_frequencies(THREE, CLOCK_HZ, clk2_div).spi_clock_hz == CLOCK_HZ / clocks_per_bit


@pytest.mark.sheet("DS-TMC428", "9.7")
def test_the_example_of_three_drivers_of_12_bits_takes_41_clocks() -> None:
    found = chain_frequencies(THREE, CLOCK_HZ, clk2_div=7)
    assert (found.nxm_clocks, found.datagram_clocks) == (1, 41)
    assert found.datagram_hz == pytest.approx(1e6 / 41)


@pytest.mark.sheet("DS-TMC428", "9.7")
@pytest.mark.parametrize("clk2_div", [8, 15, 100, 255])
def test_above_7_each_nxm_bit_takes_one_and_a_half_clocks(clk2_div: int) -> None:
    found = chain_frequencies(THREE, CLOCK_HZ, clk2_div)
    assert (found.nxm_clocks, found.datagram_clocks) == (1.5, 1 + 3 * (12 + 1.5) + 1)
    assert found.datagram_hz == pytest.approx(CLOCK_HZ / (2 * (clk2_div + 1)) / 42.5)


@pytest.mark.sheet("DS-TMC428", "9.7")
@pytest.mark.parametrize("clk2_div", range(7))
def test_below_7_it_gets_no_faster_but_asymmetric(clk2_div: int) -> None:
    found, at_seven = (chain_frequencies(THREE, CLOCK_HZ, value) for value in (clk2_div, 7))
    assert found.clk2_div_effective == 7
    assert (found.spi_clock_hz, found.datagram_hz) == (at_seven.spi_clock_hz, at_seven.datagram_hz)
    assert any("asymmetric" in text for text in found.warnings)
    assert at_seven.warnings == ()


@pytest.mark.sheet("DS-TMC428", "9.7")
@pytest.mark.parametrize(
    ("ramp_divs", "expected_hz"),
    [
        ((0, 0, 0), 16e6 * 3 / 32768),
        ((5, 5, 5), 16e6 * 3 / 32 / 32768),
        ((0, 1, 2), 16e6 * 1.75 / 32768),
        ((13, 13, 13), 16e6 * 3 / 8192 / 32768),
    ],
)
def test_continuous_update(ramp_divs: tuple[int, int, int], expected_hz: float) -> None:
    assert chain_frequencies(THREE, CLOCK_HZ, 7, ramp_divs).continuous_update_hz == pytest.approx(expected_hz)


def test_without_ramp_divs_there_is_no_continuous_update() -> None:
    assert chain_frequencies(THREE, CLOCK_HZ, 7).continuous_update_hz is None


def test_updates_faster_than_the_chain_are_a_warning() -> None:
    assert any("continuous" in text for text in chain_frequencies(THREE, CLOCK_HZ, 255, (0, 0, 0)).warnings)
    assert chain_frequencies(THREE, CLOCK_HZ, 255, (3, 3, 3)).warnings == ()


@given(
    lengths=st.lists(st.integers(1, 21), min_size=1, max_size=3),
    clk2_div=st.integers(7, 255),
    clock_hz=st.floats(1e3, 32e6),
)
def test_a_chain_read_from_ram_is_as_fast_as_the_built_one(lengths: list[int], clk2_div: int, clock_hz: float) -> None:
    chain = build_chain([{"signals": ["Zero"] * length} for length in lengths])
    found = chain_frequencies(chain, clock_hz, clk2_div)
    assert found == chain_frequencies(decode_chain(chain.ram_words, chain.lsmd), clock_hz, clk2_div)
    assert found.datagram_hz < found.full_step_max_hz < found.spi_clock_hz or sum(lengths) == 1
    assert found.datagram_hz * found.datagram_clocks == pytest.approx(found.spi_clock_hz)


def test_an_endless_chain_has_no_frequencies() -> None:
    with pytest.raises(ValueError, match="never ends"):
        chain_frequencies(decode_chain([0] * 32, 0), CLOCK_HZ, 7)


@pytest.mark.parametrize(
    ("clock_hz", "clk2_div", "ramp_divs", "complaint"),
    [
        (0.0, 7, None, "clock_hz"),
        (-1.0, 7, None, "clock_hz"),
        (math.nan, 7, None, "clock_hz"),
        (math.inf, 7, None, "clock_hz"),
        (CLOCK_HZ, -1, None, r"clk2_div .*0\.\.255"),
        (CLOCK_HZ, 256, None, r"clk2_div .*0\.\.255"),
        (CLOCK_HZ, 7, (0, 0), "all 3 axes"),
        (CLOCK_HZ, 7, (0, 14, 0), r"ramp_div of axis 1 is 14, allowed is 0\.\.13"),
        (CLOCK_HZ, 7, (0, 0, -1), "ramp_div of axis 2"),
    ],
)
def test_out_of_range_is_refused(
    clock_hz: float, clk2_div: int, ramp_divs: tuple[int, ...] | None, complaint: str
) -> None:
    with pytest.raises(ValueError, match=complaint):
        chain_frequencies(THREE, clock_hz, clk2_div, ramp_divs)
