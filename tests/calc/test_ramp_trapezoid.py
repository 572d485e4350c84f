"""The ideal trapezoid against numerical integration of its own acceleration, and its limiting cases."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.ramps.pmul_pdiv import design
from app.calc.ramps.ticked import RampParameters, exact_ramp
from app.calc.ramps.trapezoid import trapezoid_ramp
from app.calc.units.tmc428 import acceleration_hz_s, pulse_rate_hz

rates = st.floats(1.0, 1e6)


@given(v_max=rates, a_max=rates, d_max=rates, distance=st.floats(-1e7, 1e7).filter(lambda x: abs(x) > 1e-3))
def test_integrating_the_acceleration_gives_velocity_and_position(
    v_max: float, a_max: float, d_max: float, distance: float
) -> None:
    curve = trapezoid_ramp(v_max, a_max, d_max, distance, samples=2001)
    # Midpoint steps are exact but for the two intervals in which the acceleration changes.
    step = np.diff(curve.time_s)
    velocity = np.concatenate([[0.0], np.cumsum(step * curve.acceleration_pps2[:-1])])
    position = np.concatenate([[0.0], np.cumsum(step * (curve.velocity_pps[1:] + curve.velocity_pps[:-1]) / 2)])
    worst = 2 * max(a_max, d_max) * step.max()
    assert np.abs(velocity - curve.velocity_pps).max() <= worst + 1e-6 * v_max
    assert np.abs(position - curve.position).max() <= worst * step.max() + 1e-9 * abs(distance)


@given(v_max=rates, a_max=rates, d_max=rates, distance=st.floats(-1e7, 1e7))
def test_the_move_ends_at_rest_on_the_target_within_its_limits(
    v_max: float, a_max: float, d_max: float, distance: float
) -> None:
    curve = trapezoid_ramp(v_max, a_max, d_max, distance, samples=101)
    assert curve.position[-1] == distance
    assert curve.velocity_pps[-1] == 0
    assert np.abs(curve.velocity_pps).max() <= v_max * (1 + 1e-9)
    assert np.all(np.diff(curve.position) * math.copysign(1, distance) >= -1e-9 * abs(distance))
    assert curve.time_s[-1] == curve.duration_s


@given(v_max=rates, a_max=rates, d_max=rates, distance=st.floats(1e-3, 1e7))
def test_exchanged_rates_run_the_film_backwards(v_max: float, a_max: float, d_max: float, distance: float) -> None:
    there = trapezoid_ramp(v_max, a_max, d_max, distance, samples=51)
    back = trapezoid_ramp(v_max, d_max, a_max, distance, samples=51)
    assert back.duration_s == pytest.approx(there.duration_s)
    assert back.velocity_pps[::-1] == pytest.approx(there.velocity_pps, abs=1e-6 * v_max)


def test_closed_forms() -> None:
    # 1 s up to 1000 pps (500), 2 s at it (2000), 0.5 s down (250)
    curve = trapezoid_ramp(1000, 1000, 2000, 2750, samples=8)
    assert curve.duration_s == pytest.approx(3.5)
    assert curve.shape == "trapezoid"
    assert [phase.name for phase in curve.phases] == ["acceleration", "constant velocity", "deceleration"]
    assert [phase.duration_s for phase in curve.phases] == pytest.approx([1.0, 2.0, 0.5])
    assert [phase.end_position for phase in curve.phases] == pytest.approx([500, 2500, 2750])
    assert curve.position == pytest.approx([0, 125, 500, 1000, 1500, 2000, 2500, 2750])
    assert curve.acceleration_pps2.tolist() == [1000, 1000, 0, 0, 0, 0, -2000, 0]


def test_a_short_move_is_a_triangle_with_the_peak_of_the_formula() -> None:
    curve = trapezoid_ramp(1e6, 300, 600, -400, samples=4)
    peak = math.sqrt(2 * 400 * 300 * 600 / 900)
    assert curve.shape == "triangle"
    assert [phase.name for phase in curve.phases] == ["acceleration", "deceleration"]
    assert curve.phases[0].end_velocity_pps == pytest.approx(-peak)
    assert curve.duration_s == pytest.approx(peak / 300 + peak / 600)


def test_no_distance_takes_no_time() -> None:
    curve = trapezoid_ramp(100, 100, 100, 0, samples=3)
    assert (curve.duration_s, curve.shape, curve.phases) == (0.0, "rest", ())
    assert not curve.position.any()


@pytest.mark.sheet("DS-TMC428", "8.10")
def test_the_chips_ramp_comes_close_to_the_ideal_one() -> None:
    pair = design("tmc428", 200, 5, 5, evaluate=False)
    assert pair.pmul is not None
    assert pair.pdiv is not None
    chip = exact_ramp(RampParameters(40, 1500, 200, 5, 5, pair.pmul, pair.pdiv), 30_000)
    rate, slope = pulse_rate_hz(1500, 5, 16e6), acceleration_hz_s(200, 5, 5, 16e6)
    ideal = trapezoid_ramp(rate, slope, slope, 30_000)
    assert chip.duration_s == pytest.approx(ideal.duration_s, rel=0.02)
    assert np.abs(np.interp(chip.time_s, ideal.time_s, ideal.position) - chip.position).max() < 100


@pytest.mark.parametrize("bad", [0.0, -1.0, float("nan"), float("inf")])
def test_bad_rates_are_named(bad: float) -> None:
    with pytest.raises(ValueError, match="v_max_pps is above 0"):
        trapezoid_ramp(bad, 1, 1, 1)
    with pytest.raises(ValueError, match="a_max_pps2 is above 0"):
        trapezoid_ramp(1, bad, 1, 1)
    with pytest.raises(ValueError, match="d_max_pps2 is above 0"):
        trapezoid_ramp(1, 1, bad, 1)


def test_other_bad_input_is_named() -> None:
    with pytest.raises(ValueError, match="distance is finite"):
        trapezoid_ramp(1, 1, 1, float("nan"))
    with pytest.raises(ValueError, match="longer than a number can say"):
        trapezoid_ramp(1e-300, 1, 1, 1e300)
    with pytest.raises(ValueError, match="samples"):
        trapezoid_ramp(1, 1, 1, 1, samples=1)
