"""Ripple by order and the resonance that it tells, on samples that are made up."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from app.calc.motors.forced_swing import OrderRun, fit_forced_swing, pooled
from app.calc.motors.ring_down import Fitted
from app.calc.signals.order_spectrum import order_spectrum

ORDERS = (4, 2, 1, 8)
HZ, DAMPING, FORCING = 120.0, 0.05, 0.01
NOISE = 1e-4


def runs(order: int, low_hz: float, high_hz: float) -> list[OrderRun]:
    """A rotor of small swings that answers that order, both ways."""
    rng = np.random.default_rng(1)
    made = []
    for hz in np.geomspace(low_hz, high_hz, 20):
        r = order * hz / HZ
        for forward, forcing in ((True, FORCING * np.exp(0.4j)), (False, FORCING * np.exp(-0.7j))):
            answer = forcing / (1 - r * r + 2j * DAMPING * r)
            made.append(OrderRun(hz, answer + NOISE * complex(*rng.standard_normal(2)), forward, 0.0, NOISE, NOISE))
    return made


def test_orders_are_told_at_uneven_times_with_a_gap_and_beyond_half_the_rate() -> None:
    rng = np.random.default_rng(2)
    time = np.sort(np.concatenate([rng.uniform(0, 0.4, 300), rng.uniform(0.7, 1.0, 250)]))
    angle = 2 * math.pi * 90 * time  # order 8: 720 Hz, by 550 samples a second
    shaft = angle / 50
    deviation = 3 + 0.2 * np.cos(shaft) + 0.05 * np.cos(4 * angle) - 0.02 * np.sin(8 * angle)
    deviation += 0.01 * np.sin(2 * math.pi * 37 * time) + 1e-4 * rng.standard_normal(len(time))
    told = order_spectrum(time, angle, shaft, deviation, ORDERS)
    assert told.amplitudes[4] == pytest.approx(0.05, abs=2e-3)
    assert told.amplitudes[8] == pytest.approx(0.02j, abs=2e-3)
    assert abs(told.amplitudes[2]) < 2e-3
    assert told.ripple == pytest.approx(math.sqrt((0.05**2 + 0.02**2 + 0.01**2) / 2), rel=0.05)
    assert told.rest_hz == pytest.approx(37, abs=1.0)
    assert told.rest_amplitude == pytest.approx(0.01, rel=0.2)


def test_orders_that_look_the_same_are_left_out_and_too_few_samples_refused() -> None:
    time = np.arange(500) / 500.0
    angle = 2 * math.pi * 100 * time  # five samples a period: order 1 and order 4 are one
    told = order_spectrum(time, angle, angle / 50, 0.05 * np.cos(4 * angle), ORDERS)
    assert set(told.amplitudes) == {4, 2}
    assert told.amplitudes[4] == pytest.approx(0.05, abs=1e-6)
    with pytest.raises(ValueError, match="too few"):
        order_spectrum(time[:30], angle[:30], angle[:30] / 50, angle[:30], ORDERS)


@pytest.mark.parametrize("order", [1, 2])
def test_a_resonance_is_told_with_its_damping(order: int) -> None:
    found = fit_forced_swing(order, runs(order, 0.3 * HZ / order, 2.5 * HZ / order))
    assert found.resonance_hz.value == pytest.approx(HZ, rel=0.003)
    assert found.damping.value == pytest.approx(DAMPING, rel=0.1)
    assert found.forcing == pytest.approx(FORCING, rel=0.05)
    assert found.left < 0.1


def test_a_speed_that_shows_something_else_does_not_count() -> None:
    """An encoder's counts look like an order at some speeds; at others the rotor swings by itself."""
    order = 2
    made = runs(order, 0.3 * HZ / order, 2.5 * HZ / order)
    for at in (28, 29, 33):
        made[at] = replace(made[at], amplitude=0.14j)
    found = fit_forced_swing(order, made)
    assert found.resonance_hz.value == pytest.approx(HZ, rel=0.005)
    assert found.damping.value == pytest.approx(DAMPING, rel=0.1)


def test_no_resonance_is_told_outside_of_the_speeds_nor_by_few_runs() -> None:
    with pytest.raises(ValueError, match="within the speeds"):
        fit_forced_swing(2, runs(2, 0.1 * HZ / 2, 0.6 * HZ / 2))
    with pytest.raises(ValueError, match="too few"):
        fit_forced_swing(2, runs(2, 0.3 * HZ / 2, 2 * HZ / 2)[:6])


def test_the_surer_figure_counts_more() -> None:
    both = pooled([Fitted(100.0, 1.0), Fitted(106.0, 5.0)])
    assert 100 < both.value < 101
    assert both.half >= 0.01 * both.value
