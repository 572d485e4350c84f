"""Chip units: the formulas of DS-TMC428 8.14, round trips, vectors against scalars, and the mechanics behind the
shaft."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.units.mechanics import ACCELERATION_UNITS, POSITION_UNITS, RATE_UNITS, Mechanics
from app.calc.units.tmc428 import (
    acceleration_from_hz_s,
    acceleration_hz_s,
    pulse_rate_hz,
    steps_during_acceleration,
    velocity_from_rate,
)

dividers = st.integers(0, 13)
registers = st.integers(0, 2047)
clocks = st.floats(1e5, 32e6)


@pytest.mark.sheet("DS-TMC428", "8.14")
def test_the_pulse_rate_is_the_formula() -> None:
    # velocity 2048 would be one step with each pulse clock of f/32/2^pulse_div: 500 kHz at 16 MHz
    assert pulse_rate_hz(1024, 0, 16e6) == 250_000
    assert pulse_rate_hz(1, 13, 16e6) == 16e6 / 2**29
    assert pulse_rate_hz(2047, 3, 8e6) == 8e6 * 2047 / (2**3 * 2048 * 32)


@pytest.mark.sheet("DS-TMC428", "8.14")
def test_the_acceleration_is_the_formula() -> None:
    assert acceleration_hz_s(1, 0, 0, 16e6) == 16e6**2 / 2**29
    assert acceleration_hz_s(2047, 13, 13, 16e6) == 16e6 * 16e6 * 2047 / 2**55


@pytest.mark.sheet("DS-TMC428", "8.14")
@given(velocity=st.integers(1, 2047), a_max=st.integers(1, 2047), ramp_div=dividers, pulse_div=dividers, clock=clocks)
def test_steps_of_acceleration_are_half_v_squared_over_a(
    velocity: int, a_max: int, ramp_div: int, pulse_div: int, clock: float
) -> None:
    rate, slope = pulse_rate_hz(velocity, pulse_div, clock), acceleration_hz_s(a_max, pulse_div, ramp_div, clock)
    assert steps_during_acceleration(velocity, a_max, ramp_div, pulse_div) == pytest.approx(0.5 * rate**2 / slope)


@given(velocity=st.integers(-2047, 2047), pulse_div=dividers, clock=clocks)
def test_velocity_survives_the_round_trip(velocity: int, pulse_div: int, clock: float) -> None:
    assert velocity_from_rate(pulse_rate_hz(velocity, pulse_div, clock), pulse_div, clock) == pytest.approx(
        velocity, rel=1e-12
    )


@given(a=st.integers(-2047, 2047), pulse_div=dividers, ramp_div=dividers, clock=clocks)
def test_acceleration_survives_the_round_trip(a: int, pulse_div: int, ramp_div: int, clock: float) -> None:
    back = acceleration_from_hz_s(acceleration_hz_s(a, pulse_div, ramp_div, clock), pulse_div, ramp_div, clock)
    assert back == pytest.approx(a, rel=1e-12)


def test_vectors_are_their_scalars() -> None:
    velocity, pulse_div = np.arange(-2047, 2048, 89), np.arange(14)[:, None]
    rates = pulse_rate_hz(velocity, pulse_div, 16e6)
    assert isinstance(rates, np.ndarray)
    assert rates.shape == (14, velocity.size)
    for row, divider in zip(rates, range(14), strict=True):
        assert row.tolist() == [pulse_rate_hz(int(v), divider, 16e6) for v in velocity]
    a = np.arange(0, 2048, 89)
    slopes = acceleration_hz_s(a, 3, np.arange(14)[:, None], 16e6)
    assert isinstance(slopes, np.ndarray)
    assert slopes[5].tolist() == [acceleration_hz_s(int(each), 3, 5, 16e6) for each in a]
    steps = steps_during_acceleration(velocity, 17, 3, 4)
    assert isinstance(steps, np.ndarray)
    assert steps.tolist() == [steps_during_acceleration(int(v), 17, 3, 4) for v in velocity]


def test_scalars_come_back_as_plain_floats() -> None:
    assert type(pulse_rate_hz(1, 0, 16e6)) is float
    assert type(velocity_from_rate(1.0, 0, 16e6)) is float
    assert type(acceleration_hz_s(1, 0, 0, 16e6)) is float
    assert type(steps_during_acceleration(1, 1, 0, 0)) is float
    assert type(Mechanics().to_microsteps(1, "rev")) is float


def test_what_is_out_of_range_is_named_with_its_range() -> None:
    with pytest.raises(ValueError, match="velocity is -2047 to 2047, got 2048"):
        pulse_rate_hz(2048, 0, 16e6)
    with pytest.raises(ValueError, match="velocity is -2047 to 2047, got nan"):
        pulse_rate_hz(np.array([1.0, math.nan]), 0, 16e6)
    with pytest.raises(ValueError, match="pulse_div is 0 to 13, got 14"):
        pulse_rate_hz(1, 14, 16e6)
    with pytest.raises(ValueError, match="pulse_div is a whole number of 0 to 13"):
        pulse_rate_hz(1, np.array([0.5]), 16e6)
    for clock in (0.0, -1.0, math.inf, math.nan):
        with pytest.raises(ValueError, match="clock_hz is a finite frequency above 0 Hz"):
            pulse_rate_hz(1, 0, clock)
    with pytest.raises(ValueError, match="a is -2047 to 2047"):
        acceleration_hz_s(-2048, 0, 0, 16e6)
    with pytest.raises(ValueError, match="a_max is above 0 to 2047, got 0"):
        steps_during_acceleration(100, 0, 3, 3)


def test_rates_beyond_the_dividers_are_refused_with_the_reach() -> None:
    with pytest.raises(ValueError, match=r"rate_hz is -499756 to 499756 Hz"):
        velocity_from_rate(500_000.0, 0, 16e6)
    with pytest.raises(ValueError, match=r"acceleration is -.* Hz/s with these dividers"):
        acceleration_from_hz_s(1e12, 0, 0, 16e6)
    with pytest.raises(ValueError, match="rate_hz is"):
        velocity_from_rate(math.nan, 0, 16e6)


SPINDLE = Mechanics(full_steps_per_rev=200, microsteps_per_full_step=16, gear_ratio=2.5, travel_mm_per_rev=4.0)


def test_one_turn_in_every_unit() -> None:
    turn = 200 * 16 * 2.5
    for value, unit in (
        (turn, "microsteps"),
        (500, "fullsteps"),
        (1, "rev"),
        (360, "deg"),
        (math.tau, "rad"),
        (4, "mm"),
    ):
        assert SPINDLE.to_microsteps(value, unit) == pytest.approx(turn)
    assert SPINDLE.to_microsteps(4, "mm") == turn
    for value, unit in ((turn, "pps"), (500, "fullsteps/s"), (1, "rps"), (60, "rpm"), (math.tau, "rad/s"), (4, "mm/s")):
        assert SPINDLE.to_microsteps(value, unit) == pytest.approx(turn)
    for value, unit in ((turn, "pps^2"), (60, "rpm/s"), (math.tau, "rad/s^2"), (360, "deg/s^2"), (4, "mm/s^2")):
        assert SPINDLE.to_microsteps(value, unit) == pytest.approx(turn)


@given(
    value=st.floats(-1e9, 1e9),
    unit=st.sampled_from((*POSITION_UNITS, *RATE_UNITS, *ACCELERATION_UNITS)),
    steps=st.integers(1, 1000),
    microsteps=st.sampled_from((1, 2, 16, 64, 256)),
    gear=st.floats(0.01, 100),
    travel=st.floats(0.01, 100),
)
def test_mechanics_survive_the_round_trip(
    value: float, unit: str, steps: int, microsteps: int, gear: float, travel: float
) -> None:
    axis = Mechanics(steps, microsteps, gear, travel)
    assert axis.from_microsteps(axis.to_microsteps(value, unit), unit) == pytest.approx(value, rel=1e-12, abs=1e-300)


def test_mechanics_convert_arrays() -> None:
    turns = np.array([[0.0, 0.5], [-1.0, 2.0]])
    assert np.array_equal(SPINDLE.from_microsteps(SPINDLE.to_microsteps(turns, "rev"), "rev"), turns)


@pytest.mark.parametrize("unit", ["mm", "mm/s", "mm/s^2"])
def test_millimetres_need_a_travel(unit: str) -> None:
    with pytest.raises(ValueError, match="needs travel_mm_per_rev"):
        Mechanics().to_microsteps(1, unit)


def test_bad_mechanics_are_named() -> None:
    with pytest.raises(ValueError, match=r"full_steps_per_rev is a whole number of 1 to 100000, got 0"):
        Mechanics(full_steps_per_rev=0)
    with pytest.raises(ValueError, match="microsteps_per_full_step is a whole number of 1 to 1024"):
        Mechanics(microsteps_per_full_step=1025)
    with pytest.raises(ValueError, match="gear_ratio is above 0"):
        Mechanics(gear_ratio=0)
    with pytest.raises(ValueError, match="travel_mm_per_rev is above 0"):
        Mechanics(travel_mm_per_rev=math.nan)
    with pytest.raises(ValueError, match="unit 'furlong' is not one of microsteps"):
        Mechanics().to_microsteps(1, "furlong")
    with pytest.raises(ValueError, match="is finite"):
        Mechanics().to_microsteps(math.inf, "rev")
