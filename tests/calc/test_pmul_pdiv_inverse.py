"""From wanted motion to registers: what is achieved, what is preferred, what is refused and why."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.calc.ramps.pmul_pdiv import a_max_lower_limit, a_max_upper_limit, design, inverse
from app.calc.ramps.ticked import RampParameters, ramp_ending
from app.calc.units.mechanics import Mechanics
from app.calc.units.tmc428 import acceleration_hz_s, pulse_rate_hz


@settings(max_examples=200, deadline=None)
@given(
    v_max=st.integers(200, 2047),
    a_max=st.integers(17, 2047),
    pulse_div=st.integers(0, 13),
    difference=st.integers(-1, 1),
    clock_hz=st.sampled_from([4e6, 16e6, 32e6]),
)
def test_what_registers_can_do_is_found_again(
    v_max: int, a_max: int, pulse_div: int, difference: int, clock_hz: float
) -> None:
    ramp_div = min(13, max(0, pulse_div + difference))
    rate, slope = pulse_rate_hz(v_max, pulse_div, clock_hz), acceleration_hz_s(a_max, pulse_div, ramp_div, clock_hz)
    found = inverse("tmc428", rate, slope, clock_hz=clock_hz)
    assert abs(found.velocity_error) <= 0.005
    assert abs(found.acceleration_error) <= 0.03
    assert found.achieved_velocity_pps == pytest.approx(pulse_rate_hz(found.v_max, found.pulse_div, clock_hz))
    assert found.achieved_acceleration_pps2 == pytest.approx(
        acceleration_hz_s(found.a_max, found.pulse_div, found.ramp_div, clock_hz)
    )
    assert found.achieved_velocity_pps == pytest.approx(rate * (1 + found.velocity_error))
    # the limits of 8.7.1 hold, and the pair is the one that a design gives
    assert a_max_lower_limit(found.ramp_div, found.pulse_div, found.v_max) <= found.a_max
    assert found.a_max <= a_max_upper_limit(found.ramp_div, found.pulse_div)
    pair = design("tmc428", found.a_max, found.ramp_div, found.pulse_div, evaluate=False)
    assert (found.pmul, found.p_mul, found.pdiv) == (pair.pmul, pair.p_mul, pair.pdiv)


@pytest.mark.sheet("DS-TMC428", "8.7.1")
def test_dividers_that_differ_by_one_at_most_are_preferred() -> None:
    found = inverse("tmc428", 20_000, 100_000)
    assert abs(found.ramp_div - found.pulse_div) <= 1
    assert found.v_max > 1023  # one more pulse_div would not fit
    assert not found.warnings


def test_physical_units_get_the_finest_microsteps_that_reach_the_speed() -> None:
    motor = Mechanics(full_steps_per_rev=200)
    slow = inverse("tmc428", 300, 2000, motor, velocity_unit="rpm", acceleration_unit="rpm/s")
    fast = inverse("tmc428", 3000, 20_000, motor, velocity_unit="rpm", acceleration_unit="rpm/s")
    assert (slow.usrs, fast.usrs) == (6, 5)
    assert slow.achieved_velocity_pps == pytest.approx(300 / 60 * 200 * 64, rel=0.005)
    assert fast.achieved_velocity_pps == pytest.approx(3000 / 60 * 200 * 32, rel=0.005)
    assert fast.mechanics.microsteps_per_full_step == 32


def test_pulses_per_second_keep_the_microsteps_of_the_axis() -> None:
    found = inverse("tmc428", 5000, 20_000, Mechanics(microsteps_per_full_step=16))
    assert found.usrs == 4
    with pytest.raises(ValueError, match="microsteps_per_full_step of a TMC428 is 1, 2, 4, 8, 16, 32 or 64, got 256"):
        inverse("tmc428", 5000, 20_000, Mechanics(microsteps_per_full_step=256))


def test_the_tmc4210_leaves_microsteps_to_its_driver() -> None:
    spindle = Mechanics(microsteps_per_full_step=256, travel_mm_per_rev=8)
    found = inverse("tmc4210", 50, 300, spindle, velocity_unit="mm/s", acceleration_unit="mm/s^2")
    assert found.usrs is None
    assert found.achieved_velocity_pps == pytest.approx(50 / 8 * 200 * 256, rel=0.005)
    pair = design("tmc4210", found.a_max, found.ramp_div, found.pulse_div, evaluate=False)
    assert found.p_mul == pair.p_mul


def test_a_suggestion_drives_to_its_target() -> None:
    found = inverse("tmc428", 120, 600, velocity_unit="rpm", acceleration_unit="rpm/s")
    ending = ramp_ending(
        RampParameters(1, found.v_max, found.a_max, found.ramp_div, found.pulse_div, found.pmul, found.pdiv), 100_000
    )
    assert ending.overshoot_steps == 0
    assert ending.duration_s == pytest.approx(100_000 / found.achieved_velocity_pps + 0.2, abs=0.05)


@pytest.mark.parametrize(
    ("velocity", "acceleration", "message"),
    [
        (600_000, 1e6, r"600000 pps with 64 microsteps is above 499756 pps, v_max 2047 with pulse_div 0"),
        (0.001, 1e-3, r"0.001 pps with 64 microsteps is below 0.0298023 pps, v_max 1 with pulse_div 13"),
        (400_000, 1e12, r"is above 976085663 pps\^2, a_max 2047 with ramp_div 0"),
        (400_000, 1, r"is below 58\.2077 pps\^2, a_max 1 with ramp_div 13"),
        (5, 1e7, r"outside a_max_lower_limit and a_max_upper_limit"),
    ],
)
def test_the_unreachable_is_refused_with_its_limit(velocity: float, acceleration: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        inverse("tmc428", velocity, acceleration)


def test_a_speed_beyond_full_steps_is_refused() -> None:
    with pytest.raises(ValueError, match="with 1 microsteps is above 499756 pps"):
        inverse("tmc428", 200_000, 1000, velocity_unit="rpm", acceleration_unit="rpm/s")


def test_coarse_results_are_said() -> None:
    found = inverse("tmc428", 3, 0.01)
    assert abs(found.acceleration_error) > 0.2
    assert any("the nearest acceleration is" in warning for warning in found.warnings)


def test_bad_input_is_named() -> None:
    for bad in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(ValueError, match="velocity is above 0 and finite"):
            inverse("tmc428", bad, 1000)
        with pytest.raises(ValueError, match="acceleration is above 0 and finite"):
            inverse("tmc428", 1000, bad)
        with pytest.raises(ValueError, match="clock_hz is above 0 and finite"):
            inverse("tmc428", 1000, 1000, clock_hz=bad)
    with pytest.raises(ValueError, match="velocity unit is one of"):
        inverse("tmc428", 1000, 1000, velocity_unit="mm")
    with pytest.raises(ValueError, match="acceleration unit is one of"):
        inverse("tmc428", 1000, 1000, acceleration_unit="rpm")
    with pytest.raises(ValueError, match="needs travel_mm_per_rev"):
        inverse("tmc428", 10, 10, velocity_unit="mm/s", acceleration_unit="mm/s^2")
    with pytest.raises(ValueError, match="chip is one of"):
        inverse("tmc5160", 10, 10)
