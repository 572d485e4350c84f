"""What the TMC4361's data sheet says of S-ramps, worked numbers, warnings and bad input."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.ramps.sramp import SRamp, SRampPlan, default_bow, position_plan, velocity_plan
from tests.calc.sramp_strategies import decades

EXAMPLE = SRamp(50_000, 200_000, 200_000, 2e6, 2e6, 2e6, 2e6)
UNEVEN = SRamp(50_000, 200_000, 120_000, 1e6, 2e6, 3e6, 1.5e6)


def names(plan: SRampPlan) -> list[str]:
    return [phase.name for phase in plan.phases]


def codes(plan: SRampPlan) -> list[str]:
    return [warning.code for warning in plan.warnings]


def start_of(plan: SRampPlan) -> tuple[float, float]:
    """Velocity and acceleration."""
    start = plan.at(0.0)
    return float(start.velocity_pps), float(start.acceleration_pps2)


@pytest.mark.sheet("DS-TMC4361", "8.2")
def test_seven_phases_with_the_signs_of_the_table() -> None:
    for way in (1, -1):
        plan = position_plan(UNEVEN, way * 100_000)
        assert names(plan) == ["B1", "B12", "B2", "B23", "B3", "B34", "B4"]
        assert [way * piece.jerk_pps3 for piece in plan.pieces] == [1e6, 0, -2e6, 0, -3e6, 0, 1.5e6]
        ends = [way * piece.acceleration_at(piece.end_s) for piece in plan.pieces]
        assert ends == pytest.approx([200_000, 200_000, 0, 0, -120_000, -120_000, 0], abs=1e-3)


@pytest.mark.parametrize(
    ("bow", "durations", "way"),
    [
        (2e6, [0.1, 0.15, 0.1], 8750),
        (8e5, [0.25, 0.25], 12_500),
        (4e5, [0.353553391, 0.353553391], 17_677.67),
    ],
)
def test_worked_slopes(bow: float, durations: list[float], way: float) -> None:
    plan = velocity_plan(replace(EXAMPLE, bow1=bow, bow2=bow), 50_000)
    assert [phase.duration_s for phase in plan.phases] == pytest.approx(durations, rel=1e-6)
    assert plan.end_position == pytest.approx(way, rel=1e-6)
    assert plan.limits[1].peak == pytest.approx(min(200_000, math.sqrt(bow * 50_000)))


@pytest.mark.sheet("DS-TMC4361", "8.2")
def test_phases_that_are_not_reached_are_left_out() -> None:
    assert names(position_plan(EXAMPLE, 17_500)) == ["B1", "B12", "B2", "B3", "B34", "B4"]
    assert names(position_plan(EXAMPLE, 100)) == ["B1", "B2", "B3", "B4"]
    uneven = replace(EXAMPLE, amax=20_000)
    assert names(position_plan(uneven, 100)) == ["B1", "B12", "B2", "B3", "B4"]
    assert position_plan(EXAMPLE, 0).phases == ()
    assert position_plan(EXAMPLE, 0).shape == "rest"


@given(vmax=decades(1, 1e6), amax=decades(1, 1e6))
def test_with_the_default_bow_the_slope_just_touches_amax(vmax: float, amax: float) -> None:
    bow = default_bow(amax, vmax)
    plan = velocity_plan(SRamp(vmax, amax, amax, bow, bow, bow, bow), vmax)
    assert names(plan) == ["B1", "B2"]
    assert plan.limits[1].reached
    assert plan.duration_s == pytest.approx(2 * vmax / amax)


@pytest.mark.sheet("DS-TMC4361", "8.2")
def test_vmax_is_kept_as_long_as_possible() -> None:
    plan = position_plan(EXAMPLE, 50_000)
    kept = plan.phases[3]
    assert kept.name == "B23"
    assert kept.duration_s == pytest.approx((50_000 - 2 * 8750) / 50_000)
    assert plan.duration_s == pytest.approx(0.7 + kept.duration_s)


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
def test_slopes_are_fastest_without_b12_and_b34() -> None:
    """Of all bows, those beyond which B12 and B34 appear give the last gain in time that bows alone can give."""
    durations = [velocity_plan(replace(EXAMPLE, bow1=bow, bow2=bow), 50_000).duration_s for bow in (4e5, 8e5, 1e9)]
    assert durations[0] > durations[1] > durations[2]
    assert durations[2] == pytest.approx(50_000 / 200_000, rel=1e-3)  # infinite bows: the trapezoid


@pytest.mark.sheet("DS-TMC4361", "8.2")
def test_dfinal_has_no_part_in_positioning() -> None:
    assert position_plan(replace(EXAMPLE, dfinal=50_000), 20_000) == position_plan(EXAMPLE, 20_000)


@pytest.mark.sheet("DS-TMC4361", "8.2")
def test_astart_and_dfinal_are_where_a_velocity_ramp_begins_and_ends() -> None:
    p = replace(EXAMPLE, astart=50_000, dfinal=80_000)
    rising = velocity_plan(p, 50_000)
    assert rising.at(0.0).acceleration_pps2 == 50_000
    assert rising.phases[0].duration_s == pytest.approx(150_000 / 2e6)
    falling = velocity_plan(p, 0, 50_000)
    last = falling.pieces[-1]
    assert last.name == "B4"
    assert last.acceleration_at(last.end_s) == pytest.approx(-80_000)
    # between two velocities neither has a part: a choice, the sheet is silent
    assert velocity_plan(p, 20_000, 50_000).duration_s == velocity_plan(EXAMPLE, 20_000, 50_000).duration_s
    assert velocity_plan(p, 50_000, 20_000).duration_s == velocity_plan(EXAMPLE, 50_000, 20_000).duration_s


@pytest.mark.sheet("DS-TMC4361", "8.2.1")
def test_vstart_leaves_b1_out_unless_astart_is_asked_for() -> None:
    p = replace(EXAMPLE, vstart=5000, astart=50_000)
    plan = velocity_plan(p, 50_000)
    assert names(plan) == ["B12", "B2"]
    assert start_of(plan) == (5000, 200_000)
    both = velocity_plan(replace(p, use_astart_and_vstart=True), 50_000)
    assert names(both) == ["B1", "B12", "B2"]
    assert start_of(both) == (5000, 50_000)
    backward = position_plan(p, -50_000)
    assert start_of(backward) == (-5000, -200_000)


@pytest.mark.sheet("DS-TMC4361", "8.2.1")
def test_vstop_leaves_b4_out() -> None:
    p = replace(EXAMPLE, vstop=3000, dfinal=50_000)
    for plan in (velocity_plan(p, 0, 50_000), position_plan(p, 100_000)):
        last = plan.pieces[-1]
        assert last.name == "B34"
        assert last.velocity_at(last.end_s) == pytest.approx(3000)
        assert last.acceleration_at(last.end_s) == pytest.approx(-200_000)
        assert plan.at(plan.duration_s).velocity_pps == 0
    backward = velocity_plan(p, 0, -50_000)
    assert backward.phases[-1].end_velocity_pps == pytest.approx(-3000)


@pytest.mark.sheet("DS-TMC4361", "8.2.1")
def test_vstop_belongs_to_the_target_and_to_vmax_0() -> None:
    p = replace(EXAMPLE, vstop=3000)
    assert velocity_plan(p, 1000, 50_000).phases[-1].end_velocity_pps == pytest.approx(1000)
    assert velocity_plan(p, 0, 2000).duration_s == 0
    assert position_plan(p, 0, 2000).duration_s == 0
    assert position_plan(p, 0.1).phases[-1].end_velocity_pps < 3000  # so short that it never has to brake


@pytest.mark.sheet("DS-TMC4361", "8.2.1")
def test_a_reversal_uses_neither_vstart_nor_vstop() -> None:
    p = replace(EXAMPLE, vstart=5000, vstop=3000, astart=100_000, dfinal=100_000)
    plan = velocity_plan(p, -40_000, 30_000)
    assert plan.pieces == velocity_plan(EXAMPLE, -40_000, 30_000).pieces
    velocities = plan.at(np.linspace(0, plan.duration_s * 0.999999, 10_001)).velocity_pps
    assert np.abs(np.diff(velocities)).max() < 100
    assert names(plan) == ["B3", "B34", "B12", "B2"]  # the slope runs through velocity 0 with DMAX, which is AMAX here
    gentler = velocity_plan(replace(p, amax=50_000), -40_000, 30_000)
    assert names(gentler) == ["B3", "B34", "B4", "B12", "B2"]
    assert gentler.phases[2].end_velocity_pps == pytest.approx(0, abs=1e-6)
    assert gentler.pieces[2].acceleration_at(gentler.pieces[2].end_s) == pytest.approx(-50_000)


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
def test_a_start_that_does_not_fit_vmax_is_altered() -> None:
    p = replace(EXAMPLE, vstart=45_000)  # AMAX^2 / (2 BOW2) = 10 000 pps more would exceed VMAX
    plan = velocity_plan(p, 50_000)
    assert plan.at(0.0).acceleration_pps2 == pytest.approx(math.sqrt(2 * 2e6 * 5000))
    assert names(plan) == ["B2"]
    assert plan.limits[0].peak == pytest.approx(50_000)
    assert "start_acceleration_altered" in codes(plan)
    assert "altered to 141421" in next(w.text for w in plan.warnings if w.code == "start_acceleration_altered")
    steep = position_plan(replace(EXAMPLE, astart=150_000), 100)
    assert "start_acceleration_altered" in codes(steep)
    assert steep.overshoot == 0


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
def test_a_register_change_may_take_the_velocity_beyond_vmax() -> None:
    plan = position_plan(EXAMPLE, 100_000, 45_000, 200_000)
    assert plan.limits[0].peak == pytest.approx(55_000)
    assert "vmax_exceeded" in codes(plan)
    assert names(plan)[:3] == ["B2", "B3", "B4"]
    assert velocity_plan(EXAMPLE, 50_000, 45_000, 200_000).limits[0].peak == pytest.approx(55_000)


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
def test_lower_values_while_under_way_may_overshoot_the_target() -> None:
    under_way = position_plan(EXAMPLE, 30_000)
    state = under_way.at(0.35)
    left = 30_000 - float(state.position)
    slower = replace(EXAMPLE, dmax=20_000)
    plan = position_plan(slower, left, float(state.velocity_pps), float(state.acceleration_pps2))
    assert "target_overshoot" in codes(plan)
    assert plan.overshoot > 1000
    assert plan.curve(100).overshoot_steps == math.ceil(plan.overshoot)
    assert plan.at(plan.arrival_s).position == pytest.approx(left)
    assert plan.at(plan.duration_s).position == left


@pytest.mark.sheet("DS-TMC4361", "8.2.2")
def test_vmax_0_alone_is_no_way_to_stop_a_positioning_s_ramp() -> None:
    with pytest.raises(ValueError, match="VMAX = 1 first"):
        replace(EXAMPLE, vmax=0.0)


def test_a_vstart_too_fast_for_a_short_move_overshoots() -> None:
    plan = position_plan(replace(EXAMPLE, vstart=20_000), 100)
    assert plan.overshoot > 100
    assert {"vstart_overshoot", "vstart_above_vstop"} <= set(codes(plan))
    assert plan.at(plan.duration_s).position == 100


def test_limits_out_of_reach_are_named() -> None:
    slow = replace(EXAMPLE, bow1=4e5, bow2=4e5)
    assert codes(position_plan(slow, 100_000)) == ["amax_out_of_reach"]
    assert codes(position_plan(replace(EXAMPLE, bow3=4e5), 100_000)) == ["dmax_out_of_reach"]
    short = position_plan(EXAMPLE, 5000)
    assert codes(short) == ["vmax_not_reached"]
    assert short.warnings[0].text == "VMAX 50000 pps is not reached: the way is enough for 23166.2 pps"
    assert [limit.reached for limit in short.limits] == [False, True, True]
    fast = replace(EXAMPLE, vstart=60_000)
    assert {"vstart_above_vmax"} <= set(codes(position_plan(fast, 100_000)))
    assert "astart_above_amax" in codes(velocity_plan(replace(EXAMPLE, astart=3e5), 50_000))
    assert "dfinal_above_dmax" in codes(velocity_plan(replace(EXAMPLE, dfinal=3e5), 0, 50_000))


@given(part=st.floats(0.0, 0.999), distance=decades(10, 1e6), way=st.sampled_from((-1, 1)))
def test_planning_again_on_the_way_changes_nothing(part: float, distance: float, way: int) -> None:
    plan = position_plan(UNEVEN, way * distance)
    now_s = part * plan.duration_s
    state = plan.at(now_s)
    left = way * distance - float(state.position)
    again = position_plan(UNEVEN, left, float(state.velocity_pps), float(state.acceleration_pps2))
    # the last digits of a state become time with a root of third order near the end
    assert again.duration_s == pytest.approx(plan.duration_s - now_s, abs=2e-4 * plan.duration_s)
    assert again.overshoot <= 1e-6 * distance


@given(distance=decades(1, 1e6), scale=decades(0.01, 100))
def test_the_unit_of_length_makes_no_difference(distance: float, scale: float) -> None:
    scaled = SRamp(*(scale * value for value in (50_000, 200_000, 120_000, 1e6, 2e6, 3e6, 1.5e6)))  # type: ignore[arg-type]
    assert position_plan(scaled, scale * distance).duration_s == pytest.approx(
        position_plan(UNEVEN, distance).duration_s, rel=1e-9
    )


@given(distance=decades(1, 1e6))
def test_exchanged_bows_run_the_film_backwards(distance: float) -> None:
    there = position_plan(UNEVEN, distance)
    back = position_plan(SRamp(50_000, 120_000, 200_000, 1.5e6, 3e6, 2e6, 1e6), distance)
    assert back.duration_s == pytest.approx(there.duration_s, rel=1e-9)
    times = np.linspace(0, there.duration_s, 21)[1:-1]
    assert back.at(times).position[::-1] == pytest.approx(distance - there.at(times).position, abs=1e-6 * distance)


def test_a_curve_has_what_the_other_calculators_answer_and_jerk() -> None:
    plan = position_plan(UNEVEN, 20_000)
    curve = plan.curve(2001)
    assert curve.time_s[-1] == plan.duration_s
    assert curve.position[-1] == 20_000
    assert (curve.shape, curve.settled, curve.settling_s, curve.overshoot_steps) == ("triangle", True, 0.0, 0)
    assert np.gradient(curve.position, curve.time_s) == pytest.approx(curve.velocity_pps, abs=100)
    assert np.gradient(curve.velocity_pps, curve.time_s)[1:-1] == pytest.approx(curve.acceleration_pps2[1:-1], abs=2000)
    assert set(np.abs(curve.jerk_pps3).tolist()) == {1e6, 0.0, 2e6, 3e6, 1.5e6}
    turning = velocity_plan(UNEVEN, 50_000)
    assert turning.curve(10, turning.duration_s + 1).phases[-1].name == "B23"
    assert turning.curve(10).shape == "velocity"
    with pytest.raises(ValueError, match="samples"):
        plan.curve(1)


@pytest.mark.parametrize("name", ["vmax", "amax", "dmax", "bow1", "bow2", "bow3", "bow4"])
@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf])
def test_bad_parameters_are_named(name: str, bad: float) -> None:
    with pytest.raises(ValueError, match=name):
        replace(EXAMPLE, **{name: bad})  # type: ignore[arg-type]


def test_other_bad_input_is_named() -> None:
    with pytest.raises(ValueError, match="vstop is finite and not below 0"):
        replace(EXAMPLE, vstop=-1.0)
    with pytest.raises(ValueError, match="distance is below"):
        position_plan(EXAMPLE, 2.0**32)
    with pytest.raises(ValueError, match="v_actual is finite"):
        position_plan(EXAMPLE, 1, math.nan)
    with pytest.raises(ValueError, match="a_actual is finite"):
        velocity_plan(EXAMPLE, 1, 0, math.inf)
    with pytest.raises(ValueError, match="v_target is finite"):
        velocity_plan(EXAMPLE, math.nan)
    with pytest.raises(ValueError, match="amax is above 0"):
        default_bow(0, 1)
