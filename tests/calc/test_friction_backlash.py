"""Friction told apart from backlash, by turns that the model itself makes."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.calc.motors.friction_backlash import Turn, friction_and_backlash
from app.calc.motors.ring_down import Fitted, RingDown
from app.calc.motors.swing_kernel import swing

SPEED = 10 * math.pi
"""Of a tenth of a turn a second [rad electrical/s]."""
BACKLASH, DELAY_S = 0.03, 9e-5
MICROSTEP = 2 * math.pi / 1024
NOTHING = np.zeros(0)


def rings(hz: float, damping: float, detent: float) -> RingDown:
    resonance, damped, free, detents = (Fitted(value, 0.01 * value) for value in (hz, damping, 0.0, detent))
    return RingDown(resonance, damped, free, detents, 0.0, 0.0, NOTHING, NOTHING, NOTHING)


def turn(share: float, speed: float, hz: float, damping: float, friction: float, detent: float) -> Turn:
    """A whole turn as a rotor makes it, there less back, with backlash and a delay."""
    w, dt = 2 * math.pi * hz, 2e-5
    p = np.array([w * w * share, 2 * damping * w, friction / share, detent / share, 0.0, 0.0])
    seen = np.empty(round(100 * math.pi / speed / dt))
    swing(p, 0.0, speed, 0.0, 0.0, 0.0, dt, seen)
    lag = speed * dt * np.arange(len(seen)) - seen
    return Turn(Fitted(2 * float(np.mean(lag[len(lag) // 5 :])) + BACKLASH + DELAY_S * speed, 1e-4), share, speed)


@pytest.mark.parametrize(("hz", "damping"), [(93.0, 0.03), (111.0, 0.06), (190.0, 0.16)])
def test_a_rotor_that_swings_over_its_detents_misleads_nobody(hz: float, damping: float) -> None:
    friction, detent = 0.05, 0.07
    turns = [
        turn(share, speed, hz, damping, friction, detent)
        for share, speed in ((1.0, SPEED), (1.0, 2 * SPEED), (0.5, SPEED))
    ]
    torn = friction_and_backlash(turns, rings(hz, damping, detent))
    assert torn.friction.value == pytest.approx(friction, abs=1e-3)
    assert torn.backlash.value == pytest.approx(BACKLASH, abs=MICROSTEP / 4)
    assert abs(torn.backlash.value - BACKLASH) < torn.backlash.half < MICROSTEP


def test_less_current_makes_more_of_friction_and_not_of_backlash() -> None:
    turns = [
        Turn(Fitted(BACKLASH + DELAY_S * speed + 2 * math.asin(0.1 / share), 0.001), share, speed)
        for share, speed in ((1.0, SPEED), (1.0, 2 * SPEED), (0.5, SPEED))
    ]
    torn = friction_and_backlash(turns)
    assert torn.friction.value == pytest.approx(0.1, abs=1e-6)
    assert torn.backlash.value == pytest.approx(BACKLASH, abs=1e-6)
    with pytest.raises(ValueError, match="more than friction"):
        friction_and_backlash([*turns[:2], Turn(Fitted(2.0, 0.001), 0.5, SPEED)])
