"""Rings and slow turns of a rotor made by the model itself, with noise: what the fits tell of them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.calc.motors.ring_down import Fitted, Ring, fit_ring_downs
from app.calc.motors.swing_kernel import swing

COUNT = 2 * math.pi / 400
"""Of an encoder with 5000 lines [rad electrical]."""


def rings(
    hz: float,
    damping: float,
    friction: float,
    count: int = 8,
    start: float = 1.2,
    zero: float = 0.03,
    every_s: float = 1e-3,
) -> list[Ring]:
    """A hop ends anywhere between two samples, `every_s` apart."""
    w = 2 * math.pi * hz
    p = np.array([w * w, 2 * damping * w, friction, 0.04, 0.0, 0.0])
    rng = np.random.default_rng(5)
    made = []
    for index in range(count):
        seen = np.empty(40_000)
        field = 1.1 * index
        swing(p, field, 0.0, field - start, 0.0, 0.0, 1e-5, seen)
        apart = round(every_s / 1e-5)
        samples = seen[round(index * 0.618 % 1 * apart) :: apart] + zero
        noisy = COUNT * np.round(samples / COUNT + rng.uniform(-0.5, 0.5))
        time_s = np.arange(len(noisy), dtype=np.float64) * every_s
        made.append(Ring(time_s, np.asarray(noisy, dtype=np.float64), field, True, every_s))
    return made


@pytest.mark.parametrize(("hz", "damping", "friction"), [(90.0, 0.02, 0.08), (170.0, 0.15, 0.01)])
def test_frequency_and_damping_of_rings_are_found_with_their_intervals(
    hz: float, damping: float, friction: float
) -> None:
    found = fit_ring_downs(rings(hz, damping, friction), friction=Fitted(friction, 0.001))
    assert found.resonance_hz.value == pytest.approx(hz, rel=0.01)
    assert found.damping.value == pytest.approx(damping, rel=0.1)
    assert abs(found.resonance_hz.value - hz) < 2 * found.resonance_hz.half < 0.02 * hz
    assert found.detent.value == pytest.approx(0.04, abs=0.01)


@pytest.mark.parametrize("zero", [-3.0, 3.0, 3.3])
def test_the_zero_of_the_encoder_may_lie_half_a_period_beside_the_field(zero: float) -> None:
    found = fit_ring_downs(rings(98.0, 0.03, 0.01, zero=zero))
    assert found.resonance_hz.value == pytest.approx(98.0, rel=0.003)
    assert found.damping.value == pytest.approx(0.03, rel=0.05)
    assert found.friction.value == pytest.approx(0.01, abs=0.002)


def test_what_does_not_ring_is_no_pendulum() -> None:
    with pytest.raises(ValueError, match=r"rings like that|nothing swings"):
        fit_ring_downs(rings(170.0, 3.0, 0.2, start=0.3))
    with pytest.raises(ValueError, match="three rings"):
        fit_ring_downs(rings(90.0, 0.1, 0.0, count=2))


@pytest.mark.parametrize(("hz", "rate_hz"), [(180.0, 100.0), (180.0, 120.0), (180.0, 220.0), (300.0, 370.0)])
def test_a_swing_that_is_sampled_too_rarely_is_taken_for_no_slower_one(hz: float, rate_hz: float) -> None:
    with pytest.raises(ValueError, match=r"samples every \d+(\.\d+)? ms"):
        fit_ring_downs(rings(hz, 0.05, 0.01, count=12, every_s=1 / rate_hz))


@pytest.mark.parametrize(("hz", "rate_hz"), [(60.0, 250.0), (20.0, 100.0)])
def test_a_slow_swing_is_told_by_few_samples_too(hz: float, rate_hz: float) -> None:
    found = fit_ring_downs(rings(hz, 0.03, 0.01, count=12, every_s=1 / rate_hz))
    assert found.resonance_hz.value == pytest.approx(hz, rel=0.01)
