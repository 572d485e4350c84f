"""What holds for every S-ramp, over the whole ranges of the registers: limits, continuity, the exact end."""

from __future__ import annotations

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from app.calc.ramps.sramp import SRamp, SRampPlan, position_plan, velocity_plan
from tests.calc.sramp_strategies import distances, ramps, signed, states, velocities

TIGHT = 1e-9
BOWS = {"B1": "bow1", "B2": "bow2", "B3": "bow3", "B4": "bow4"}
ACCELERATING = ("B1", "B12", "B2")


def size_of(plan: SRampPlan) -> tuple[float, float, float]:
    """The largest position, velocity and acceleration of a plan, to measure errors by."""
    ends = [(piece, t) for piece in plan.pieces for t in (piece.start_s, piece.end_s)]
    return (
        max((abs(piece.position_at(t)) for piece, t in ends), default=0.0),
        max((abs(piece.velocity_at(t)) for piece, t in ends), default=0.0),
        max((abs(piece.acceleration_at(t)) for piece, t in ends), default=0.0),
    )


def digits_of_time(plan: SRampPlan) -> float:
    """What two near times differ by at least [s]: a bow of microseconds may come after days of constant velocity."""
    return 4 * math.ulp(plan.duration_s)


def tolerances(p: SRamp, plan: SRampPlan) -> tuple[float, float, float]:
    """For positions, velocities and accelerations: 1e-9, and what the last digits of the numbers mean.

    Those of an acceleration count where a steep bow has to let go of it and a gentle one takes over.
    """
    x, v, a = size_of(plan)
    late = digits_of_time(plan)
    steepest, gentlest = max(p.bow1, p.bow2, p.bow3, p.bow4), min(p.bow1, p.bow2, p.bow3, p.bow4)
    last_velocity = 4e-16 * (v + a * a / gentlest) + late * a
    last_place = last_velocity * plan.duration_s + late * v + (1e-15 * v * v / a if p.vstop and a else 0.0)
    return TIGHT * x + last_place, TIGHT * v + last_velocity, TIGHT * a + late * steepest


def check_pieces(p: SRamp, plan: SRampPlan) -> None:
    """Continuous in x, v and a, gapless in time, each jerk a bow, each acceleration within its limit."""
    of_x, of_v, of_a = tolerances(p, plan)
    time_s = 0.0
    for i, piece in enumerate(plan.pieces):
        assert piece.start_s == time_s
        assert piece.end_s > piece.start_s
        time_s = piece.end_s
        bow = getattr(p, BOWS[piece.name]) if piece.name in BOWS else 0.0
        assert abs(piece.jerk_pps3) == bow
        if i:
            before = plan.pieces[i - 1]
            t = piece.start_s
            assert abs(piece.position_at(t) - before.position_at(t)) <= of_x
            assert abs(piece.velocity_at(t) - before.velocity_at(t)) <= of_v
            assert abs(piece.acceleration_at(t) - before.acceleration_at(t)) <= of_a
            assert (piece.name, piece.jerk_pps3) != (before.name, before.jerk_pps3) or piece.jerk_pps3 == 0
        # the sheet's table of phases and signs: accelerating with the velocity, braking against it
        middle = (piece.start_s + piece.end_s) / 2
        way = math.copysign(1.0, piece.velocity_at(middle))
        for t in (piece.start_s, middle, piece.end_s):
            along = way * piece.acceleration_at(t)
            assert along >= -of_a if piece.name in ACCELERATING else along <= of_a
    assert plan.duration_s == time_s


def check_limits(p: SRamp, plan: SRampPlan, vmax: float, v_actual: float, a_actual: float) -> None:
    """AMAX and DMAX hold but where the motion begins beyond them; VMAX but for what a begun bow takes to end."""
    _, of_v, of_a = tolerances(p, plan)
    for piece in plan.pieces:
        limit = p.amax if piece.name in ACCELERATING else p.dmax
        for t in (piece.start_s, piece.end_s):
            assert abs(piece.acceleration_at(t)) <= max(limit, abs(a_actual)) + of_a
    begun = max((a_actual**2 / (2 * bow) for bow in (p.bow2, p.bow4)), default=0.0)
    assert size_of(plan)[1] <= max(vmax, abs(v_actual) + begun) + of_v


def check_ends_on(plan: SRampPlan, p: SRamp, distance: float, v_actual: float) -> None:
    end = plan.at(plan.duration_s)
    assert end.position == distance
    assert end.velocity_pps == end.acceleration_pps2 == 0
    if not plan.pieces:
        return
    of_x, of_v, of_a = tolerances(p, plan)
    first, last = plan.pieces[0], plan.pieces[-1]
    assert last.position_at(last.end_s) == pytest.approx(distance, rel=TIGHT, abs=0)
    assert abs(last.velocity_at(last.end_s)) <= p.vstop + of_v
    if not p.vstop:
        assert abs(last.acceleration_at(last.end_s)) <= of_a
    assert abs(first.position_at(0.0)) <= of_x
    if v_actual:
        assert abs(first.velocity_at(0.0) - v_actual) <= of_v


@given(data=st.data(), p=ramps())
def test_a_move_from_rest(data: st.DataObject, p: SRamp) -> None:
    distance = data.draw(distances(p))
    plan = position_plan(p, distance)
    check_pieces(p, plan)
    check_limits(p, plan, p.vmax, p.vstart, p.start_acceleration if plan.overshoot else 0.0)
    check_ends_on(plan, p, distance, 0.0)
    if not p.vstart:
        assert plan.overshoot == 0


E = math.e
STEEP_BOW4 = SRamp(E, E, E, 1.0, 1.0, 1.0, 3269017.3724721107, vstart=E)
VSTART_ABOVE_VSTOP = SRamp(1.0, E, E, 1.0, 1.0, 1.0, 1.0, vstart=1.0, vstop=1 / E)
NOISE_OF_A_STEEP_BOW3 = SRamp(1.0, 1.0, 8103.08, 1.0, 1.0, 12241134.27, E, vstop=0.0301973834223185)
VSTART_IS_VSTOP = SRamp(22026.5, 1.0, 1.0, 1.0, 13359.7, 1.0, 1.0, vstart=17154.228809290984, vstop=17154.228809290984)
ALTERED_TO_NOTHING = SRamp(3269017.3724721107, 2980.9579870417283, 1.0, 1.0, 1.0, 1.0, 1.0, vstart=E)
"""Braking from the start that was wished takes 10^10 microsteps, from the altered one 5."""
BRAKES_TOO_HARD = SRamp(1.0, E, 1.0, 1.0, 1.0, 1.0, 1.0, vstop=1.0)


@pytest.mark.parametrize(
    ("p", "distance", "v", "a"),
    [
        pytest.param(STEEP_BOW4, -1.0, 0.0, 0.0, id="a bow that ends within the last digits of another"),
        pytest.param(VSTART_ABOVE_VSTOP, -1 / E, 0.0, 0.0, id="passes the target with more than VSTOP and comes back"),
        pytest.param(ALTERED_TO_NOTHING, -1.0, 0.0, 0.0, id="a start altered to nothing still passes its target"),
        pytest.param(ALTERED_TO_NOTHING, 4.0, 0.0, 0.0, id="by a microstep only"),
        pytest.param(NOISE_OF_A_STEEP_BOW3, -1.0, 0.0, 0.0, id="rounding is no phase of its own"),
        pytest.param(VSTART_IS_VSTOP, -1.0, 0.0, 0.0, id="hardly above VSTOP all the way"),
        pytest.param(BRAKES_TOO_HARD, -1.0, 1.0, -E, id="is below VSTOP, but soon fast the other way"),
    ],
)
def test_knife_edges(p: SRamp, distance: float, v: float, a: float) -> None:
    """What hypothesis found while this was built."""
    plan = position_plan(p, distance, v, a)
    check_pieces(p, plan)
    check_ends_on(plan, p, distance, v)


@given(data=st.data(), p=ramps())
def test_a_move_from_any_state(data: st.DataObject, p: SRamp) -> None:
    distance, state = data.draw(distances(p)), data.draw(states(p))
    assume(any(state))
    plan = position_plan(p, distance, *state)
    check_pieces(p, plan)
    check_limits(p, plan, p.vmax, *state)
    check_ends_on(plan, p, distance, state[0])


@given(data=st.data(), p=ramps(), target=signed(velocities))
def test_a_change_of_velocity_from_any_state(data: st.DataObject, p: SRamp, target: float) -> None:
    state = data.draw(states(p))
    plan = velocity_plan(p, target, *state)
    check_pieces(p, plan)
    check_limits(p, plan, abs(target), *state)
    assert plan.at(plan.duration_s).velocity_pps == target
    if plan.pieces:
        _, of_v, of_a = tolerances(p, plan)
        last = plan.pieces[-1]
        end_velocity, end_acceleration = last.velocity_at(last.end_s), last.acceleration_at(last.end_s)
        if target:
            assert abs(end_velocity - target) <= of_v
            assert abs(end_acceleration) <= of_a
        elif p.vstop:
            assert abs(abs(end_velocity) - p.vstop) <= of_v
        else:
            assert abs(end_velocity) <= of_v
            assert abs(end_acceleration) <= p.dfinal + of_a
