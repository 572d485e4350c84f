"""The torque of a motor over speed, and the fastest moves within it, against plain physics and brute force."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.calc.motor_torque import StepperMotor, fastest_move, fastest_trapezoid

MOTOR = StepperMotor()


def test_at_rest_torque_is_that_of_the_current() -> None:
    """With the peak at the rated current a sine gives 1/sqrt(2) of the holding torque, at sqrt(2) of it all."""
    assert float(MOTOR.available_nm(0)) == pytest.approx(MOTOR.holding_torque_nm / math.sqrt(2))
    doubled = replace(MOTOR, current_a=MOTOR.rated_current_a * math.sqrt(2))
    assert float(doubled.available_nm(0)) == pytest.approx(MOTOR.holding_torque_nm)


def test_beyond_the_knee_the_supply_decides() -> None:
    """Far beyond, torque falls as 1/speed with the voltage over the inductance; it never grows with speed."""
    pps = np.linspace(0, 4e6, 4001)
    torque = MOTOR.available_nm(pps)
    assert np.all(np.diff(torque) <= 1e-12)
    stiff = replace(MOTOR, resistance_ohm=1e-9)
    speed = 1e6 * MOTOR.microstep_rad
    impedance = MOTOR.full_steps_per_rev / 4 * speed * MOTOR.inductance_h
    assert float(stiff.available_nm(1e6)) == pytest.approx(MOTOR.torque_constant * MOTOR.supply_v / impedance)
    assert float(replace(MOTOR, supply_v=48).available_nm(1e6)) > float(MOTOR.available_nm(1e6))


def test_pull_out_is_the_most_over_all_load_angles() -> None:
    """The closed form against phasors: voltage at every angle before the back-EMF, real power over speed."""
    for pps in (6e5, 1e6, 2e6):
        speed = pps * MOTOR.microstep_rad
        emf = MOTOR.torque_constant * speed
        reactance = MOTOR.full_steps_per_rev / 4 * speed * MOTOR.inductance_h
        angle = np.linspace(0, math.pi, 20_001)
        current = (MOTOR.supply_v * np.exp(1j * angle) - emf) / (MOTOR.resistance_ohm + 1j * reactance)
        most = np.max(np.real(current)) * emf / speed
        assert float(MOTOR.available_nm(pps)) == pytest.approx(most, rel=1e-6)


def test_what_resists_helps_in_braking() -> None:
    up, down = MOTOR.required_nm([1e5, 1e5], [2e6, -2e6])
    inertia = MOTOR.inertia_kgm2 * MOTOR.microstep_rad * 2e6
    assert (up + down) / 2 == pytest.approx(float(MOTOR.resisting_nm(1e5)))
    assert (up - down) / 2 == pytest.approx(inertia)
    assert MOTOR.required_nm(-1e5, -2e6) == -up
    assert float(MOTOR.required_nm(0, -1.0)) < 0, "from rest it resists the way that the acceleration goes"


@given(pps=st.floats(1, 1e6), margin=st.floats(0, 0.9))
def test_accelerations_leave_just_their_margin(pps: float, margin: float) -> None:
    up, down = (float(rate) for rate in MOTOR.accelerations(pps, margin))
    if up > 0:
        assert float(MOTOR.margin(pps, up)) == pytest.approx(margin, abs=1e-6)
    assert float(MOTOR.margin(pps, -down)) == pytest.approx(margin, abs=1e-6)


@settings(max_examples=40, deadline=None)
@given(distance=st.floats(10, 1e7), vmax=st.floats(1e3, 1.5e6), margin=st.floats(0, 0.8))
def test_no_trapezoid_is_faster_than_torque_allows(distance: float, vmax: float, margin: float) -> None:
    limit = fastest_move(MOTOR, distance, vmax, margin)
    trapezoid = fastest_trapezoid(MOTOR, -distance, vmax, margin)
    assert limit is not None
    assert trapezoid is not None
    assert limit.duration_s <= trapezoid.duration_s * (1 + 1e-3)
    assert max(limit.vmax, trapezoid.vmax) <= vmax * (1 + 1e-12)
    way = trapezoid.vmax**2 / 2 * (1 / trapezoid.amax + 1 / trapezoid.dmax)
    assert way <= distance * (1 + 1e-9)
    speeds = np.linspace(0, trapezoid.vmax, 200)
    assert np.min(MOTOR.margin(speeds, np.full(200, trapezoid.amax))) >= margin - 1e-3
    assert np.min(MOTOR.margin(speeds[1:], np.full(199, -trapezoid.dmax))) >= margin - 1e-3


def test_the_fastest_move_is_the_sum_of_its_steps() -> None:
    """Against stepping through time with the torque there is, to where braking has to begin."""
    move = fastest_move(MOTOR, 4e6, 6e5, 0.5)
    assert move is not None
    dt, speed, way, time = 1e-4, 0.0, 0.0, 0.0
    while speed < 6e5:
        up = float(MOTOR.accelerations(speed, 0.5)[0])
        way, speed, time = way + speed * dt, speed + up * dt, time + dt
    back, speed = 0.0, 0.0
    while speed < 6e5:
        down = float(MOTOR.accelerations(speed, 0.5)[1])
        back, speed, time = back + speed * dt, speed + down * dt, time + dt
    assert move.duration_s == pytest.approx(time + (4e6 - way - back) / 6e5, rel=1e-3)


def test_a_motor_that_cannot_move_its_load_has_no_move() -> None:
    stuck = replace(MOTOR, load_nm=1.0)
    assert fastest_move(stuck, 1000, 1e5, 0.0) is None
    assert fastest_trapezoid(stuck, 1000, 1e5, 0.0) is None
    assert float(stuck.margin(1000, 0)) < 0


@pytest.mark.parametrize(("name", "value"), [("supply_v", 0.0), ("load_nm", -1.0), ("inertia_kgm2", math.nan)])
def test_impossible_motors_are_refused_by_name(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=name):
        replace(MOTOR, **{name: value})
