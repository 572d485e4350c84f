"""A step of a position loop whose rotor has friction, against the same integrated in very small steps."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from app.calc.motors.position_loop import Gains, Plant, step_answer

GAINS, PLANT = Gains(60.0, 2300.0), Plant(2 * math.pi * 149, 0.067, 2e-4)


def integrated(gains: Gains, plant: Plant, friction: float, lasts_s: float) -> NDArray[np.float64]:
    """Places of the rotor, every 10 us."""
    dt = 1e-5
    place = speed = acting = field = error_s = 0.0
    places = []
    for _ in range(round(lasts_s / dt)):
        places.append(place)
        error_s += (1 - place) * dt
        field += (gains.proportional * (1 - place) + gains.integral * error_s) * dt
        acting += (field - acting) / plant.delay_s * dt
        pull = plant.w**2 * (acting - place) - 2 * plant.damping * plant.w * speed
        held = plant.w**2 * friction
        if speed == 0.0 and abs(pull) <= held:
            continue
        later = speed + (pull - math.copysign(held, speed or pull)) * dt
        speed = 0.0 if later * speed < 0 else later
        place += speed * dt
    return np.array(places)


@pytest.mark.parametrize("friction", [0.0, 0.003, 0.01, 0.03, 0.1])
def test_a_step_against_friction(friction: float) -> None:
    places = integrated(GAINS, PLANT, friction, 0.4)
    answer = step_answer(GAINS, PLANT, np.linspace(0.0, 0.4, 401), friction)
    np.testing.assert_allclose(answer[:-1], places[::100], atol=0.003)


def test_little_friction_keeps_the_ripple_off_the_overshoot() -> None:
    time_s = np.linspace(0.0, 0.4, 4000)
    without, little = (float(np.max(step_answer(GAINS, PLANT, time_s, friction))) for friction in (0.0, 0.003))
    assert without - little > 0.008
