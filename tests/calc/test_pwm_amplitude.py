"""Resistance and back-EMF from PWM amplitudes, against the voltage equation that made them."""

from __future__ import annotations

import math

import pytest

from app.calc.motors.pwm_amplitude import PwmScale, Turning, coil_constants, resistance_of
from app.calc.motors.ring_down import Fitted

SCALE = PwmScale(24 * 248 / 65536, 2.1)
R, L, K, TEETH = 2.3, 4.4e-3, 0.21, 50.0


def amplitude(omega: float, sine: float, inductance_h: float = L, share: float = 1.0) -> float:
    """Of a motor that turns with a share of its current [counts]; sine : of the load angle with all of it."""
    angle, reactance = math.asin(sine / share), TEETH * omega * inductance_h
    current = share * SCALE.current_a
    along = R * current * math.cos(angle) - reactance * current * math.sin(angle)
    across = R * current * math.sin(angle) + reactance * current * math.cos(angle) + K * omega
    return math.hypot(along, across) / SCALE.counts_v


def test_a_resistance_is_the_amplitude_at_rest_and_its_interval_is_of_counts_and_of_what_was_told() -> None:
    exact = R * SCALE.current_a / SCALE.counts_v
    found = resistance_of(round(exact), SCALE)
    assert abs(found.value - R) < found.half
    assert found.half < 0.05 * R
    assert resistance_of(10, SCALE).half / resistance_of(10, SCALE).value > found.half / found.value


@pytest.mark.parametrize("inductance_h", [0.3 * L, L, 1.5 * L])
@pytest.mark.parametrize("less", [0.5, 0.8])
@pytest.mark.parametrize("sine", [0.0, 0.1, 0.3])
def test_amplitudes_of_two_currents_tell_inductance_and_back_emf(sine: float, less: float, inductance_h: float) -> None:
    both = amplitude(12.0, sine, inductance_h), amplitude(12.0, sine, inductance_h, less)
    even = coil_constants(Turning(*both, less, 12.0, TEETH, Fitted(sine, 0.0)), Fitted(R, 0.0), SCALE)
    assert even.inductance_h.value == pytest.approx(inductance_h, rel=1e-6)
    assert even.back_emf.value == pytest.approx(K, rel=1e-6)
    counts, less_counts = map(round, both)
    turning = Turning(counts, less_counts, less, 12.0, TEETH, Fitted(sine + 0.03, 0.05))
    rounded = coil_constants(turning, Fitted(R * 1.01, 0.05), SCALE)
    assert abs(rounded.inductance_h.value - inductance_h) < rounded.inductance_h.half
    assert abs(rounded.back_emf.value - K) < rounded.back_emf.half


def test_less_current_at_the_same_speed_parts_them_better() -> None:
    def half(less: float) -> float:
        both = amplitude(12.0, 0.1), amplitude(12.0, 0.1, share=less)
        turning = Turning(*both, less, 12.0, TEETH, Fitted(0.1, 0.0))
        return coil_constants(turning, Fitted(R, 0.05), SCALE).back_emf.half

    assert half(0.5) < half(0.8)


def test_what_tells_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="too small"):
        resistance_of(2, SCALE)
    with pytest.raises(ValueError, match="no more than at rest"):
        coil_constants(Turning(40, 20, 0.5, 0.5, TEETH, Fitted(0.0, 0.0)), Fitted(R, 0.05), SCALE)
    none = [math.hypot(R, TEETH * 12.0 * L) * share * SCALE.current_a / SCALE.counts_v for share in (1.0, 0.5)]
    with pytest.raises(ValueError, match="takes nearly all"):
        coil_constants(Turning(none[0], none[1], 0.5, 12.0, TEETH, Fitted(0.0, 0.0)), Fitted(R, 0.05), SCALE)
