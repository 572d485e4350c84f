"""Scores of recordings whose answer is known in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.calc.signals.step_response import score

TIME_S = np.linspace(-0.1, 1.0, 11_001)


def test_a_damped_swing_has_the_overshoot_of_the_textbook() -> None:
    """A second-order system of damping z overshoots by exp(-pi z / sqrt(1 - z^2))."""
    damping, rate = 0.3, 60.0
    damped = rate * math.sqrt(1 - damping**2)
    t = np.maximum(TIME_S, 0)
    slope = damping / math.sqrt(1 - damping**2)
    swing = np.exp(-damping * rate * t) * (np.cos(damped * t) + slope * np.sin(damped * t))
    encoder = np.where(TIME_S < 0, 0.0, 1000 * (1 - swing))
    command = np.where(TIME_S < 0, 0.0, 1000.0)
    result = score(TIME_S, 1000.0, command, encoder, 20.0, 1000.0)
    expected = math.exp(-math.pi * damping / math.sqrt(1 - damping**2))
    assert result.overshoot_ratio == pytest.approx(expected, rel=1e-3)
    assert result.arrival_s == pytest.approx(0.0, abs=1e-3)
    # The envelope is inside 2 % from 4 / (z w) on, roughly; the swing itself a little earlier.
    assert result.settling_s is not None
    assert 0.1 < result.settling_s < 0.235
    assert result.final_error == pytest.approx(0.0, abs=1e-3)


def test_a_triangle_of_deviation_has_its_integrals() -> None:
    deviation = np.clip(1 - np.abs(TIME_S - 0.5) / 0.1, 0, None) * 30.0
    result = score(TIME_S, 0.0, np.zeros_like(TIME_S), deviation, 5.0)
    assert result.iae == pytest.approx(3.0, rel=1e-4)
    assert result.peak == pytest.approx(30.0)
    assert result.rms == pytest.approx(30 * math.sqrt(0.2 / 3), rel=1e-3)
    assert result.settling_s == pytest.approx(0.5 + 0.1 * (1 - 5 / 30), abs=2e-4)
    assert result.overshoot == 0
    assert result.overshoot_ratio is None


def test_the_rebound_after_a_load_is_the_overshoot() -> None:
    encoder = np.where(TIME_S < 0.5, -40.0, 0.0) + np.where((TIME_S > 0.5) & (TIME_S < 0.6), 12.0, 0.0)
    result = score(TIME_S, 0.0, np.zeros_like(TIME_S), encoder, 5.0)
    assert result.overshoot == 12.0


def test_a_negative_step_counts_its_own_way() -> None:
    encoder = np.where(TIME_S < 0, 0.0, -103.0)
    result = score(TIME_S, -100.0, np.where(TIME_S < 0, 0.0, -100.0), encoder, 1.0, -100.0)
    assert result.overshoot == pytest.approx(3.0)
    assert result.settling_s is None


def test_unknown_rows_are_left_out_and_nothing_cannot_be_scored() -> None:
    encoder = np.zeros_like(TIME_S)
    encoder[::2] = np.nan
    assert score(TIME_S, 0.0, np.zeros_like(TIME_S), encoder, 1.0).peak == 0
    with pytest.raises(ValueError, match="two samples"):
        score(TIME_S, 0.0, np.zeros_like(TIME_S), np.full_like(TIME_S, np.nan), 1.0)
    with pytest.raises(ValueError, match="band"):
        score(TIME_S, 0.0, np.zeros_like(TIME_S), encoder, 0.0)
