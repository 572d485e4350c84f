"""Waves from formulas, and what they do: shapes that are known otherwise, laws of thumb, and figures."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.microsteps.mslut import POWER_ON, Wave, decode, encode, refusals
from app.calc.microsteps.mslut_metrics import MslutMetrics, mslut_metrics
from app.calc.microsteps.mslut_waves import GRIDS, Formula, Grid, Term, exponent_of_thousandths, wanted_wave
from app.calc.microsteps.shapes import f_sigma

HALF_STEPS = (np.arange(256) + 0.5) / 256
grids = st.sampled_from(GRIDS)


def figures(formula: Formula) -> MslutMetrics:
    wanted = wanted_wave(formula)
    return mslut_metrics(wanted.wave, wanted.ideal)


def order(metrics: MslutMetrics, wanted: int) -> float:
    assert metrics.angle_orders is not None
    return next(part.amplitude_deg for part in metrics.angle_orders if part.order == wanted)


def test_without_anything_it_is_the_power_on_wave() -> None:
    assert wanted_wave(Formula()).wave == decode(POWER_ON)


@pytest.mark.parametrize("thousandths", [30, 50, 100, 200])
def test_the_linearity_correction_is_the_firmwares(thousandths: int) -> None:
    wave = wanted_wave(Formula(exponent=exponent_of_thousandths(thousandths), grid="whole_step")).wave
    factor = 1 + thousandths / 1000
    assert list(wave.values) == [int(247 * math.sin(2 * math.pi * i / 1024) ** factor + 0.5) for i in range(256)]
    assert wave.mirror == 0


@given(sigma=st.floats(-1, 1), amplitude=st.floats(10, 255))
def test_sigma_is_that_of_the_smaller_table(sigma: float, amplitude: float) -> None:
    wanted = wanted_wave(Formula(sigma=sigma, amplitude=amplitude, grid="opposite"))
    assert wanted.ideal is not None
    np.testing.assert_allclose(wanted.ideal, amplitude * f_sigma(HALF_STEPS, sigma), atol=1e-9)


def test_every_sigma_wave_comes_back_exactly() -> None:
    for hundredths in range(-100, 101):
        for grid in GRIDS:
            for full_scale in (False, True):
                wave = wanted_wave(Formula(sigma=hundredths / 100, grid=grid, full_scale=full_scale)).wave
                assert decode(encode(wave.values, wave.mirror)) == wave


@pytest.mark.parametrize("grid", GRIDS)
def test_every_linearity_correction_fits_every_grid(grid: Grid) -> None:
    for thousandths in range(30, 201):
        wave = wanted_wave(Formula(exponent=1 + thousandths / 1000, grid=grid)).wave
        assert decode(encode(wave.values, wave.mirror)) == wave


@given(
    sigma=st.floats(-1, 1),
    exponent=st.floats(0.2, 5),
    third=st.floats(-1, 1),
    fourth=st.floats(-45, 45),
    amplitude=st.floats(1, 400),
    grid=grids,
)
def test_every_wave_is_encoded_exactly_or_refused_with_a_place(
    sigma: float, exponent: float, third: float, fourth: float, amplitude: float, grid: Grid
) -> None:
    wanted = wanted_wave(Formula(sigma, exponent, (Term(3, third),), (Term(4, fourth),), amplitude, grid=grid))
    assert wanted.refusal is None
    found = next(refusals(wanted.wave), None)
    if found is None:
        assert decode(encode(wanted.wave.values, wanted.wave.mirror)) == wanted.wave
    else:
        with pytest.raises(ValueError, match=f"entry {found.index}: "):
            encode(wanted.wave.values, wanted.wave.mirror)


def test_the_power_on_wave_has_the_figures_that_are_known_of_it() -> None:
    metrics = mslut_metrics(decode(POWER_ON))
    assert metrics.angle_error_max_deg == pytest.approx(0.218, abs=5e-4)
    assert metrics.angle_error_max_microsteps == pytest.approx(0.62, abs=5e-3)
    assert metrics.angle_error_rms_deg == pytest.approx(0.093, abs=5e-4)
    assert metrics.angle_error_rms_microsteps == pytest.approx(0.26, abs=5e-3)
    assert metrics.amplitude_min == pytest.approx(246.8, abs=0.05)
    assert metrics.amplitude_max == pytest.approx(247.9, abs=0.05)
    assert metrics.quantisation_max is None


@pytest.mark.parametrize(
    ("exponent", "fourth_deg", "eighth_deg", "least"),
    [
        (1.03, -0.57, -0.11, 0.990),
        (1.05, -0.94, -0.17, 0.983),
        (1.10, -1.83, -0.32, 0.966),
        (1.15, -2.69, -0.43, 0.949),
        (1.20, -3.51, -0.51, 0.933),
    ],
)
def test_the_sine_power_wave_turns_the_field_as_computed_without_rounding(
    exponent: float, fourth_deg: float, eighth_deg: float, least: float
) -> None:
    # the unrounded law's figures; on half steps and opposite halves rounding leaves them but for hundredths
    metrics = figures(Formula(exponent=exponent, grid="opposite"))
    assert order(metrics, 4) == pytest.approx(fourth_deg, abs=0.02)
    assert order(metrics, 8) == pytest.approx(eighth_deg, abs=0.02)
    assert metrics.amplitude_min / metrics.amplitude_max == pytest.approx(least, abs=0.006)


@given(ripple=st.floats(0.005, 0.05))
def test_an_exponent_of_one_plus_three_r_cancels_a_fourth_order_disturbance(ripple: float) -> None:
    metrics = figures(Formula(exponent=1 + 3 * ripple, grid="opposite"))
    assert order(metrics, 4) == pytest.approx(-math.degrees(ripple), rel=0.08, abs=0.03)


@given(degrees=st.floats(-5, 5), which=st.sampled_from([4, 8]))
def test_a_correction_turns_the_field_by_itself_and_leaves_its_length(degrees: float, which: int) -> None:
    metrics = figures(Formula(corrections=(Term(which, degrees),), grid="opposite"))
    assert order(metrics, which) == pytest.approx(degrees, abs=0.05)
    assert metrics.torque_ripple is not None
    assert metrics.torque_ripple < 0.01


@given(share=st.floats(-0.1, 0.1), which=st.sampled_from([3, 5, 7]))
def test_a_harmonic_is_in_the_current_as_it_was_asked_for(share: float, which: int) -> None:
    metrics = figures(Formula(harmonics=(Term(which, share),), amplitude=200, grid="opposite"))
    assert metrics.harmonics is not None
    assert metrics.harmonics[which - 1] == pytest.approx(abs(share), abs=0.003)


def test_phase_180_is_a_harmonic_turned_over() -> None:
    over, under = Formula(harmonics=(Term(3, 0.05, 180.0),)), Formula(harmonics=(Term(3, -0.05),))
    assert wanted_wave(over).wave == wanted_wave(under).wave
    assert wanted_wave(over).refusal is None


def test_a_phase_between_cannot_be_in_a_quarter_wave_and_its_symmetric_part_is_kept() -> None:
    wanted = wanted_wave(Formula(harmonics=(Term(3, 0.05, 60.0),), grid="opposite"))
    assert wanted.refusal is not None
    assert wanted.refusal.reason == "asymmetric"
    assert "0 or 180" in wanted.refusal.detail
    half = wanted_wave(Formula(harmonics=(Term(3, 0.025),), grid="opposite"))
    assert wanted.ideal is not None
    assert half.ideal is not None
    np.testing.assert_allclose(wanted.ideal, half.ideal, atol=1e-9)


def test_rounding_is_within_half_a_count() -> None:
    for formula in (Formula(), Formula(exponent=1.1, grid="whole_step"), Formula(sigma=0.5)):
        metrics = figures(formula)
        assert metrics.quantisation_max is not None
        assert metrics.quantisation_max <= 0.5
        assert metrics.quantisation_rms == pytest.approx(1 / math.sqrt(12), abs=0.05)


def test_the_angle_error_repeats_every_quarter_and_is_odd() -> None:
    metrics = figures(Formula(sigma=0.3))
    assert metrics.angle_error_deg is not None
    error = np.asarray(metrics.angle_error_deg)
    np.testing.assert_allclose(error, -error[::-1], atol=1e-9)


def test_an_opposite_half_is_truer_than_the_complement() -> None:
    power_on, opposite = figures(Formula()), figures(Formula(grid="opposite"))
    assert power_on.angle_error_rms_deg is not None
    assert opposite.angle_error_rms_deg is not None
    assert opposite.angle_error_rms_deg < power_on.angle_error_rms_deg


def test_a_wave_without_current_has_no_angle() -> None:
    metrics = mslut_metrics(Wave((0,) * 256, 0))
    assert metrics.angle_error_deg is None
    assert metrics.torque_ripple is None
    assert metrics.harmonics is None
    assert any("neither phase" in warning for warning in metrics.warnings)


def test_a_table_that_goes_backwards_says_so() -> None:
    values = list(decode(POWER_ON).values)
    values[40:44] = [values[40], values[40] - 1, values[40] - 2, values[40] - 3]
    assert any("backwards" in warning for warning in mslut_metrics(Wave(tuple(values), 0)).warnings)


def test_a_peak_beyond_the_headroom_and_an_unusual_exponent_are_told() -> None:
    loud = wanted_wave(Formula(amplitude=254, exponent=1.3))
    assert any("headroom" in warning for warning in loud.warnings)
    assert any("1.03 to 1.2" in warning for warning in loud.warnings)
    assert any("headroom" in warning for warning in mslut_metrics(loud.wave).warnings)
    assert wanted_wave(Formula(exponent=1.2)).warnings == ()


@pytest.mark.parametrize(
    "formula",
    [
        Formula(sigma=1.01),
        Formula(sigma=math.nan),
        Formula(exponent=0.1),
        Formula(exponent=math.nan),
        Formula(amplitude=0),
        Formula(amplitude=401),
        Formula(harmonics=(Term(2, 0.1),)),
        Formula(harmonics=(Term(3, 1.5),)),
        Formula(harmonics=(Term(3, 0.1, math.inf),)),
        Formula(corrections=(Term(3, 0.1),)),
        Formula(corrections=(Term(4, 46),)),
        Formula(grid="half"),  # type: ignore[arg-type]
    ],
)
def test_numbers_out_of_range_are_errors(formula: Formula) -> None:
    with pytest.raises(ValueError, match=r"allowed|can hold|known|shape"):
        wanted_wave(formula)


def test_an_ideal_of_another_length_is_an_error() -> None:
    with pytest.raises(ValueError, match="256 values"):
        mslut_metrics(decode(POWER_ON), [0.0] * 255)
