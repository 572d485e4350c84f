"""Symmetric S-ramps from rest to rest are time-optimal: Ruckig, an independent library, needs as long to 1e-9."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, reject
from hypothesis import strategies as st
from ruckig import InputParameter, Result, Ruckig, RuckigError, Trajectory

from app.calc.ramps.sramp import SRamp, position_plan
from app.calc.ramps.sramp_many import plan_many
from tests.calc.sramp_strategies import decades


def ruckig_duration(vmax: float, amax: float, bow: float, distance: float, v: float = 0.0, a: float = 0.0) -> float:
    """Time-optimal duration [s], planned in units of VMAX and AMAX, in which the library's fixed thresholds fit.

    Raises RuckigError in the few cases for which it finds none.
    """
    unit_s = vmax / amax
    wanted = InputParameter(1)
    wanted.current_position, wanted.current_velocity, wanted.current_acceleration = [0.0], [v / vmax], [a / amax]
    wanted.target_position = [distance / (vmax * unit_s)]
    wanted.target_velocity = wanted.target_acceleration = [0.0]
    wanted.max_velocity, wanted.max_acceleration, wanted.max_jerk = [1.0], [1.0], [bow * unit_s / amax]
    trajectory = Trajectory(1)
    assert Ruckig(1).calculate(wanted, trajectory) is Result.Working
    return float(trajectory.duration) * unit_s


def symmetric(vmax: float, amax: float, bow: float) -> SRamp:
    return SRamp(vmax, amax, amax, bow, bow, bow, bow)


steepness = decades(1e-3, 1e3)
"""Of a bow, against AMAX^2 / VMAX: AMAX is out of reach below 1, and there is a stretch of it above."""
lengths = st.tuples(st.sampled_from((-1, 1)), decades(1e-4, 1e3)).map(lambda x: x[0] * x[1])
"""Of a move, against VMAX^2 / AMAX."""


@given(vmax=decades(0.1, 8e6), amax=decades(1, 4e6), steep=steepness, length=lengths)
def test_from_rest_to_rest_it_takes_no_longer(vmax: float, amax: float, steep: float, length: float) -> None:
    bow, distance = steep * amax**2 / vmax, length * vmax**2 / amax
    assume(abs(distance) < 2**32)
    best = ruckig_duration(vmax, amax, bow, distance)
    assert position_plan(symmetric(vmax, amax, bow), distance).duration_s == pytest.approx(best, rel=1e-9)


@given(
    vmax=decades(100, 1e6),
    amax=decades(100, 1e6),
    steep=steepness,
    length=lengths,
    v=st.floats(-0.999, 0.999),  # on the limit the last digit decides whether the library finds it exceeded
    a=st.floats(-1, 1),
)
def test_nor_from_a_state_within_the_limits(
    vmax: float, amax: float, steep: float, length: float, v: float, a: float
) -> None:
    bow, distance = steep * amax**2 / vmax, length * vmax**2 / amax
    assume(abs(distance) < 2**32)
    a *= min(amax, (bow * vmax) ** 0.5)
    v *= vmax - a * a / (2 * bow)  # so that no bow that is begun takes it beyond VMAX
    try:
        best = ruckig_duration(vmax, amax, bow, distance, v, a)
    except RuckigError:
        reject()
    plan = position_plan(symmetric(vmax, amax, bow), distance, v, a)
    assert plan.duration_s == pytest.approx(best, rel=1e-9)


def test_nor_do_many_planned_in_one_call() -> None:
    rng = np.random.default_rng(4361)
    count = 5000
    vmax, amax = (np.exp(rng.uniform(np.log(100), np.log(1e6), count)) for _ in range(2))
    bow = np.exp(rng.uniform(-5, 5, count)) * amax**2 / vmax
    distance = rng.choice((-1, 1), count) * np.minimum(np.exp(rng.uniform(-7, 5, count)) * vmax**2 / amax, 2.0**31)
    plans = plan_many(distance, vmax=vmax, amax=amax, bow1=bow)
    best = [ruckig_duration(*case) for case in zip(*(x.tolist() for x in (vmax, amax, bow, distance)), strict=True)]
    assert plans.duration_s == pytest.approx(np.array(best), rel=1e-9)
