"""When a move counts as arrived, and when as ended elsewhere."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.client.arrival import STANDSTILL_POLLS, Arrival
from app.client.errors import MoveEnded
from app.client.records import AxisState, Condition, MoveStarted

STARTED = MoveStarted(0, 1000, 5000, 0.0, 1.0, ())
MOVING = AxisState(
    position=2000,
    target_position=5000,
    velocity_pps=100.0,
    target_velocity_pps=None,
    acceleration_pps2=None,
    encoder_position=None,
    deviation=None,
    position_reached=False,
    moving=True,
    mode="ramp",
    switches={"left": False, "right": None, "home": False},
    flags={},
    time_s=0.0,
    condition=Condition("moving", "it moves", (), (), 0.0),
    referenced=None,
    ground_truth=None,
)
STANDING = replace(MOVING, moving=False, velocity_pps=0.0)


def test_at_the_target() -> None:
    arrival = Arrival(STARTED)
    assert not arrival.update(MOVING)
    assert arrival.update(replace(STANDING, position=5000, position_reached=True))


def test_passing_the_target_is_not_arriving() -> None:
    assert not Arrival(STARTED).update(replace(MOVING, position=5000, position_reached=True))


def test_a_turning_point_is_no_end() -> None:
    arrival = Arrival(STARTED)
    for _ in range(5):
        for _ in range(STANDSTILL_POLLS - 1):
            assert not arrival.update(STANDING)
        assert not arrival.update(MOVING)


def test_standing_elsewhere_ends_it_and_names_the_switch() -> None:
    arrival = Arrival(STARTED)
    state = replace(STANDING, switches={"left": False, "right": True, "home": False})
    for _ in range(STANDSTILL_POLLS - 1):
        assert not arrival.update(state)
    with pytest.raises(MoveEnded, match="right") as ended:
        arrival.update(state)
    assert (ended.value.position, ended.value.target) == (2000, 5000)


def test_another_target_ends_it_at_once() -> None:
    with pytest.raises(MoveEnded, match="7000"):
        Arrival(STARTED).update(replace(MOVING, target_position=7000))


@given(st.integers(-(1 << 31), (1 << 31) - 1), st.integers(-(1 << 31), (1 << 31) - 1), st.floats(0, 1))
def test_the_share_of_the_way(start: int, target: int, done: float) -> None:
    arrival = Arrival(replace(STARTED, from_position=start, target_position=target))
    share = arrival.share(replace(MOVING, position=round(start + done * (target - start))))
    assert 0.0 <= share <= 1.0
    if abs(target - start) > 1000:
        assert share == pytest.approx(done, abs=1e-3)
