"""Resistance and back-EMF from PWM amplitudes, against the voltage equation that made them."""

from __future__ import annotations

import math

import pytest

from app.calc.motors.pwm_amplitude import PwmScale, Turning, back_emf_of, resistance_of
from app.calc.motors.ring_down import Fitted

SCALE = PwmScale(24 * 248 / 65536, 2.1)
R, L, K, TEETH = 2.3, 4.4e-3, 0.21, 50.0


def amplitude(omega: float, sine: float, inductance_h: float = L) -> float:
    """Of a motor that turns with that sine of its load angle [counts]."""
    angle, reactance = math.asin(sine), TEETH * omega * inductance_h
    current = SCALE.current_a
    along = R * current * math.cos(angle) - reactance * current * math.sin(angle)
    across = R * current * math.sin(angle) + reactance * current * math.cos(angle) + K * omega
    return math.hypot(along, across) / SCALE.counts_v


def test_a_resistance_is_the_amplitude_at_rest_and_its_interval_is_of_counts_and_of_what_was_told() -> None:
    exact = R * SCALE.current_a / SCALE.counts_v
    found = resistance_of(round(exact), SCALE)
    assert abs(found.value - R) < found.half
    assert found.half < 0.05 * R
    assert resistance_of(10, SCALE).half / resistance_of(10, SCALE).value > found.half / found.value


def test_the_back_emf_of_a_rounded_amplitude_is_in_its_interval_also_with_another_inductance() -> None:
    for sine, off in ((0.0, 1.0), (0.1, 1.15), (0.3, 0.85)):
        turning = Turning(round(amplitude(12.0, sine, off * L)), 12.0, TEETH, L, Fitted(sine, 0.05))
        found = back_emf_of(turning, Fitted(R, 0.05), SCALE)
        assert abs(found.value - K) < found.half
    even = Turning(amplitude(12.0, 0.1), 12.0, TEETH, L, Fitted(0.1, 0.0))
    assert back_emf_of(even, Fitted(R, 0.0), SCALE).value == pytest.approx(K)


def test_what_tells_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="too small"):
        resistance_of(2, SCALE)
    with pytest.raises(ValueError, match="no more than at rest"):
        back_emf_of(Turning(40, 0.5, TEETH, L, Fitted(0.0, 0.0)), Fitted(R, 0.05), SCALE)
    with pytest.raises(ValueError, match="takes nearly all"):
        back_emf_of(Turning(amplitude(12.0, 0.0), 12.0, TEETH, 7e-3, Fitted(0.0, 0.0)), Fitted(R, 0.05), SCALE)
