"""The pair pmul/pdiv: the sheets' formulas and limits, every input against the plain loop, the candidates."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.calc.ramps.pmul_pdiv import a_max_lower_limit, a_max_upper_limit, default_reduction, design, design_many

dividers = st.integers(0, 13)
reductions = st.one_of(st.sampled_from([0.0, 0.01, 0.05]), st.floats(0, 0.99))


def program_of_chapter_19(a_max: int, ramp_div: int, pulse_div: int, reduction: float) -> tuple[int, int]:
    """The data sheet's program, DS-TMC428 chapter 19, in double precision: (p_mul, pdiv), (-1, -1) for none."""
    p_reduced = a_max / (128.0 * 2.0 ** (ramp_div - pulse_div)) * (1.0 - reduction)
    found = (-1, -1)
    for pdiv in range(14):
        pmul = int(p_reduced * 8.0 * 2.0**pdiv) - 128
        if 0 <= pmul <= 127:
            found = (pmul + 128, pdiv)
    return found


@pytest.mark.sheet("DS-TMC428", "19")
@pytest.mark.sheet("DS-TMC4210", "6.1.9.2.2")
@pytest.mark.parametrize("chip", ["tmc428", "tmc4210"])
def test_every_input_gives_the_pair_of_the_sheets_program(chip: str) -> None:
    reduction = default_reduction(chip)
    a_max, ramp_div, pulse_div = np.meshgrid(np.arange(1, 2048), np.arange(14), np.arange(14), indexing="ij")
    table = design_many(a_max, ramp_div, pulse_div, reduction)
    inputs = zip(a_max.ravel().tolist(), ramp_div.ravel().tolist(), pulse_div.ravel().tolist(), strict=True)
    expected = np.array([program_of_chapter_19(a, r, p, reduction) for a, r, p in inputs])
    assert np.array_equal(table.p_mul.ravel(), expected[:, 0])
    assert np.array_equal(table.pdiv.ravel(), expected[:, 1])
    found = table.pdiv >= 0
    assert 0.5 < found.mean() < 1  # both kinds are there to compare
    # a list of the same inputs, too short for the shortcut of very many inputs, gives the same rows
    part = slice(100, 150)
    short = design_many(a_max[part], ramp_div[part], pulse_div[part], reduction)
    for name in ("p_ideal", "p_reduced", "pmul", "p_mul", "pdiv", "p", "quality"):
        assert np.array_equal(getattr(short, name), getattr(table, name)[part], equal_nan=True), name
    assert np.array_equal(table.pmul[found], table.p_mul[found] - 128)
    assert np.all(table.pmul[~found] == -1)
    assert np.all(np.isnan(table.p[~found]))
    # q lies between what truncation of a mantissa of 128 may cost and the reduction itself
    assert table.quality[found].max() <= 1 - reduction
    assert table.quality[found].min() > (1 - reduction) * (1 - 1 / 128)


def test_the_vectorised_call_is_fifty_times_the_loop() -> None:
    a_max, ramp_div, pulse_div = np.meshgrid(np.arange(1, 2048), np.arange(14), np.arange(14), indexing="ij")
    vector_s = []
    for _ in range(5):
        begun = time.process_time()
        design_many(a_max, ramp_div, pulse_div, 0.05)
        vector_s.append(time.process_time() - begun)
    few = 4000
    chosen = np.random.default_rng(428).choice(a_max.size, few, replace=False)
    inputs = list(zip(*(each.ravel()[chosen].tolist() for each in (a_max, ramp_div, pulse_div)), strict=True))
    begun = time.process_time()
    for a, r, p in inputs:
        program_of_chapter_19(a, r, p, 0.05)
    loop_s = (time.process_time() - begun) * a_max.size / few
    # `make bench` reports the ratio itself; here half of it guards against a slip on a busy machine
    assert loop_s / min(vector_s) > 25


@settings(max_examples=200, deadline=None)
@given(a_max=st.integers(0, 2047), ramp_div=dividers, pulse_div=dividers, reduction=reductions)
def test_one_design_is_its_row_of_the_table(a_max: int, ramp_div: int, pulse_div: int, reduction: float) -> None:
    one = design("tmc428", a_max, ramp_div, pulse_div, reduction, evaluate=False)
    p_mul, pdiv = program_of_chapter_19(a_max, ramp_div, pulse_div, reduction)
    if pdiv < 0:
        assert (one.pmul, one.p_mul, one.pdiv, one.p, one.quality) == (None,) * 5
        assert one.warnings
        return
    assert (one.pmul, one.p_mul, one.pdiv) == (p_mul - 128, p_mul, pdiv)
    assert one.p == p_mul / 2 ** (3 + pdiv)
    assert one.quality == pytest.approx(p_mul / 2 ** (3 + pdiv) / one.p_ideal)
    assert one.candidates[0].p_mul == p_mul


@pytest.mark.sheet("DS-TMC428", "8.11")
@pytest.mark.sheet("DS-TMC4210", "6.1.9.1")
def test_p_is_a_max_by_128_and_the_divider_ratio() -> None:
    assert design("tmc428", 100, 5, 5, evaluate=False).p_ideal == 100 / 128
    assert design("tmc428", 100, 7, 5, evaluate=False).p_ideal == 100 / 128 / 4
    assert design("tmc4210", 100, 5, 7, evaluate=False).p_ideal == 100 / 128 * 4


@pytest.mark.sheet("DS-TMC428", "8.11.1")
def test_the_tmc428_takes_off_five_per_cent() -> None:
    # the program's own example: a_max 10, both dividers 3, 5 %: p*0.95*8*2^8 = 152
    found = design("tmc428", 10, 3, 3)
    assert found.p_reduced == pytest.approx(0.95 * 10 / 128)
    assert (found.pmul, found.p_mul, found.pdiv) == (24, 152, 8)
    assert found.quality == pytest.approx(0.95)


@pytest.mark.sheet("DS-TMC4210", "6.1.9.2")
def test_the_tmc4210_takes_off_one_per_cent() -> None:
    found = design("tmc4210", 100, 5, 5)
    assert found.p_reduced == pytest.approx(0.99 * 100 / 128)
    assert (found.p_mul, found.pdiv) == (198, 5)


@pytest.mark.sheet("DS-TMC4210", "6.1.9.1.1")
def test_a_pair_found_on_demand_is_the_one_of_the_table_of_each_acceleration() -> None:
    a_max = np.arange(10, 2048)
    table = design_many(a_max, 6, 5, default_reduction("tmc4210"))
    for a, p_mul, pdiv in zip(a_max.tolist(), table.p_mul.tolist(), table.pdiv.tolist(), strict=True):
        one = design("tmc4210", a, 6, 5, evaluate=False)
        assert (one.p_mul, one.pdiv) == (p_mul, pdiv), a
        assert 0.975 < (p_mul / 2 ** (3 + pdiv)) / (a / 256) <= 0.99, a


@pytest.mark.sheet("DS-TMC428", "8.10")
def test_both_countings_and_the_value_agree_in_every_candidate() -> None:
    for candidate in design("tmc428", 77, 4, 6, evaluate=False).candidates:
        assert candidate.p_mul == candidate.pmul + 128
        assert 0 <= candidate.pmul <= 127
        assert 0 <= candidate.pdiv <= 13
        assert candidate.p == candidate.p_mul / 2 ** (3 + candidate.pdiv)


@pytest.mark.sheet("DS-TMC428", "8.11")
@pytest.mark.sheet("DS-TMC4210", "6.1.9.2.1")
@settings(max_examples=100, deadline=None)
@given(a_max=st.integers(1, 2047), ramp_div=dividers, pulse_div=dividers)
def test_the_candidates_hold_every_pair_of_the_sheets_band(a_max: int, ramp_div: int, pulse_div: int) -> None:
    found = design("tmc428", a_max, ramp_div, pulse_div, evaluate=False)
    p = a_max / (128 * 2.0 ** (ramp_div - pulse_div))
    band = {
        (p_mul - 128, pdiv) for p_mul in range(128, 256) for pdiv in range(14) if 0.95 < p_mul / 2 ** (3 + pdiv) / p < 1
    }
    offered = [(candidate.pmul, candidate.pdiv) for candidate in found.candidates]
    assert band <= set(offered)
    assert len(offered) == len(set(offered))
    nearness = [abs(candidate.quality - 0.95) for candidate in found.candidates[1:]]
    assert nearness == sorted(nearness)
    if found.pmul:
        assert (found.pmul - 1, found.pdiv) in offered  # the sheets' way out of a one-step overshoot


@pytest.mark.sheet("DS-TMC428", "8.11")
def test_the_candidates_show_where_overshooting_begins() -> None:
    by_quality = sorted(design("tmc428", 100, 5, 5).candidates, key=lambda candidate: candidate.quality)
    assert all(candidate.overshoot_steps == 0 for candidate in by_quality if candidate.quality < 0.98)
    largest = by_quality[-1]
    assert largest.quality > 1
    assert largest.overshoot_steps is not None
    assert largest.overshoot_steps > 1
    moves = [candidate.move_s for candidate in by_quality if candidate.quality < 0.98 and candidate.move_s]
    assert moves == sorted(moves, reverse=True)  # too small a p brakes early and arrives late
    assert len(moves) >= 5


def test_a_candidate_that_never_settles_has_no_times() -> None:
    endless = [candidate for candidate in design("tmc428", 1024, 11, 0).candidates if candidate.move_s is None]
    assert endless
    assert all(candidate.settling_s is None and candidate.overshoot_steps for candidate in endless)


@pytest.mark.sheet("DS-TMC428", "8.7.1")
@pytest.mark.sheet("DS-TMC4210", "6.1.7.1.1")
def test_the_limits_of_a_max() -> None:
    for ramp_div in range(14):
        for pulse_div in range(14):
            difference = ramp_div - pulse_div
            lower = 2 ** (difference - 1) if difference - 1 > 0 else 1
            assert a_max_lower_limit(ramp_div, pulse_div) == lower
            assert a_max_lower_limit(ramp_div, pulse_div, 1449) == lower
            assert a_max_lower_limit(ramp_div, pulse_div, 1448) == max(1, lower // 2)
            upper = math.floor(2.0 ** (difference + 12)) - 1
            assert a_max_upper_limit(ramp_div, pulse_div) == max(0, upper)
            if abs(difference) <= 1:
                assert lower == 1
                assert upper >= 2047


@pytest.mark.sheet("DS-TMC428", "8.7.1")
@pytest.mark.sheet("DS-TMC4210", "6.1.7.1")
@pytest.mark.parametrize("chip", ["tmc428", "tmc4210"])
def test_within_the_limits_there_is_a_pair_for_every_a_max(chip: str) -> None:
    reduction = default_reduction(chip)
    for ramp_div in range(14):
        for pulse_div in range(14):
            low, high = a_max_lower_limit(ramp_div, pulse_div), min(2047, a_max_upper_limit(ramp_div, pulse_div))
            a_max = np.arange(low, high + 1)
            assert np.all(design_many(a_max, ramp_div, pulse_div, reduction).pdiv >= 0)


def test_outside_the_limits_is_said() -> None:
    below = design("tmc428", 15, 10, 5)
    assert any("below its lower limit 16" in warning for warning in below.warnings)
    assert not design("tmc428", 15, 10, 5, v_max=1448).warnings
    assert not design("tmc428", 1023, 3, 5).warnings
    above = design("tmc428", 600, 1, 5)
    assert any("above its upper limit 255" in warning for warning in above.warnings)


def test_no_pair_is_invented() -> None:
    small = design("tmc428", 1, 13, 0)
    assert (small.pmul, small.p_mul, small.pdiv, small.p, small.quality) == (None,) * 5
    assert any("no pair represents p" in warning and "below 1/512" in warning for warning in small.warnings)
    large = design("tmc428", 2047, 0, 13)
    assert large.pdiv is None
    assert large.candidates == ()
    assert any("32 or more" in warning for warning in large.warnings)


def test_no_acceleration_has_no_p() -> None:
    found = design("tmc428", 0, 3, 3)
    assert (found.p_ideal, found.p_reduced, found.pdiv, found.candidates) == (0.0, 0.0, None, ())
    assert found.warnings == ("a_max is 0: the velocity cannot change, so there is no p to represent",)


def test_bad_input_is_named_with_its_range() -> None:
    with pytest.raises(ValueError, match="chip is one of tmc428, tmc429, tmc4210, got 'tmc4361'"):
        design("tmc4361", 1, 1, 1)
    with pytest.raises(ValueError, match="a_max is a whole number of 0 to 2047"):
        design("tmc428", 2048, 1, 1)
    with pytest.raises(ValueError, match="ramp_div is a whole number of 0 to 13"):
        design("tmc428", 1, 14, 1)
    with pytest.raises(ValueError, match="pulse_div is a whole number of 0 to 13"):
        design("tmc428", 1, 1, -1)
    for reduction in (1.0, -0.01, math.nan):
        with pytest.raises(ValueError, match="reduction is 0 to less than 1"):
            design("tmc428", 1, 1, 1, reduction)
    with pytest.raises(ValueError, match="v_max is a whole number of 0 to 2047"):
        design("tmc428", 1, 1, 1, v_max=2048)
    with pytest.raises(ValueError, match="a_max is a whole number"):
        design_many(np.array([1.5]), 1, 1, 0.05)
    with pytest.raises(ValueError, match="clock_hz is above 0"):
        design("tmc428", 1, 1, 1, clock_hz=0)


def test_a_design_is_quick_enough_for_a_slider() -> None:
    design("tmc428", 100, 5, 5)  # compiles
    for a_max, ramp_div, pulse_div in ((1, 5, 5), (1, 1, 0), (2047, 13, 3), (700, 8, 8), (1024, 11, 0)):
        spent = []
        for _ in range(3):
            begun = time.process_time()
            design("tmc428", a_max, ramp_div, pulse_div)
            spent.append(time.process_time() - begun)
        assert min(spent) < 0.1
