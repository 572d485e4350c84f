"""From samples to the numbers of an axis."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.twin.shape import AxisPose, Shape, Slips, Travel, look_of

STAGE = Shape("bench", 0, "X", microsteps=16, travel_mm_per_rev=8.0)
TABLE = Shape("pair", 1, "turn", microsteps=256, gear_ratio=5.0)


def test_a_turn_of_the_motor_is_a_pitch_of_the_stage() -> None:
    look = look_of(STAGE, 1.0, {"position": 3200.0 * 2.5})
    assert look.commanded_deg == pytest.approx(900.0)
    assert look.place_commanded == pytest.approx(20.0)
    assert (look.measured_deg, look.place_measured) == (None, None)


def test_a_table_turns_as_much_slower_as_its_gear() -> None:
    look = look_of(TABLE, 1.0, {"position": 51_200.0, "encoder_position": 51_200.0 * 1.5})
    assert look.place_commanded == pytest.approx(72.0)
    assert look.place_measured == pytest.approx(108.0)


def test_what_no_sample_tells_is_missing() -> None:
    assert look_of(STAGE, None, {}) == AxisPose()
    everything_nan = dict.fromkeys(("position", "mscnt", "current_a", "load_angle", "switch_left"), math.nan)
    assert look_of(STAGE, 1.0, everything_nan, Slips(4, 1, 0.5)) == AxisPose(time_s=1.0)


def test_without_the_microstep_resolution_a_position_is_no_angle() -> None:
    unknown = Shape("bench", 0, "X", microsteps=None, travel_mm_per_rev=8.0)
    look = look_of(unknown, 1.0, {"position": 3200.0, "deviation": 3.0})
    assert look.position == 3200.0
    assert (look.commanded_deg, look.place_commanded, look.field_deg, look.load_deg) == (None, None, None, None)


@pytest.mark.parametrize(
    ("values", "field_deg", "told_by"),
    [
        ({"mscnt": 256.0, "position": 0.0}, 90.0, "mscnt"),
        ({"current_a": 0.0, "current_b": 248.0}, 0.0, "currents"),
        ({"current_a": 248.0, "current_b": 0.0}, 90.0, "currents"),
        ({"current_a": -100.0, "current_b": -100.0}, 225.0, "currents"),
        ({"current_a": 0.0, "current_b": 1.0, "position": 16.0}, 90.0, "position"),  # no current points nowhere
        ({"position": 16.0 * 5}, 90.0, "position"),  # a full step is 90 degrees
        ({"position": -16.0}, 270.0, "position"),
        ({}, None, None),
    ],
)
def test_the_field_points_where_the_best_source_says(
    values: dict[str, float], field_deg: float | None, told_by: str | None
) -> None:
    look = look_of(STAGE, 0.0, values)
    assert look.field_from == told_by
    assert look.field_deg == (None if field_deg is None else pytest.approx(field_deg))


def test_currents_are_shares_of_the_full_one() -> None:
    look = look_of(STAGE, 0.0, {"current_a": -128.0, "current_b": 300.0})
    assert (look.current_a, look.current_b) == (-0.5, 1.0)
    assert look.field_share == pytest.approx(math.hypot(0.5, 1.0))


def test_the_rotor_lags_the_field_by_the_load_angle() -> None:
    by_encoder = look_of(STAGE, 0.0, {"mscnt": 256.0, "deviation": -8.0})
    assert (by_encoder.load_deg, by_encoder.load_from) == (45.0, "deviation")
    assert by_encoder.rotor_deg == pytest.approx(45.0)
    by_family = look_of(STAGE, 0.0, {"mscnt": 0.0, "deviation": -8.0, "load_angle": 30.0})
    assert (by_family.load_deg, by_family.load_from) == (30.0, "load_angle")
    assert by_family.rotor_deg == pytest.approx(330.0)


def test_no_encoder_no_lost_steps() -> None:
    assert look_of(STAGE, 1.0, {"position": 0.0}, Slips()).slips is None
    assert look_of(STAGE, 1.0, {"deviation": 0.0}, Slips()).slips == Slips()


@pytest.mark.parametrize("name", ["switch_home", "switch_reference"])
def test_both_names_of_the_home_switch_are_one(name: str) -> None:
    assert look_of(STAGE, 0.0, {name: 1.0}).switch_home is True
    assert look_of(STAGE, 0.0, {name: 0.0}).switch_home is False


NUMBERS = st.floats(-1e9, 1e9)


@given(st.dictionaries(st.sampled_from(["position", "encoder_position", "deviation", "mscnt", "current_a"]), NUMBERS))
def test_a_look_survives_the_way_to_the_drawing_process(values: dict[str, float]) -> None:
    look = look_of(STAGE, 2.0, values, Slips(4, 1, 1.5), Travel(-40.0, 40.0, left_mm=-39.0))
    assert AxisPose.of_message(look.message()) == look
    assert Shape.of_message(STAGE.message()) == STAGE


def test_a_message_of_another_version_loses_only_what_is_new() -> None:
    message: dict[str, Any] = {"position": 1.0, "from_tomorrow": 2}
    assert AxisPose.of_message(message) == AxisPose(position=1.0)
