"""The holding torque by a back-EMF constant, and two figures of it as one."""

from __future__ import annotations

import math

import pytest

from app.calc.motors.holding_torque import agreed, torque_by_back_emf
from app.calc.motors.ring_down import Fitted


def test_the_torque_of_two_coils_with_sine_and_cosine() -> None:
    """The rotor's torque at its worst load angle, summed over both coils: k I sqrt(2) (sin^2 + cos^2)."""
    k, rms = 0.2, 1.5
    for electrical in (0.0, 0.4, 1.0, 2.0):
        coils = [rms * math.sqrt(2) * wave(electrical) * k * wave(electrical) for wave in (math.sin, math.cos)]
        assert torque_by_back_emf(Fitted(k, 0.02), rms).value == pytest.approx(sum(coils))
    assert torque_by_back_emf(Fitted(k, 0.02), rms).half == pytest.approx(0.1 * k * rms * math.sqrt(2))


def test_the_surer_figure_has_more_weight_and_both_are_surer_than_each() -> None:
    found = agreed(Fitted(1.0, 0.1), Fitted(1.15, 0.2))
    assert found is not None
    assert found.value == pytest.approx(1.03)
    assert found.half == pytest.approx(0.1 * 0.2 / math.hypot(0.1, 0.2))


def test_two_figures_that_have_nothing_in_common_are_not_one() -> None:
    assert agreed(Fitted(1.0, 0.1), Fitted(2.0, 0.2)) is None
