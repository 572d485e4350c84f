"""The motor data base: what its list says is sound, and is found by words as people write them."""

from __future__ import annotations

import math

import pytest

from app.calc.motors.data_base import found, listed


def test_every_motor_of_the_list_can_be() -> None:
    motors = listed()
    assert len({motor.name for motor in motors}) == len(motors) >= 200
    for motor in motors:
        assert 0.1 <= motor.rated_current_a <= 10, motor
        assert motor.full_steps_per_rev in (48, 200, 400), motor
        assert motor.resistance_ohm is not None
        assert 0.1 <= motor.resistance_ohm <= 100, motor
        assert motor.inductance_h is not None
        assert 1e-4 <= motor.inductance_h <= 0.1, motor
        assert motor.holding_torque_nm is None or 0.005 <= motor.holding_torque_nm <= 20, motor
        # heat at rest with both coils at the rated current: less than a soldering iron
        assert 2 * motor.rated_current_a**2 * motor.resistance_ohm < 60, motor


def test_what_no_motor_of_that_size_has_is_not_told() -> None:
    (motor,) = [each for each in listed() if each.name == "ldo-42sth34-1004l321e"]
    assert motor.holding_torque_nm is None
    assert math.isclose(motor.rated_current_a, 1.0)


@pytest.mark.parametrize("words", ["42STH48 2504", "ldo 42sth48-2504ac", "LDO42sth48 2504AC"])
def test_words_find_a_motor(words: str) -> None:
    assert "ldo-42sth48-2504ac" in [motor.name for motor in found(listed(), words)]


def test_no_word_finds_all_and_a_strange_one_none() -> None:
    assert len(found(listed(), "  ")) == len(listed())
    assert found(listed(), "perpetuum mobile") == []
