"""v_min as a start-stop speed, against a rotor that is integrated step by step."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from app.calc.motor_torque import StepperMotor
from app.calc.ramps.ticked import RampParameters
from app.calc.tmc428.start_stop import start_stop, start_stop_pps

MOTOR = StepperMotor(inertia_kgm2=5e-5, friction_nm=0.0, damping_nms=0.0, microsteps_per_full_step=16)
RAMP = RampParameters(v_min=10, v_max=900, a_max=200, ramp_div=6, pulse_div=5, pmul=58, pdiv=4)


def slips(motor: StepperMotor, speed_pps: float, *, starting: bool, load_nm: float = 0.0) -> bool:
    """Whether a rotor falls out of a field that starts to turn at a speed, or stops from it. Semi-implicit Euler."""
    peak, teeth = motor.torque_constant * motor.current_a, motor.full_steps_per_rev / 4
    w = speed_pps * motor.microstep_rad
    lag = math.asin(load_nm / peak)
    theta, omega, field = -lag / teeth, 0.0 if starting else w, 0.0
    step_s = 1e-6
    for _ in range(400_000):
        field += w * step_s if starting else 0.0
        omega += (peak * math.sin(teeth * (field - theta)) - load_nm) / motor.inertia_kgm2 * step_s
        theta += omega * step_s
        if abs(teeth * (field - theta)) > 2 * math.pi:
            return True
    return False


@pytest.mark.sheet("DS-TMC428", "8.3")
@pytest.mark.parametrize("load_nm", [0.0, 0.1])
def test_a_rotor_started_at_the_limit_just_stays_with_its_field(load_nm: float) -> None:
    limit = start_stop_pps(replace(MOTOR, load_nm=load_nm))
    assert not slips(MOTOR, 0.98 * limit, starting=True, load_nm=load_nm)
    assert slips(MOTOR, 1.03 * limit, starting=True, load_nm=load_nm)


@pytest.mark.sheet("DS-TMC428", "8.3")
def test_a_rotor_stopped_from_the_limit_just_stays_where_it_was_sent() -> None:
    limit = start_stop_pps(MOTOR)
    assert not slips(MOTOR, 0.98 * limit, starting=False)
    assert slips(MOTOR, 1.03 * limit, starting=False)


def test_more_inertia_and_less_current_lower_the_limit() -> None:
    limit = start_stop_pps(MOTOR)
    assert start_stop_pps(replace(MOTOR, inertia_kgm2=4 * MOTOR.inertia_kgm2)) == pytest.approx(limit / 2)
    assert start_stop_pps(replace(MOTOR, current_a=MOTOR.current_a / 4)) == pytest.approx(limit / 2)
    assert start_stop_pps(replace(MOTOR, load_nm=1.0)) == 0.0


@pytest.mark.sheet("DS-TMC428", "8.3")
def test_a_higher_v_min_ends_sooner_and_is_refused_beyond_the_limit() -> None:
    found = start_stop(MOTOR, RAMP, 3_000)
    assert found.keeps_steps
    assert found.limit_chip >= 2 * found.suggested_chip
    assert found.duration_s is not None
    assert found.duration_least_s is not None
    assert found.duration_suggested_s is not None
    assert found.duration_suggested_s < found.duration_s < found.duration_least_s
    beyond = start_stop(MOTOR, replace(RAMP, v_min=found.limit_chip + 1, v_max=2047), 3_000)
    assert not beyond.keeps_steps
    assert any("slip" in said for said in beyond.warnings)
    assert any("short of its target" in said for said in start_stop(MOTOR, replace(RAMP, v_min=0), 100).warnings)
