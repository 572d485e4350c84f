"""What stands in for `scipy.signal`, which no image has, against it: steps of closed loops, lines of a spectrum."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import signal

from app.calc.motors.position_loop import Gains, Plant, step_answer
from app.calc.signals import order_spectrum


@pytest.mark.parametrize(
    ("gains", "plant"),
    [
        (Gains(40.0, 0.0), Plant(700.0, 0.2, 0.0)),
        (Gains(60.0, 300.0), Plant(900.0, 0.05, 0.0005)),
        (Gains(400.0, 9000.0), Plant(500.0, 0.02, 0.001)),
    ],
    ids=["proportional", "with integral", "unstable"],
)
def test_a_step_of_a_closed_loop(gains: Gains, plant: Plant) -> None:
    time_s = np.linspace(0, 0.3, 1000)
    w, d, lag = plant.w, plant.damping, max(plant.delay_s, 1e-6)
    open_loop = np.polymul(np.polymul([1.0, 2 * d * w, w * w], [lag, 1.0]), [1.0, 0.0, 0.0])
    numerator = [w * w * gains.proportional, w * w * gains.integral]
    expected = signal.step(signal.TransferFunction(numerator, np.polyadd(open_loop, numerator)), T=time_s)[1]
    assert step_answer(gains, plant, time_s) == pytest.approx(expected, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("even", [True, False])
def test_the_strongest_line(even: bool) -> None:
    dice = np.random.default_rng(19)
    time_s = np.linspace(3, 4, 300) if even else np.sort(dice.uniform(3, 4, 300))
    left = 0.3 * np.cos(2 * math.pi * 37 * time_s + 1) + 0.05 * dice.normal(size=300)
    lines = np.linspace(2 / np.ptp(time_s), 150 / np.ptp(time_s), order_spectrum.LINES)
    power = signal.lombscargle(time_s - time_s[0], left, 2 * math.pi * lines)
    at = int(np.argmax(power))
    found_hz, amplitude = order_spectrum._strongest(time_s, left)
    assert found_hz == pytest.approx(lines[at])
    assert amplitude == pytest.approx(2 * math.sqrt(power[at] / len(left)))
    assert found_hz == pytest.approx(37, abs=0.5)
    assert amplitude == pytest.approx(0.3, abs=0.03)
