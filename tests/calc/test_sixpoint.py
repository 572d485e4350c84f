"""The SixPoint planner against what defines it: its limits, its knees, its own continuation, the closed trapezoid."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from app.calc.ramps.sixpoint import MotionPlan, SixPoint, position_plan, velocity_plan
from app.calc.ramps.trapezoid import trapezoid_ramp

speeds = st.floats(1.0, 1e6)
rates = st.floats(10.0, 1e7)
distances = st.floats(-1e7, 1e7).filter(lambda x: abs(x) > 1e-3)
DOWN = ("deceleration DMAX", "deceleration D1")
EXAMPLE = SixPoint(v_max=50_000, a_max=20_000, d_max=30_000, v_start=100, a1=50_000, v1=20_000, d1=60_000, v_stop=200)


@st.composite
def ramps(draw: st.DrawFn, wait: bool = False) -> SixPoint:
    v_stop = draw(st.floats(0.0, 5e3))
    return SixPoint(
        v_max=draw(speeds),
        a_max=draw(rates),
        d_max=draw(rates),
        v_start=draw(st.floats(0.0, 1.0)) * v_stop,
        a1=draw(rates),
        v1=draw(st.one_of(st.just(0.0), st.floats(1.0, 5e5))),
        d1=draw(rates),
        v_stop=v_stop,
        t_zero_wait_s=draw(st.floats(0.0, 0.1)) if wait else 0.0,
    )


def speed_after(way: float, start: float, below: float, above: float, knee: float) -> float:
    """The speed after `way` microsteps of speeding up from `start`: the reverse of what the planner computes."""
    if start < knee:
        to_knee = (knee**2 - start**2) / (2 * below)
        if way <= to_knee:
            return math.sqrt(start**2 + 2 * below * way)
        way, start = way - to_knee, knee
    return math.sqrt(start**2 + 2 * above * way)


def close(p: SixPoint, distance: float) -> float:
    """Microsteps that rounding may cost."""
    return 1e-9 * (abs(distance) + p.v_max)


@pytest.mark.sheet("FM-PD42-1241", "1.3")
@settings(deadline=None)
@given(p=ramps(), distance=distances)
def test_from_rest_it_is_as_fast_as_the_ramps_allow_everywhere(p: SixPoint, distance: float) -> None:
    plan = position_plan(p, distance)
    inside = np.linspace(0, plan.duration_s, 203)[1:-1]
    motion = plan.at(inside)
    for gone, velocity in zip(np.abs(motion.position), motion.velocity_pps, strict=True):
        up = speed_after(gone, min(p.v_start, p.v_max), p.a1, p.a_max, p.v1)
        down = speed_after(max(abs(distance) - gone, 0.0), p.v_stop, p.d1, p.d_max, p.v1)
        allowed = min(up, down, p.v_max)
        # Near a standstill the speed hangs on the root of a rounded position.
        slack = 1e-6 * p.v_max + math.sqrt(2 * max(p.a1, p.a_max, p.d1, p.d_max) * close(p, distance))
        assert abs(velocity) == pytest.approx(allowed, abs=slack)
        assert velocity * distance >= 0


@settings(deadline=None)
@given(p=ramps(wait=True), distance=distances, v_actual=st.floats(-1e6, 1e6))
def test_it_ends_at_rest_on_the_target_without_a_jump(p: SixPoint, distance: float, v_actual: float) -> None:
    plan = position_plan(p, distance, v_actual)
    end = plan.at([plan.duration_s, plan.duration_s + 1])
    assert end.position.tolist() == [distance, distance]
    assert end.velocity_pps.tolist() == [0, 0]
    reach = abs(distance) + abs(v_actual) ** 2 / min(p.d1, p.d_max)
    before = 0.0
    for phase in plan.phases:
        assert phase.start_position == pytest.approx(before, abs=close(p, reach))
        before = phase.end_position
    assert before == pytest.approx(distance, abs=close(p, reach))
    assert plan.phases[0].start_s == 0
    assert plan.phases[-1].end_s == plan.duration_s
    rounded = 1e-6 * (p.v_max + abs(v_actual)) + 4 * np.spacing(plan.duration_s) * max(p.a1, p.a_max, p.d1, p.d_max)
    for one, two in pairwise(plan.phases):
        assert one.end_s == two.start_s
        if two.start_velocity_pps != pytest.approx(one.end_velocity_pps, abs=rounded):
            assert abs(one.end_velocity_pps) <= p.v_stop + rounded
            assert abs(two.start_velocity_pps) <= p.v_start + rounded


@settings(deadline=None)
@given(p=ramps(), distance=distances, v_actual=st.floats(-1e6, 1e6))
@example(
    p=SixPoint(v_max=1, a_max=10, d_max=10, v_start=0, a1=10, v1=math.nextafter(1, 2), d1=11, v_stop=0),
    distance=1.0,
    v_actual=2.0,
)
def test_each_acceleration_holds_on_its_side_of_v1(p: SixPoint, distance: float, v_actual: float) -> None:
    for piece in position_plan(p, distance, v_actual).pieces:
        middle = abs(piece.velocity_at((piece.start_s + piece.end_s) / 2))
        rate = abs(piece.acceleration_pps2)
        if rate == 0:
            assert middle == pytest.approx(p.v_max)
            continue
        if p.v1 == pytest.approx(middle, rel=1e-12) and piece.end_s == pytest.approx(piece.start_s, rel=1e-12):
            continue  # from V1 to a VMAX that is V1 but for rounding: there is no side
        speeding_up = piece.acceleration_pps2 * piece.velocity_at((piece.start_s + piece.end_s) / 2) > 0
        below = middle < p.v1
        expected = (p.a1 if below else p.a_max) if speeding_up else (p.d1 if below else p.d_max)
        assert rate == expected
        assert piece.name == ("acceleration A1" if below else "acceleration AMAX") * speeding_up + (
            "deceleration D1" if below else "deceleration DMAX"
        ) * (not speeding_up)


@settings(deadline=None)
@given(p=ramps(), distance=distances, v_actual=st.floats(-1e6, 1e6))
def test_velocity_is_what_position_changes_by(p: SixPoint, distance: float, v_actual: float) -> None:
    for piece in position_plan(p, distance, v_actual).pieces:
        times = np.linspace(piece.start_s, piece.end_s, 5)
        gone = piece.position_at(piece.end_s) - piece.position_at(piece.start_s)
        # Simpson's rule is exact for a straight line.
        v0, v1, v2 = (piece.velocity_at(float(t)) for t in times[::2])
        reach = abs(distance) + v_actual**2 / min(p.d1, p.d_max)
        assert gone == pytest.approx((piece.end_s - piece.start_s) * (v0 + 4 * v1 + v2) / 6, abs=close(p, reach))


@settings(deadline=None)
@given(p=ramps(), distance=distances, share=st.floats(0.01, 0.99))
def test_seen_again_under_way_it_goes_on_as_planned(p: SixPoint, distance: float, share: float) -> None:
    plan = position_plan(p, distance)
    t0 = share * plan.duration_s
    here = plan.at(t0)
    position, velocity = float(here.position), float(here.velocity_pps)
    left = distance - position
    assume(abs(left) > 1e-3)
    # Rounded to doubles it may be a hair too fast to brake in time: then it is a hair slower.
    rest = position_plan(p, left, velocity * (1 - 1e-12))
    assert rest.overshoot <= close(p, distance)
    if rest.overshoot == 0:
        assert rest.duration_s == pytest.approx(plan.duration_s - t0, rel=1e-5, abs=1e-5)
        times = np.linspace(0, rest.duration_s, 50)
        later = plan.at(np.minimum(t0 + times, plan.duration_s)).position
        assert np.abs(rest.at(times).position + position - later).max() <= 1e-5 * (abs(distance) + p.v_max)


@settings(deadline=None)
@given(p=ramps(wait=True), distance=distances, v_actual=st.floats(-1e6, 1e6))
def test_the_mirrored_move_is_the_move_mirrored(p: SixPoint, distance: float, v_actual: float) -> None:
    one, other = position_plan(p, distance, v_actual), position_plan(p, -distance, -v_actual)
    times = np.linspace(0, one.duration_s, 50)
    assert other.duration_s == one.duration_s
    assert np.array_equal(one.at(times).position, -other.at(times).position)


@pytest.mark.sheet("FM-PD42-1241", "1.3")
@settings(deadline=None)
@given(v_max=speeds, a_max=rates, d_max=rates, distance=distances)
def test_without_v1_it_is_the_trapezoid(v_max: float, a_max: float, d_max: float, distance: float) -> None:
    curve = position_plan(SixPoint(v_max=v_max, a_max=a_max, d_max=d_max), distance).curve(101)
    known = trapezoid_ramp(v_max, a_max, d_max, distance, 101)
    assert curve.duration_s == pytest.approx(known.duration_s, rel=1e-9)
    slopes = v_max**2 / (2 * a_max) + v_max**2 / (2 * d_max)
    if slopes != pytest.approx(abs(distance), rel=1e-9):  # where v_max is just reached, either is right
        assert curve.shape == known.shape
    assert curve.position == pytest.approx(known.position, abs=1e-9 * (abs(distance) + v_max))


def test_the_symmetric_move_in_closed_form() -> None:
    # Both legs up and both down: t = v1/a1 + (v_max - v1)/a_max each way, and the rest at v_max.
    p = SixPoint(v_max=40_000, a_max=10_000, d_max=10_000, a1=20_000, v1=20_000, d1=20_000)
    slope_s = 20_000 / 20_000 + 20_000 / 10_000
    slope = 20_000**2 / 40_000 + (40_000**2 - 20_000**2) / 20_000
    plan = position_plan(p, 2 * slope + 40_000)
    assert plan.duration_s == pytest.approx(2 * slope_s + 1)
    assert [phase.name for phase in plan.phases] == [
        "acceleration A1",
        "acceleration AMAX",
        "constant velocity",
        "deceleration DMAX",
        "deceleration D1",
    ]
    half = plan.at(plan.duration_s / 2)
    assert half.position == pytest.approx(slope + 20_000)
    assert half.velocity_pps == 40_000


@pytest.mark.parametrize(
    ("distance", "names"),
    [
        (
            100_000,
            ["acceleration A1", "acceleration AMAX", "constant velocity", "deceleration DMAX", "deceleration D1"],
        ),
        (20_000, ["acceleration A1", "acceleration AMAX", *DOWN]),
        (300, ["acceleration A1", "deceleration D1"]),
        (0.1, ["acceleration A1"]),  # there before VSTOP is reached
    ],
)
def test_short_moves_turn_round_early(distance: float, names: list[str]) -> None:
    plan = position_plan(EXAMPLE, distance)
    assert [phase.name for phase in plan.phases] == names
    assert plan.cruises == ("constant velocity" in names)
    assert plan.curve(10).position[-1] == distance


def test_too_fast_to_brake_it_runs_past_waits_and_comes_back() -> None:
    p = SixPoint(v_max=20_000, a_max=10_000, d_max=10_000, v_stop=10, t_zero_wait_s=0.5)
    plan = position_plan(p, 1000, v_actual=20_000)
    braking = (20_000**2 - 10**2) / 20_000
    assert plan.overshoot == pytest.approx(braking - 1000)
    assert plan.at(plan.arrival_s).position == pytest.approx(1000)
    assert plan.arrival_s < plan.phases[0].end_s
    assert [phase.name for phase in plan.phases] == [
        "deceleration DMAX",
        "wait",
        "acceleration AMAX",
        "deceleration DMAX",
    ]
    assert plan.phases[1].duration_s == 0.5
    assert plan.at(plan.phases[1].start_s + 0.25).velocity_pps == 0
    curve = plan.curve(501)
    assert curve.overshoot_steps == math.ceil(braking - 1000)
    assert curve.settling_s == pytest.approx(plan.duration_s - plan.arrival_s)
    assert curve.position[-1] == 1000


def test_running_the_wrong_way_it_turns_round() -> None:
    plan = position_plan(EXAMPLE, 5000, v_actual=-10_000)
    assert plan.overshoot == 0
    assert plan.arrival_s == plan.duration_s
    assert plan.phases[0].name == "deceleration D1"
    assert plan.at(plan.phases[0].end_s).position == pytest.approx(-(10_000**2 - 200**2) / 120_000)
    assert plan.at(np.linspace(0, plan.duration_s, 100)).position.min() >= -833.0001


def test_slow_enough_it_stops_dead_before_it_turns() -> None:
    plan = position_plan(EXAMPLE, 5000, v_actual=-150)  # below VSTOP
    assert plan.at(0.0).position == 0
    assert plan.phases[0].start_velocity_pps == 100  # VSTART, the other way


def test_faster_than_allowed_it_first_slows_down() -> None:
    plan = position_plan(EXAMPLE, 200_000, v_actual=70_000)
    assert [phase.name for phase in plan.phases][:2] == ["deceleration DMAX", "constant velocity"]
    assert plan.phases[1].start_velocity_pps == 50_000


def test_a_highest_speed_below_vstop_needs_no_braking() -> None:
    p = SixPoint(v_max=100, a_max=1000, d_max=1000, v_stop=200)
    assert [phase.name for phase in position_plan(p, 1000).phases] == ["acceleration AMAX", "constant velocity"]
    assert position_plan(p, 1, v_actual=150).pieces[-1].velocity_at(0.0) == pytest.approx(150)


@pytest.mark.sheet("FM-PD42-1241", "1.3")
@pytest.mark.sheet("FM-PD42-1241", "7.5")
def test_a_rotation_changes_speed_by_the_maximum_acceleration_alone() -> None:
    plan = velocity_plan(EXAMPLE, 30_000)
    assert [(phase.name, phase.start_velocity_pps) for phase in plan.phases] == [("acceleration AMAX", 100)]
    assert plan.duration_s == pytest.approx((30_000 - 100) / 20_000)
    assert plan.at(plan.duration_s + 1).velocity_pps == 30_000
    assert plan.at(plan.duration_s + 1).position == pytest.approx(plan.end_position + 30_000)
    slower = velocity_plan(EXAMPLE, 10_000, v_actual=30_000)
    assert slower.duration_s == pytest.approx(1.0)
    assert slower.phases[0].name == "deceleration AMAX"


@pytest.mark.sheet("FM-PD42-1241", "3.6.3")
def test_a_stop_brakes_by_the_maximum_acceleration_down_to_vstop() -> None:
    plan = velocity_plan(EXAMPLE, 0, v_actual=-20_000)
    assert plan.duration_s == pytest.approx((20_000 - 200) / 20_000)
    assert plan.at(plan.duration_s).velocity_pps == 0
    assert plan.end_position == pytest.approx(-(20_000**2 - 200**2) / 40_000)
    assert velocity_plan(EXAMPLE, 0).pieces == ()
    assert velocity_plan(EXAMPLE, 0, v_actual=150).duration_s == 0


@settings(deadline=None)
@given(p=ramps(wait=True), v_target=st.floats(-1e6, 1e6), v_actual=st.floats(-1e6, 1e6))
def test_a_rotation_gets_to_its_speed_without_a_jump_in_position(p: SixPoint, v_target: float, v_actual: float) -> None:
    plan = velocity_plan(p, v_target, v_actual)
    assert plan.at(plan.duration_s).velocity_pps == v_target
    before = 0.0
    for phase in plan.phases:
        assert phase.start_position == pytest.approx(before, abs=1e-9 * (1 + v_actual**2 / p.a_max))
        before = phase.end_position
        if phase.name != "wait":
            assert phase.end_velocity_pps - phase.start_velocity_pps == pytest.approx(
                math.copysign(p.a_max * phase.duration_s, phase.end_velocity_pps - phase.start_velocity_pps), abs=1e-6
            )


def test_times_of_any_shape() -> None:
    plan = position_plan(EXAMPLE, 10_000)
    grid = np.linspace(-1, plan.duration_s + 1, 12).reshape(3, 4)
    motion = plan.at(grid)
    assert motion.position.shape == motion.velocity_pps.shape == motion.acceleration_pps2.shape == (3, 4)
    assert motion.position[0, 0] == 0
    assert motion.position[-1, -1] == 10_000
    assert plan.at(0.0).position.shape == ()


def test_no_way_and_no_speed_is_rest() -> None:
    plan = position_plan(EXAMPLE, 0)
    assert (plan.duration_s, plan.pieces) == (0, ())
    curve = plan.curve(3)
    assert curve.shape == "rest"
    assert curve.position.tolist() == [0, 0, 0]


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"v_max": 0.0}, "v_max"),
        ({"a_max": 0.0}, "a_max"),
        ({"v1": -1.0}, "v1"),
        ({"d1": math.inf}, "d1"),
        ({"v_stop": math.nan}, "v_stop"),
    ],
)
def test_parameters_that_cannot_be(values: dict[str, float], reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        SixPoint(**{"v_max": 1000.0, "a_max": 1000.0, **values})


def test_what_cannot_be_planned() -> None:
    for distance in (math.nan, math.inf, 2.0**32):
        with pytest.raises(ValueError, match="distance"):
            position_plan(EXAMPLE, distance)
    with pytest.raises(ValueError, match="v_actual"):
        position_plan(EXAMPLE, 1, math.nan)
    with pytest.raises(ValueError, match="v_target"):
        velocity_plan(EXAMPLE, math.inf)
    with pytest.raises(ValueError, match="d_max is 0"):
        position_plan(SixPoint(v_max=1000, a_max=1000), 1000)
    with pytest.raises(ValueError, match="a1 is 0"):
        position_plan(SixPoint(v_max=1000, a_max=1000, d_max=1000, v1=500, d1=10), 1000)
    with pytest.raises(ValueError, match="v_start 500 pps is too fast"):
        position_plan(SixPoint(v_max=1000, a_max=1000, d_max=1000, v_start=500, v_stop=10), 10)
    with pytest.raises(ValueError, match="samples"):
        position_plan(EXAMPLE, 10).curve(1)


def test_a_million_samples_are_cheap() -> None:
    plan: MotionPlan = position_plan(EXAMPLE, 1e6)
    motion = plan.at(np.linspace(0, plan.duration_s, 1_000_000))
    assert np.all(np.diff(motion.position) >= 0)
