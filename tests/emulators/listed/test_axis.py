"""The trapezoid of a plain axis, against the textbook's durations and against itself in other steps."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.emulators.listed.axis import Axis

SPEEDS = st.integers(1, 1_000_000)
TARGETS = st.integers(-1_000_000, 1_000_000)


def axis_with(speed: int, acceleration: int) -> Axis:
    axis = Axis()
    axis.max_speed, axis.acceleration = speed, acceleration
    return axis


def textbook_s(way: int, speed: int, acceleration: int) -> float:
    """From rest to rest."""
    way = abs(way)
    if way * acceleration < speed**2:
        return 2 * math.sqrt(way / acceleration)
    return way / speed + speed / acceleration


@given(TARGETS, SPEEDS, SPEEDS)
def test_a_move_takes_as_long_as_the_textbook_says(target: int, speed: int, acceleration: int) -> None:
    axis, takes_s = axis_with(speed, acceleration), textbook_s(target, speed, acceleration)
    axis.go_to(target)
    axis.run(takes_s * 0.999)
    assert target == 0 or not axis.reached
    axis.run(takes_s * 0.002 + 1e-6)
    assert axis.reached
    assert (axis.counter, axis.speed) == (target, 0)


@given(TARGETS, SPEEDS, SPEEDS, st.lists(st.floats(0.001, 2), min_size=1, max_size=20))
def test_it_does_not_matter_in_how_many_steps_time_passes(
    target: int, speed: int, acceleration: int, steps: list[float]
) -> None:
    once, often = axis_with(speed, acceleration), axis_with(speed, acceleration)
    for axis in (once, often):
        axis.go_to(target)
    for step_s in steps:
        often.run(step_s)
        assert abs(often.speed) <= speed * (1 + 1e-9)
    once.run(sum(steps))
    assert often.position == pytest.approx(once.position, abs=1e-3 + 1e-6 * abs(target))


@given(TARGETS, TARGETS, SPEEDS, SPEEDS, st.floats(0, 10))
def test_a_new_target_on_the_way_is_reached_too(
    first: int, second: int, speed: int, acceleration: int, after_s: float
) -> None:
    axis = axis_with(speed, acceleration)
    axis.go_to(first)
    axis.run(after_s)
    before = axis.speed
    axis.go_to(second)
    axis.run(1e-9)
    assert abs(axis.speed - before) <= acceleration * 1e-9 * (1 + 1e-6) + 1e-9 + math.sqrt(4e-6 * acceleration)
    axis.run(1e8)
    axis.run(1.0)
    assert axis.reached
    assert axis.counter == second


def test_a_rotation_goes_on_and_a_stop_ends_it() -> None:
    axis = axis_with(100, 50)
    axis.turn(-200)  # a rotation is not held to the speed of positioning
    axis.run(10.0)
    assert axis.speed == -200
    assert axis.position == -(200 * 4 / 2 + 200 * 6)
    axis.turn(0)
    axis.run(3.9)
    assert axis.speed == pytest.approx(-5)
    axis.run(0.2)
    assert axis.rests
    assert axis.speed == 0
    assert not axis.reached  # it was told no target


def test_without_speed_or_acceleration_nothing_moves() -> None:
    for speed, acceleration in ((0, 10), (10, 0)):
        axis = axis_with(speed, acceleration)
        axis.go_to(100)
        axis.run(100.0)
        assert (axis.counter, axis.rests, axis.reached) == (0, True, False)


def test_the_counter_wraps_and_can_be_set() -> None:
    axis = axis_with(1000, 1000)
    axis.set_position((1 << 31) - 1)
    axis.turn(10)
    axis.run(1.0)
    assert axis.counter < 0
    axis.turn(0)
    axis.run(1.0)
    axis.set_position(7)
    assert axis.counter == 7
