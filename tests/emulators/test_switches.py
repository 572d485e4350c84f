"""Switches, stops, latch and interrupts: DS-TMC428 sections 8.12, 8.13, 8.15, 8.16, 9.6 to 9.10; DS-TMC4210 1.5.4."""

from __future__ import annotations

import pytest

from app.emulators.tmc428.options import StageOptions
from tests.emulators.harness import (
    CONTINUOUS,
    DX_REF,
    GLOBAL,
    HOLD,
    INTERRUPT,
    MODE,
    MOT1R,
    NO_STOPS,
    RAMP,
    REFMUX,
    SWITCHES,
    V_ACTUAL,
    V_TARGET,
    VELOCITY,
    X_ACTUAL,
    X_LATCHED,
    X_TARGET,
    Bench,
)

SHORT = StageOptions(
    left_at_fullsteps=-50.0,
    right_at_fullsteps=50.0,
    ref_from_fullsteps=-20.0,
    ref_to_fullsteps=-10.0,
    start_fullsteps=0.0,
)
"""50 full steps to either side, 3200 microsteps of the TMC428."""
SOFT_STOP, REF_RIGHT = 1 << 10, 1 << 11
POS_END, REF_WRONG, REF_MISS, STOP, LEFT_LOW, RIGHT_LOW, LEFT_HIGH, RIGHT_HIGH = (1 << bit for bit in range(8))


def rig(parameters: int = REFMUX | CONTINUOUS | 0x702, wiring: str = "multiplexed", flags: int = 0) -> Bench:
    """Three axes on short stages in VELOCITY_MODE, all interrupts watched."""
    bench = Bench(stages=[SHORT] * 3, options={"wiring": wiring})
    bench.three_drivers(parameters)
    for axis in range(3):
        bench.ramp(axis, mode=VELOCITY, flags=flags, dividers=0x4406)
        bench.write(axis << 4 | INTERRUPT, 0xFF00)
    return bench


def run(bench: Bench, velocity: int, seconds: float = 0.8) -> None:
    bench.write(V_TARGET, velocity)
    bench.seconds(seconds)


@pytest.mark.sheet("DS-TMC428", "8.12")
@pytest.mark.sheet("DS-TMC428", "9.7")
@pytest.mark.parametrize(("velocity", "stop_at"), [(-900, -10.0), (900, 50.0)])
def test_an_active_switch_stops_motion_towards_it_at_once(velocity: int, stop_at: float) -> None:
    """Moving left the reference switch comes first: it is wired or with the left one (9.8)."""
    bench = rig()
    run(bench, velocity)
    assert bench.v == 0
    assert bench.place() == pytest.approx(stop_at, abs=0.1)
    run(bench, -velocity, 0.05)
    assert bench.v == -velocity


@pytest.mark.sheet("DS-TMC428", "8.12")
@pytest.mark.parametrize(("flags", "velocity"), [(0x100, -900), (0x200, 900)])
def test_a_disabled_stop_lets_the_motor_pass(flags: int, velocity: int) -> None:
    bench = rig(flags=flags)
    run(bench, velocity)
    assert bench.v == velocity
    assert abs(bench.place()) > 50
    run(bench, -velocity, 2.0)
    assert bench.v == 0


@pytest.mark.sheet("DS-TMC428", "8.12")
def test_soft_stop_keeps_to_the_linear_ramp_and_hard_stop_does_not() -> None:
    for flags, steps in ((0, 0), (SOFT_STOP, 900 * 900 * 256 // 200 // 2 // 2048)):
        bench = rig(flags=flags)
        bench.write(0x06, 200)
        run(bench, 900, 1.5)
        assert bench.v == 0
        assert (bench.place() - 50) * 64 == pytest.approx(steps, abs=5)
        assert bench.read(INTERRUPT) & STOP


@pytest.mark.sheet("DS-TMC428", "8.12")
def test_the_choice_of_reference_switch_does_not_touch_the_stop_function() -> None:
    for flags in (0, REF_RIGHT):
        bench = rig(flags=flags)
        run(bench, 900)
        assert bench.v == 0
        assert bench.place() == pytest.approx(50, abs=0.1)


@pytest.mark.sheet("DS-TMC428", "8.12")
@pytest.mark.sheet("DS-TMC428", "6.4")
def test_the_status_bit_is_the_chosen_reference_switch() -> None:
    bench = rig(flags=NO_STOPS)
    bench.switch(left=True)
    bench.seconds(0.1)
    bench.read(0)
    assert bench.status & 2
    bench.write(MODE, VELOCITY | NO_STOPS | REF_RIGHT)
    bench.read(0)
    assert not bench.status & 2
    bench.switch(right=True)
    bench.seconds(0.1)
    bench.read(0)
    assert bench.status & 2


@pytest.mark.sheet("DS-TMC428", "9.7")
def test_a_stopped_motor_restarts_when_its_switch_is_released() -> None:
    bench = rig()
    bench.switch(right=True)
    run(bench, 600)
    assert bench.v == 0
    bench.switch(right=False)
    bench.seconds(0.05)
    assert bench.v == 600


@pytest.mark.sheet("DS-TMC428", "9.7")
def test_without_continuous_update_multiplexed_switches_are_not_seen_at_rest() -> None:
    bench = rig(REFMUX | 0x702)
    bench.switch(left=True, right=True)
    bench.seconds(1.0)
    assert bench.read(SWITCHES) == 0
    bench.write(0x33, 0)  # any datagram samples them
    assert bench.read(SWITCHES) == 0b000011
    bench.switch(left=False, right=False)
    bench.seconds(1.0)
    assert bench.read(SWITCHES) == 0b000011
    run(bench, 500)
    assert bench.v == 0  # stays at rest: nothing sends a datagram
    bench.write(GLOBAL, REFMUX | CONTINUOUS | 0x702)
    bench.seconds(0.05)
    assert (bench.read(SWITCHES), bench.v) == (0, 500)


@pytest.mark.sheet("DS-TMC428", "9.7")
@pytest.mark.parametrize("refmux", [0, 1])
@pytest.mark.parametrize("mot1r", [0, 1])
@pytest.mark.parametrize("wiring", ["left-only", "two-one-null", "multiplexed"])
def test_association_of_reference_inputs(refmux: int, mot1r: int, wiring: str) -> None:
    """Table 9-3: which input is whose switch, whatever board the chip sits on."""
    bench = rig(refmux * REFMUX | mot1r * MOT1R | CONTINUOUS | 0x702, wiring)
    for axis in range(3):
        for side in ("left", "right"):
            bench.switch(axis, **{side: True})
            bench.seconds(0.05)
            # What the pin levels are with this switch pressed: (at rest, during a datagram)
            pins = [(0, 0)] * 3
            if wiring == "multiplexed":
                pins[axis] = (1, 0) if side == "left" else (0, 1)
            elif side == "left" and not (wiring == "two-one-null" and axis == 2):
                pins[axis] = (1, 1)
            elif wiring == "two-one-null" and (axis, side) == (0, "right"):
                pins[2] = (1, 1)
            if refmux:
                expected = [pins[0][1], pins[0][0], pins[1][1], pins[1][0], pins[2][1], pins[2][0]]
            elif mot1r:
                expected = [pins[2][0], pins[0][0], 0, pins[1][0], 0, 0]
            else:
                expected = [0, pins[0][0], 0, pins[1][0], 0, pins[2][0]]
            assert bench.read(SWITCHES) == sum(level << bit for bit, level in enumerate(expected)), (axis, side)
            bench.switch(axis, **{side: "auto"})
            bench.seconds(0.05)


@pytest.mark.sheet("DS-TMC428", "9.6")
def test_the_switch_register_shows_the_demultiplexed_switches() -> None:
    bench = rig()
    for bit, (axis, side) in enumerate((axis, side) for axis in range(3) for side in ("right", "left")):
        bench.switch(axis, **{side: True})
        bench.seconds(0.05)
        assert bench.read(SWITCHES) == 1 << bit
        bench.switch(axis, **{side: False})


@pytest.mark.sheet("DS-TMC428", "8.13")
def test_switch_edges_set_their_flags() -> None:
    bench = rig()
    for side, active, flag in (
        ("left", True, LEFT_HIGH),
        ("left", False, LEFT_LOW),
        ("right", True, RIGHT_HIGH),
        ("right", False, RIGHT_LOW),
    ):
        bench.write(INTERRUPT, 0xFFFF)
        bench.switch(**{side: active})
        bench.seconds(0.05)
        flags = bench.read(INTERRUPT) & 0xF0
        assert flags == flag
        assert bench.status & 0x80


@pytest.mark.sheet("DS-TMC428", "8.13")
@pytest.mark.sheet("DS-TMC428", "6.4")
def test_flags_clear_by_one_stay_by_zero_and_fall_with_their_mask() -> None:
    bench = rig(flags=NO_STOPS)
    bench.switch(left=True)
    bench.seconds(0.05)
    bench.switch(left=False)
    bench.seconds(0.05)
    bench.write(INTERRUPT, 0xFF00 | REF_WRONG | REF_MISS)
    both = LEFT_HIGH | LEFT_LOW
    assert bench.read(INTERRUPT) == 0xFF00 | both
    bench.write(INTERRUPT, 0xFF00)
    assert bench.read(INTERRUPT) == 0xFF00 | both
    bench.write(INTERRUPT, 0xFF00 | LEFT_LOW)
    assert bench.read(INTERRUPT) == 0xFF00 | LEFT_HIGH
    assert bench.status & 0x80
    bench.write(INTERRUPT, 0xBF00)
    assert bench.read(INTERRUPT) == 0xBF00
    assert not bench.status & 0x80
    bench.write(INTERRUPT, 0xFF00)
    assert bench.read(INTERRUPT) == 0xFF00


@pytest.mark.sheet("DS-TMC428", "8.13")
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_flag_without_mask_is_never_set_and_any_motor_raises_int(axis: int) -> None:
    bench = rig(flags=NO_STOPS)
    for each in range(3):
        bench.write(each << 4 | INTERRUPT, 0x00FF)
    bench.switch(axis, left=True)
    bench.seconds(0.05)
    assert bench.read(axis << 4 | INTERRUPT) == 0
    assert not bench.status & 0x80
    bench.write(axis << 4 | INTERRUPT, LEFT_LOW << 8)
    bench.switch(axis, left=False)
    bench.seconds(0.05)
    bench.read(0)
    assert bench.status & 0x80


@pytest.mark.sheet("DS-TMC428", "8.13")
def test_int_stop_means_a_stop_during_motion() -> None:
    bench = rig()
    bench.switch(right=True)
    bench.seconds(0.05)
    assert not bench.read(INTERRUPT) & STOP
    bench.switch(right=False)
    run(bench, 700, 0.05)
    bench.switch(right=True)
    bench.seconds(0.05)
    assert bench.read(INTERRUPT) & STOP


@pytest.mark.sheet("DS-TMC428", "8.13")
@pytest.mark.sheet("DS-TMC428", "8.15")
def test_reference_switch_active_outside_and_missing_inside_the_tolerance() -> None:
    bench = rig(flags=NO_STOPS)
    bench.write(DX_REF, 100)
    bench.write(X_ACTUAL, 50)
    bench.write(INTERRUPT, 0xFFFF)
    bench.switch(left=True)
    bench.seconds(0.05)
    assert not bench.read(INTERRUPT) & (REF_WRONG | REF_MISS)
    bench.write(X_ACTUAL, 101)
    assert bench.read(INTERRUPT) & REF_WRONG
    bench.write(INTERRUPT, 0xFFFF)
    bench.write(X_ACTUAL, 0)
    assert not bench.read(INTERRUPT) & REF_MISS
    bench.write(X_ACTUAL, 10)
    bench.switch(left=False)
    bench.seconds(0.05)
    assert not bench.read(INTERRUPT) & REF_MISS
    bench.write(X_ACTUAL, 0)
    assert bench.read(INTERRUPT) & REF_MISS


@pytest.mark.sheet("DS-TMC428", "8.15")
@pytest.mark.sheet("DS-TMC428", "8.12")
@pytest.mark.parametrize("tolerance", [1, 40, 300])
def test_within_the_tolerance_switches_do_not_stop(tolerance: int) -> None:
    bench = rig()
    bench.switch(left=True)
    bench.seconds(0.05)
    bench.write(DX_REF, tolerance)
    run(bench, -400)
    assert (bench.v, bench.x) == (0, -tolerance - 1)


@pytest.mark.sheet("DS-TMC428", "8.15")
def test_no_tolerance_means_no_exception_even_at_zero() -> None:
    bench = rig()
    bench.switch(left=True)
    bench.seconds(0.05)
    run(bench, -400)
    assert bench.x == 0


@pytest.mark.sheet("DS-TMC428", "8.16")
@pytest.mark.sheet("DS-TMC428", "8.12")
@pytest.mark.parametrize("flags", [0, REF_RIGHT])
def test_the_latch_takes_the_position_of_the_next_switch_edge(flags: int) -> None:
    bench = rig(flags=NO_STOPS | flags)
    run(bench, 900 if flags else -900, 0.01)
    bench.write(X_LATCHED, 0x123456)
    assert bench.read(X_LATCHED) == 0
    assert bench.read(MODE) >> 16 == 1
    bench.seconds(1.0)
    assert bench.read(MODE) >> 16 == 0
    edge = 50 * 64 if flags else -10 * 64
    assert bench.signed(X_LATCHED) == pytest.approx(edge, abs=3)


@pytest.mark.sheet("DS-TMC428", "8.16")
def test_the_latch_waits_while_the_motor_stands_still() -> None:
    bench = rig(flags=NO_STOPS)
    bench.write(X_ACTUAL, 77)
    bench.write(X_LATCHED, 0)
    bench.switch(left=True)
    bench.seconds(0.05)
    bench.switch(left=False)
    bench.seconds(0.05)
    assert (bench.read(X_LATCHED), bench.read(MODE) >> 16) == (0, 1)


@pytest.mark.sheet("DS-TMC428", "8.12")
def test_lp_cannot_be_written() -> None:
    bench = rig()
    bench.write(MODE, 1 << 16 | VELOCITY)
    assert bench.read(MODE) >> 16 == 0


@pytest.mark.sheet("DS-TMC428", "9.9")
@pytest.mark.sheet("DS-TMC428", "9.8")
@pytest.mark.sheet("DS-TMC428", "8.15")
def test_reference_search_finds_both_edges_and_centres() -> None:
    """The sheet's procedure: latch one edge, pass through, latch the other, centre, call it zero."""
    bench = rig()
    bench.write(MODE, RAMP)
    bench.write(X_LATCHED, 0)
    bench.write(X_TARGET, -20_000)
    bench.seconds(1.0)
    first = bench.signed(X_LATCHED)
    assert (bench.v, bench.x) == (0, first)
    bench.write(X_TARGET, first)
    bench.write(X_ACTUAL, 0)
    bench.write(X_TARGET, 0)
    bench.write(DX_REF, 1000)
    bench.write(X_LATCHED, 0)
    bench.write(X_TARGET, -800)
    bench.seconds(1.0)
    second = bench.signed(X_LATCHED)
    assert second == pytest.approx(-640, abs=3)
    bench.write(X_TARGET, second // 2)
    bench.seconds(1.0)
    assert bench.place() == pytest.approx(-15, abs=0.1)
    bench.write(0x03, 0)
    bench.write(X_TARGET, 0)
    bench.write(X_ACTUAL, 0)
    bench.write(0x03, 2047)
    bench.seconds(0.1)
    assert bench.x == 0
    assert bench.place() == pytest.approx(-15, abs=0.1)


@pytest.mark.sheet("DS-TMC428", "9.10")
def test_three_motors_start_together_when_their_common_gate_opens() -> None:
    bench = rig()
    for axis in range(3):
        bench.switch(axis, right=True)
    bench.seconds(0.05)
    for axis in range(3):
        bench.write(axis << 4 | V_TARGET, 800)
        bench.seconds(0.05)
    assert [bench.read(axis << 4 | X_ACTUAL) for axis in range(3)] == [0, 0, 0]
    bench.patch(switches=[{"axis": axis, "right": False} for axis in range(3)])
    bench.seconds(0.05)
    positions = [bench.read(axis << 4 | X_ACTUAL) for axis in range(3)]
    assert positions[0] > 0
    assert len(set(positions)) == 1


@pytest.mark.sheet("DS-TMC428", "8.12")
def test_hold_mode_obeys_stop_switches_too() -> None:
    bench = rig()
    bench.write(MODE, HOLD)
    bench.write(V_ACTUAL, 1000)
    bench.seconds(0.8)
    assert bench.v == 0
    bench.write(V_ACTUAL, 1000)
    assert bench.v == 0
    bench.write(V_ACTUAL, -1000)
    assert bench.v == -1000


@pytest.mark.sheet("DS-TMC4210", "7.1")
@pytest.mark.sheet("DS-TMC4210", "1.5.4")
@pytest.mark.parametrize("mot1r", [0, 1])
def test_the_right_switch_of_the_tmc4210_has_to_be_initialised(mot1r: int) -> None:
    bench = Bench("tmc4210", stages=[SHORT])
    bench.ramp(mode=VELOCITY, flags=0)
    bench.write(0x34, 0x20)
    bench.write(GLOBAL, mot1r << 21)
    run(bench, 900)
    assert bench.v == (0 if mot1r else 900)
    assert (bench.place() > 60) == (not mot1r)


@pytest.mark.sheet("DS-TMC4210", "6.2.1")
@pytest.mark.sheet("DS-TMC4210", "1.5.4")
@pytest.mark.sheet("DS-TMC4210", "2.2")
def test_inverted_switch_inputs_of_the_tmc4210() -> None:
    bench = Bench("tmc4210", stages=[SHORT])
    bench.write(GLOBAL, MOT1R)
    assert bench.read(SWITCHES) == 0
    bench.write(0x34, 1)
    assert bench.read(SWITCHES) == 0b11
    bench.switch(left=True)
    assert bench.read(SWITCHES) == 0b01


def rig_4210(flags: int = 0) -> Bench:
    """A TMC4210 on a short stage, both switches in use, driver at 16 microsteps."""
    bench = Bench("tmc4210", stages=[SHORT])
    bench.write(0x34, 0x20)
    bench.write(GLOBAL, MOT1R | 0xF00)
    bench.ramp(mode=VELOCITY, flags=flags, dividers=0x4400)
    bench.write(INTERRUPT, 0xFF00)
    return bench


@pytest.mark.sheet("DS-TMC4210", "6.1.10")
@pytest.mark.parametrize(
    ("flags", "velocity", "stops"), [(0, -900, True), (0, 900, True), (0x100, -900, False), (0x200, 900, False)]
)
def test_stop_switches_of_the_tmc4210(flags: int, velocity: int, stops: bool) -> None:
    bench = rig_4210(flags)
    run(bench, velocity, 0.5)
    assert (bench.v == 0) == stops
    assert bool(bench.read(INTERRUPT) & STOP) == stops


@pytest.mark.sheet("DS-TMC4210", "6.1.10")
def test_soft_stop_of_the_tmc4210() -> None:
    bench = rig_4210(SOFT_STOP)
    bench.write(0x06, 300)
    run(bench, 900, 0.5)
    assert bench.v == 0
    assert bench.place() > 50.5


@pytest.mark.sheet("DS-TMC4210", "6.1.13")
@pytest.mark.sheet("DS-TMC4210", "6.1.14")
@pytest.mark.sheet("DS-TMC4210", "7.2")
@pytest.mark.sheet("DS-TMC4210", "7.3")
def test_homing_with_three_switches_on_the_tmc4210() -> None:
    """Stop at one edge of the reference switch, pass it within the tolerance, latch the other, centre."""
    bench = rig_4210()
    bench.write(MODE, RAMP)
    bench.write(X_LATCHED, 0)
    bench.write(X_TARGET, -20_000)
    bench.seconds(0.5)
    assert (bench.v, bench.read(MODE) >> 16) == (0, 0)
    assert bench.x == bench.signed(X_LATCHED)
    assert bench.place() == -10
    bench.write(MODE, VELOCITY)
    bench.write(V_TARGET, 0)
    bench.write(X_ACTUAL, 0)
    bench.write(X_TARGET, 0)
    bench.write(DX_REF, 400)
    bench.write(X_LATCHED, 0)
    bench.write(MODE, RAMP)
    bench.write(X_TARGET, -300)
    bench.seconds(0.5)
    assert bench.signed(X_LATCHED) == pytest.approx(-160, abs=1)
    bench.write(X_TARGET, -80)
    bench.seconds(0.5)
    assert bench.place() == pytest.approx(-15, abs=0.1)
    bench.write(X_TARGET, -9000)
    bench.seconds(1.0)
    assert bench.v == 0
    assert bench.place() == pytest.approx(-50, abs=0.1)  # outside the tolerance the left switch does stop
