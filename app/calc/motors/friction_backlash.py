"""Friction of an axis told apart from backlash before its encoder, by slow turns there and back.

Friction holds the rotor behind its field by asin(friction / torque), so less current makes it more; backlash stays what
it is. The rotor does not follow that alone: four times an electrical period it goes over a detent, swings, and so loses
more to its viscous friction than a steady speed takes, most of all near its resonance, which less current brings down.
Where the rings are known (`ring_down`) its way is reckoned with all of it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from . import swing_kernel as k
from .ring_down import STEPS_A_RADIAN, Fitted, FloatArray, RingDown

# scipy is imported where it is used: the server starts without it.

MOST_SHARE = 0.9
"""Friction and detent torque beyond this share of the torque are none that a motor turns against."""
SETTLED = 6.0
"""So many time constants of a swing pass before the rotor is looked at ..."""
DETENTS = 8
"""... for so many detents."""
SETTLES_MOST = 40
"""Detents at the most, of a rotor that hardly has damping."""
LEAST_DAMPING = 1e-3
LEFT_OUT = 0.0015
"""Friction, as a share, may be wrong by so much that no input tells: the table of microsteps, currents that follow
late. So it was of 24 of 25 emulated motors. Backlash is wrong by twice that angle."""


@dataclass(frozen=True, slots=True)
class Turn:
    """A turn there and back. apart : between both ways [rad electrical]; share : of the current, and so of the torque;
    speed : of the field [rad electrical/s]."""

    apart: Fitted
    share: float
    speed: float


@dataclass(frozen=True, slots=True)
class Torn:
    """Friction as a share of the holding torque, and backlash [rad electrical]."""

    friction: Fitted
    backlash: Fitted


def friction_and_backlash(turns: Sequence[Turn], rings: RingDown | None = None) -> Torn:
    """Of three `turns`: one with the full current, one at twice its speed, one with less current at its speed.

    The difference of currents tells friction. What is left of the two with the full current is backlash, and what grows
    with the speed: the time that passes between a step and its look at the encoder, and that currents need to follow.
    Without `rings` all of it that grows may be viscous friction, and widens the interval.

    Raises ValueError where the difference is none that friction makes.
    """
    known = [turn.apart for turn in turns]
    if rings is not None:
        known += [rings.resonance_hz.scaled(2 * math.pi), rings.damping, rings.detent]
    values = np.array([one.value for one in known])
    friction, backlash, grows = _told(values, *turns)
    halves = np.array([LEFT_OUT, 2 * LEFT_OUT])
    for at, one in enumerate(known):
        moved = values.copy()
        moved[at] += one.half
        halves = np.hypot(halves, np.array(_told(moved, *turns)[:2]) - (friction, backlash))
    if rings is None:
        halves[0] = math.hypot(halves[0], grows / 2)
    return Torn(Fitted(friction, float(halves[0])), Fitted(backlash, float(halves[1])))


def _told(values: FloatArray, slow: Turn, fast: Turn, less: Turn) -> tuple[float, float, float]:
    """Friction, backlash, and what grows with the speed; values : what is between both ways of the three turns, then
    w, damping and detent where they are known."""
    of_slow, of_fast, of_less = (float(value) for value in values[:3])
    rotor = [float(value) for value in values[3:]]

    def apart(friction: float, turn: Turn) -> float:
        return _apart(friction, turn, *rotor) if rotor else 2 * math.asin(friction / turn.share)

    friction = _friction(of_less - of_slow, lambda one: apart(one, less) - apart(one, slow), _most(less, *rotor))
    still = of_slow - apart(friction, slow)
    grows = of_fast - apart(friction, fast) - still
    return friction, still - grows, grows


def _most(less: Turn, w: float = 0.0, damping: float = 0.0, detent: float = 0.0) -> float:
    """The greatest friction against which a rotor turns with less current [share]."""
    return max(MOST_SHARE * less.share - detent, 0.0)


def _friction(more: float, expected: Callable[[float], float], most: float) -> float:
    """The friction at which `expected` is `more`."""
    from scipy import optimize

    if more > expected(most):
        raise ValueError(f"with less current the rotor lags {more:.3g} rad more: more than friction does")
    if more <= expected(0.0):
        return 0.0
    return float(optimize.brentq(lambda friction: expected(friction) - more, 0.0, most, xtol=1e-6))


def _apart(friction: float, turn: Turn, w: float, damping: float, detent: float) -> float:
    """What friction, without backlash, puts between both ways of a turn [rad electrical]; w : of small swings with the
    full current [rad/s]."""
    period_s = math.pi / 2 / turn.speed
    steps = math.ceil(STEPS_A_RADIAN * w * period_s)
    dt = period_s / steps
    before = min(math.ceil(SETTLED / (max(damping, LEAST_DAMPING) * w * period_s)), SETTLES_MOST) * steps
    p = np.array([w**2 * turn.share, 2 * damping * w, friction / turn.share, detent / turn.share, 0.0, 0.0])
    seen = np.empty(before + DETENTS * steps)
    k.swing(p, 0.0, turn.speed, 0.0, turn.speed, 0.0, dt, seen)
    field = turn.speed * dt * np.arange(before, len(seen))
    return 2 * float(np.mean(field - seen[before:]))
