"""Moves of every axis of every chip: against the continuous SixPoint curve of the calculators, and tick by tick against
the plain ramp that the drive's tests have as their oracle.
"""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.calc.ramps.sixpoint import SixPoint, position_plan, velocity_plan
from app.emulators.tmc5xxx import MODELS, Tmc5xxxModel
from tests.emulators.drive.oracle import PlainRamp
from tests.emulators.tmc5xxx.rig import (
    BACKWARD,
    CLOCK_HZ,
    DUAL,
    FORWARD,
    HOLD,
    ONE_TURN_A_SECOND,
    PLACES,
    POSITION,
    RAMP,
    TURN,
    Bench,
    moving,
)

RAMPS = st.fixed_dictionaries(
    {
        "VSTART": st.sampled_from([0, 0, 500, 5000]),
        "A1": st.integers(200, 20_000),
        "V1": st.sampled_from([0, 0, 10_000, 60_000]),
        "AMAX": st.integers(200, 20_000),
        "VMAX": st.integers(6000, 400_000),
        "DMAX": st.integers(200, 20_000),
        "D1": st.integers(200, 20_000),
        "VSTOP": st.sampled_from([5000, 6000]),
    }
)


def sixpoint(ramp: dict[str, int], clock_hz: float) -> SixPoint:
    """The registers in microsteps and seconds: v = V fCLK / 2^24, a = A fCLK^2 / 2^41 (NOTES-TMC5XXX 2)."""
    v, a = clock_hz / 2**24, clock_hz**2 / 2**41
    return SixPoint(
        v_max=ramp["VMAX"] * v,
        a_max=ramp["AMAX"] * a,
        d_max=ramp["DMAX"] * a,
        v_start=ramp["VSTART"] * v,
        a1=ramp["A1"] * a,
        v1=ramp["V1"] * v,
        d1=ramp["D1"] * a,
        v_stop=ramp["VSTOP"] * v,
    )


@settings(max_examples=60, deadline=None)
@given(
    place=st.sampled_from(PLACES),
    ramp=RAMPS,
    distance=st.one_of(st.integers(2000, 400_000), st.integers(-400_000, -2000)),
    clock_hz=st.sampled_from([4e6, 12e6, 16e6, 18e6]),
)
def test_a_move_is_the_curve_of_the_calculators(
    place: tuple[Tmc5xxxModel, int], ramp: dict[str, int], distance: int, clock_hz: float
) -> None:
    model, axis = place
    bench = Bench(model, clock_hz=clock_hz)
    bench.put(axis, **ramp, XTARGET=distance)
    plan = position_plan(sixpoint(ramp, clock_hz), distance)
    tick_s = 256 / clock_hz
    curve = plan.curve(21)
    for time_s, position, velocity in zip(curve.time_s, curve.position, curve.velocity_pps, strict=True):
        bench.now_s = float(time_s)
        # a tick of delay and the rounding of each tick's velocity; its share of the arrival is in the last steps
        off = abs(bench.read("XACTUAL", axis) - float(position))
        assert off <= 3 * tick_s * abs(float(velocity)) + 30
    bench.now_s = plan.duration_s * 1.005 + 10 * tick_s
    assert bench.read("XACTUAL", axis) == distance
    assert bench.read("VACTUAL", axis) == 0
    assert {"position_reached", "event_pos_reached", "vzero"} <= bench.flags(axis)


@settings(max_examples=25, deadline=None)
@given(
    place=st.sampled_from(PLACES),
    ramp=RAMPS,
    program=st.lists(
        st.tuples(
            st.sampled_from([POSITION, POSITION, FORWARD, BACKWARD, HOLD]),
            st.integers(-3000, 3000),
            st.integers(0, 200_000),
            st.integers(1, 400),
        ),
        min_size=1,
        max_size=5,
    ),
    wait=st.sampled_from([0, 3, 100]),
)
def test_every_tick_is_that_of_the_plain_ramp(
    place: tuple[Tmc5xxxModel, int], ramp: dict[str, int], program: list[tuple[int, int, int, int]], wait: int
) -> None:
    model, axis = place
    bench = Bench(model)
    bench.put(axis, **ramp, TZEROWAIT=wait)
    plain = PlainRamp(
        vstart=ramp["VSTART"] << 9,
        a1=ramp["A1"],
        v1=ramp["V1"] << 9,
        amax=ramp["AMAX"],
        dmax=ramp["DMAX"],
        d1=ramp["D1"],
        vstop=ramp["VSTOP"] << 9,
        wait_ticks=2 * wait,
    )
    ticks = 0
    for mode, target, vmax, length in program:
        bench.put(axis, RAMPMODE=mode, XTARGET=target, VMAX=vmax)
        plain.mode, plain.target, plain.vmax = mode, target, vmax << 9
        for _ in range(length):
            ticks += 1
            plain.tick()
            bench.now_s = ticks * 256 / CLOCK_HZ
            assert bench.read("XACTUAL", axis) == plain.x
            assert bench.read("VACTUAL", axis) == (abs(plain.v) >> 9) * (1 if plain.v > 0 else -1)


@pytest.mark.parametrize(("model", "axis"), PLACES)
def test_velocity_mode_goes_by_amax_both_ways(model: Tmc5xxxModel, axis: int) -> None:
    bench = moving(model, axis)
    start_s = bench.now_s
    plan = velocity_plan(sixpoint(RAMP, CLOCK_HZ), -RAMP["VMAX"] * CLOCK_HZ / 2**24)
    bench.put(axis, RAMPMODE=BACKWARD)
    bench.now_s = start_s + plan.duration_s * 0.5
    assert bench.read("VACTUAL", axis) == pytest.approx(-RAMP["VMAX"] / 2, rel=0.01)
    bench.now_s = start_s + plan.duration_s + 1e-3
    assert bench.read("VACTUAL", axis) == -RAMP["VMAX"]
    assert bench.read("XACTUAL", axis) == pytest.approx(plan.end_position, abs=200)
    assert "velocity_reached" in bench.flags(axis)
    bench.put(axis, VMAX=0)
    bench.wait(plan.duration_s + 1e-3)
    assert bench.read("VACTUAL", axis) == 0


@pytest.mark.parametrize("model", MODELS)
def test_hold_mode_keeps_the_velocity(model: Tmc5xxxModel) -> None:
    bench = moving(model)
    bench.put(RAMPMODE=FORWARD)
    bench.wait(0.1)
    bench.put(RAMPMODE=HOLD)
    velocity = bench.read("VACTUAL")
    bench.wait(5)
    assert bench.read("VACTUAL") == velocity > 0


@pytest.mark.parametrize("model", DUAL)
def test_two_motors_go_their_own_ways(model: Tmc5xxxModel) -> None:
    bench = Bench(model)
    bench.put(0, **RAMP)
    bench.put(1, **(RAMP | {"VMAX": ONE_TURN_A_SECOND}))
    bench.put(0, XTARGET=TURN)
    bench.put(1, XTARGET=-3 * TURN)
    bench.wait(1.0)
    assert bench.read("XACTUAL", 0) == TURN
    assert -3 * TURN < bench.read("XACTUAL", 1) < -TURN // 2
    bench.wait(3.0)
    assert bench.read("XACTUAL", 1) == -3 * TURN
    assert [round(axis.truth.rotor_fullsteps) for axis in bench.state().axes] == [200, -600]


@pytest.mark.parametrize(("model", "axis"), PLACES)
@pytest.mark.sheet("AN-001", "2")
def test_the_shorter_way_round_is_taken_past_the_end_of_the_range(model: Tmc5xxxModel, axis: int) -> None:
    """AN-001 2: the direction of a move is the sign of the 32-bit difference."""
    bench = moving(model, axis)
    bench.put(axis, RAMPMODE=HOLD)
    bench.put(axis, XACTUAL=2**31 - 1000, XTARGET=-(2**31) + 1000)
    bench.put(axis, RAMPMODE=POSITION)
    bench.wait(0.02)
    assert bench.read("VACTUAL", axis) > 0
    bench.wait(2)
    assert bench.read("XACTUAL", axis) == -(2**31) + 1000


@pytest.mark.parametrize(("model", "axis"), PLACES)
def test_a_target_behind_needs_a_second_move(model: Tmc5xxxModel, axis: int) -> None:
    bench = moving(model, axis)
    bench.put(axis, XTARGET=100_000)
    bench.wait(0.5)
    bench.clear(axis)
    assert "second_move" not in bench.flags(axis)
    bench.put(axis, XTARGET=0)
    bench.wait(2)
    assert bench.read("XACTUAL", axis) == 0
    assert "second_move" in bench.flags(axis)


@pytest.mark.parametrize("model", MODELS)
def test_tzerowait_is_told_while_it_lasts(model: Tmc5xxxModel) -> None:
    """TZEROWAIT counts 512 clocks: 31,250 of them are a second."""
    bench = moving(model)
    bench.put(TZEROWAIT=31_250, RAMPMODE=FORWARD)
    bench.wait(1)
    bench.put(RAMPMODE=BACKWARD)
    bench.wait(0.5)
    assert bench.read("VACTUAL") == 0
    assert "t_zerowait_active" in bench.flags()
    bench.wait(0.4)
    assert bench.read("VACTUAL") == 0
    bench.wait(0.6)
    assert "t_zerowait_active" not in bench.flags()
    assert bench.read("VACTUAL") < 0


@pytest.mark.parametrize(("model", "axis"), PLACES)
def test_shaft_turns_the_motor_the_other_way(model: Tmc5xxxModel, axis: int) -> None:
    bench = moving(model, axis)
    bit = 4 if model in ("tmc5130", "tmc5160", "tmc5240") else 8 + axis
    bench.write("GCONF", 1 << bit)
    bench.put(axis, XTARGET=2560)
    bench.wait(1)
    assert bench.read("XACTUAL", axis) == 2560
    assert bench.state().axes[axis].truth.rotor_fullsteps == pytest.approx(-10)


@pytest.mark.parametrize("model", MODELS)
def test_a_power_cycle_stops_forgets_and_leaves_the_plant(model: Tmc5xxxModel) -> None:
    bench = moving(model, start_fullsteps=400.0)
    bench.put(XTARGET=10 * TURN)
    bench.stage(stage={"left_at_fullsteps": -77.0}, switches={"right": True})
    bench.wait(1)
    shaft = bench.state().axes[0].truth.rotor_fullsteps
    state = bench.patch(power_cycle=True)
    bench.wait(0.1)
    assert bench.read("XACTUAL") == bench.read("XTARGET") == bench.read("VACTUAL") == 0
    assert bench.field("GSTAT", "reset") == 1
    assert state.axes[0].stage.left_at_fullsteps == -77.0
    assert state.axes[0].switches.right.forced is True
    # the field comes up at place 0 of the microstep table, at most two full steps from where the shaft was
    assert abs(bench.state().axes[0].truth.rotor_fullsteps - shaft) <= 2
    bench.wait(1)
    assert bench.read("XACTUAL") == 0
