"""The trapezoid with VBREAK and hold mode of a TMC4361, against worked numbers and the SixPoint planner."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from app.calc.ramps import sixpoint
from app.calc.ramps.sramp import SRampPlan
from app.calc.ramps.sramp_trapezoid import (
    Trapezoid,
    hold_position_plan,
    hold_velocity_plan,
    trapezoid_position_plan,
    trapezoid_velocity_plan,
)
from tests.calc.sramp_strategies import accelerations, decades, or_nothing, signed

EXAMPLE = Trapezoid(50_000, 200_000, 250_000, vstart=1000, vstop=2000, vbreak=10_000, astart=50_000, dfinal=60_000)
speeds = decades(1.0, 8e6)


@st.composite
def trapezoids(draw: st.DrawFn) -> Trapezoid:
    return Trapezoid(
        draw(speeds),
        draw(accelerations),
        draw(accelerations),
        draw(or_nothing(speeds)),
        draw(or_nothing(speeds)),
        draw(or_nothing(speeds)),
        draw(accelerations),
        draw(accelerations),
    )


def names(plan: SRampPlan) -> list[str]:
    return [phase.name for phase in plan.phases]


def codes(plan: SRampPlan) -> list[str]:
    return [warning.code for warning in plan.warnings]


def last_digits(p: Trapezoid, fastest: float) -> float:
    """What those of a velocity mean [s]: a little more of it takes long with a small acceleration."""
    return 1e-15 * fastest / min(p.amax, p.dmax, p.astart, p.dfinal)


def check(p: Trapezoid, plan: SRampPlan) -> None:
    """Gapless, continuous but for the jumps at VSTART and VSTOP, each phase with its acceleration on its side."""
    x = max((abs(piece.position_at(piece.end_s)) for piece in plan.pieces), default=0.0)
    for before, after in pairwise(plan.pieces):
        assert before.end_s == after.start_s
        t = after.start_s
        late = 4 * math.ulp(plan.duration_s)
        fastest = max(abs(before.velocity_at(t)), abs(after.velocity_at(t)), abs(before.velocity_at(before.start_s)))
        jump = abs(after.velocity_at(t) - before.velocity_at(t))
        restarts = abs(jump - min(p.vstart, p.vmax)) <= 1e-9 * fastest and "stops_first" in codes(plan)
        assert restarts or jump <= 1e-9 * fastest + late * max(p.amax, p.dmax, p.astart, p.dfinal)
        late += last_digits(p, fastest)
        assert abs(after.position_at(t) - before.position_at(t)) <= 1e-9 * x + late * fastest
    rates = {"A1L": p.astart, "A1": p.amax, "A2": 0.0, "A3": -p.dmax, "A3L": -p.dfinal}
    for piece in plan.pieces:
        middle = piece.velocity_at((piece.start_s + piece.end_s) / 2)
        assert piece.acceleration_pps2 == math.copysign(1.0, middle) * rates[piece.name]
        assert piece.jerk_pps3 == 0
        if piece.name in ("A1L", "A3L"):
            assert abs(middle) <= p.vbreak
        elif piece.name != "A2":
            assert abs(middle) >= p.vbreak


@pytest.mark.sheet("DS-TMC4361", "8.2")
def test_the_worked_example() -> None:
    plan = trapezoid_position_plan(EXAMPLE, 20_000)
    assert names(plan) == ["A1L", "A1", "A2", "A3", "A3L"]
    lengths = [phase.end_position - phase.start_position for phase in plan.phases]
    assert lengths == pytest.approx([990, 6000, 20_000 - 12_590, 4800, 800])
    durations = [phase.duration_s for phase in plan.phases]
    assert durations == pytest.approx([0.18, 0.2, 7410 / 50_000, 0.16, 2 / 15])
    assert plan.at(0.0).velocity_pps == 1000
    assert plan.pieces[-1].velocity_at(plan.duration_s) == 2000
    assert plan.at(plan.duration_s).velocity_pps == 0


@pytest.mark.sheet("DS-TMC4361", "8.2")
def test_without_vbreak_each_slope_has_one_acceleration() -> None:
    plan = trapezoid_position_plan(Trapezoid(1000, 500, 1000), 2000)
    assert names(plan) == ["A1", "A2", "A3"]
    short = trapezoid_position_plan(Trapezoid(1e6, 300, 600), -400)
    assert names(short) == ["A1", "A3"]
    assert short.limits[0].peak == pytest.approx(math.sqrt(2 * 400 / (1 / 300 + 1 / 600)))


@given(p=trapezoids(), length=decades(1e-3, 1e6))
def test_from_rest_it_is_the_sixpoint_ramp(p: Trapezoid, length: float) -> None:
    """The same shape has another planner in this house, from another chip's manual."""
    assume(p.vstart <= p.vstop)
    distance = min(length, p.vmax * 1e4)
    same = sixpoint.SixPoint(p.vmax, p.amax, p.dmax, p.vstart, p.astart, p.vbreak, p.dfinal, p.vstop)
    expected = sixpoint.position_plan(same, distance)
    plan = trapezoid_position_plan(p, distance)
    check(p, plan)
    late = last_digits(p, max(p.vmax, p.vstart))
    assert abs(plan.duration_s - expected.duration_s) <= 1e-9 * expected.duration_s + late
    times = np.linspace(0, plan.duration_s, 50)
    near = 1e-9 * distance + 4 * late * p.vmax
    assert plan.at(times).position == pytest.approx(expected.at(times).position, rel=0, abs=near)


@given(p=trapezoids(), distance=signed(decades(1e-3, 1e6)), v=signed(speeds), brakes=st.sampled_from((-1.0, 1.0)))
def test_a_move_from_any_velocity_ends_on_the_target(p: Trapezoid, distance: float, v: float, brakes: float) -> None:
    v = math.copysign(min(abs(v), 20 * p.vmax), v)
    plan = trapezoid_position_plan(p, distance, v, brakes * v)
    assume(plan.duration_s < 1e6)
    check(p, plan)
    assert plan.at(plan.duration_s).position == distance
    if plan.pieces:
        first, last = plan.pieces[0], plan.pieces[-1]
        size = max(abs(piece.position_at(piece.end_s)) for piece in plan.pieces)
        assert abs(last.velocity_at(last.end_s)) <= p.vstop * (1 + 1e-9) + 1e-9 * max(abs(v), p.vmax, p.vstart)
        assert abs(first.position_at(0.0)) <= 1e-9 * size + last_digits(p, abs(v)) * abs(v)
        if v:
            assert first.velocity_at(0.0) == pytest.approx(v)


@given(p=trapezoids(), target=signed(speeds), v=signed(speeds), brakes=st.sampled_from((-1.0, 1.0)))
def test_a_change_of_velocity(p: Trapezoid, target: float, v: float, brakes: float) -> None:
    plan = trapezoid_velocity_plan(p, target, v, brakes * v)
    if target * v > 0 and brakes < 0 and abs(target) > abs(v):
        assert codes(plan).count("stops_first") == 1
    assert plan.at(plan.duration_s).velocity_pps == target
    if plan.pieces:
        last = plan.pieces[-1].velocity_at(plan.duration_s)
        near = 1e-9 * max(abs(target), abs(v)) + 4 * math.ulp(plan.duration_s) * max(p.amax, p.dmax, p.astart, p.dfinal)
        ends = (target,) if target else (p.vstop, -p.vstop)
        if "stops_first" in codes(plan) and p.vstart >= abs(target):
            ends = (0.0,)  # the start again is a jump
        assert min(abs(last - end) for end in ends) <= near
        assert plan.end_position == plan.pieces[-1].position_at(plan.duration_s)


@pytest.mark.sheet("DS-TMC4361", "8.2.1")
def test_vstart_and_vstop_have_no_part_in_a_reversal() -> None:
    plan = trapezoid_velocity_plan(EXAMPLE, -30_000, 20_000)
    assert names(plan) == ["A3", "A3L", "A1L", "A1"]
    assert [phase.start_velocity_pps for phase in plan.phases] == pytest.approx([20_000, 10_000, 0, -10_000], abs=1e-6)
    back = trapezoid_position_plan(EXAMPLE, 5000, -30_000)
    assert names(back) == ["A3", "A3L", "A1L", "A1", "A3", "A3L"]
    assert back.phases[2].start_velocity_pps == pytest.approx(0, abs=1e-6)


@pytest.mark.sheet("DS-TMC4361", "8.2.1")
def test_vstop_ends_a_stop_and_no_other_change() -> None:
    assert trapezoid_velocity_plan(EXAMPLE, 0, 30_000).phases[-1].end_velocity_pps == pytest.approx(2000)
    assert trapezoid_velocity_plan(EXAMPLE, 1000, 30_000).phases[-1].end_velocity_pps == pytest.approx(1000)
    assert trapezoid_velocity_plan(EXAMPLE, 0, 1500).duration_s == 0
    assert trapezoid_position_plan(EXAMPLE, 0, 1500).duration_s == 0


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
def test_a_braking_motor_stands_before_it_accelerates_again() -> None:
    plan = trapezoid_position_plan(EXAMPLE, 50_000, 30_000, -1.0)
    assert names(plan) == ["A3", "A3L", "A1L", "A1", "A2", "A3", "A3L"]
    assert plan.phases[1].end_velocity_pps == pytest.approx(0, abs=1e-6)
    assert plan.phases[2].start_velocity_pps == pytest.approx(1000)  # it starts regularly, with VSTART
    assert "stops_first" in codes(plan)
    accelerating = trapezoid_position_plan(EXAMPLE, 50_000, 30_000, 1.0)
    assert names(accelerating) == ["A1", "A2", "A3", "A3L"]
    # with VMAX below the velocity nothing has to accelerate: the way out that the sheet gives
    slower = Trapezoid(20_000, 200_000, 250_000)
    assert names(trapezoid_position_plan(slower, 50_000, 30_000, -1.0)) == ["A3", "A2", "A3"]
    assert names(trapezoid_velocity_plan(EXAMPLE, 40_000, 30_000, -1.0)) == ["A3", "A3L", "A1L", "A1"]


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
def test_braking_that_takes_20_seconds_may_overrun() -> None:
    assert "dmax_too_slow" in codes(trapezoid_position_plan(Trapezoid(20_000, 1000, 1000), 1e6))
    assert "dmax_too_slow" not in codes(trapezoid_position_plan(Trapezoid(20_000, 1000, 1001), 1e6))


def test_a_start_too_fast_for_a_short_move_overshoots() -> None:
    plan = trapezoid_position_plan(Trapezoid(1000, 1000, 1000, vstart=500), 10)
    assert plan.overshoot == pytest.approx(125 - 10)
    assert codes(plan) == ["vstart_overshoot", "vmax_not_reached"]
    assert 0 < plan.arrival_s < plan.duration_s
    assert plan.at(plan.arrival_s).position == pytest.approx(10)


def test_other_warnings() -> None:
    idle = Trapezoid(1000, 1000, 1000, vstop=200, vbreak=100, astart=1000, dfinal=1)
    assert "vbreak_not_above_vstop" in codes(trapezoid_position_plan(idle, 5000))
    assert "target_overshoot" in codes(trapezoid_position_plan(Trapezoid(1000, 1000, 1000), 10, 900))


@pytest.mark.sheet("DS-TMC4361", "8.2")
def test_hold_mode_is_a_rectangle() -> None:
    plan = hold_position_plan(4000, -1000)
    assert plan.duration_s == 0.25
    assert plan.at([0, 0.1, 0.25]).position.tolist() == [0, pytest.approx(-400), -1000]
    assert plan.at([0, 0.1, 0.25]).velocity_pps.tolist() == [-4000, -4000, 0]
    assert hold_position_plan(4000, 0).phases == ()
    turning = hold_velocity_plan(-300)
    assert turning.duration_s == 0
    assert turning.at(2.0).position == -600


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf])
def test_bad_parameters_are_named(bad: float) -> None:
    for name in ("vmax", "amax", "dmax"):
        with pytest.raises(ValueError, match=name):
            Trapezoid(**{"vmax": 1.0, "amax": 1.0, "dmax": 1.0, name: bad})
    with pytest.raises(ValueError, match="vmax"):
        hold_position_plan(bad, 1)


def test_other_bad_input_is_named() -> None:
    with pytest.raises(ValueError, match="astart is above 0"):
        Trapezoid(10, 1, 1, vbreak=5, dfinal=1)
    with pytest.raises(ValueError, match="dfinal is above 0"):
        Trapezoid(10, 1, 1, vbreak=5, astart=1)
    with pytest.raises(ValueError, match="astart is above 0"):  # VSTART has no part in a reversal
        trapezoid_velocity_plan(Trapezoid(10, 1, 1, vstart=6, vbreak=5, dfinal=1), -8, 8)
    with pytest.raises(ValueError, match="distance"):
        trapezoid_position_plan(EXAMPLE, 2.0**32)
    with pytest.raises(ValueError, match="v_actual is finite"):
        trapezoid_position_plan(EXAMPLE, 1, math.nan)
    with pytest.raises(ValueError, match="v_target is finite"):
        trapezoid_velocity_plan(EXAMPLE, math.inf)
    with pytest.raises(ValueError, match="v_target is finite"):
        hold_velocity_plan(math.nan)
