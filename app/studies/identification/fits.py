"""What the turns and hops of an identification are fitted to. It takes seconds of a processor."""

from __future__ import annotations

from collections.abc import Sequence

from ...calc.motors.friction_backlash import Turn, friction_and_backlash
from ...calc.motors.ring_down import Ring, fit_ring_downs
from ...calc.motors.slow_turns import SlowTurn
from .measured import Measured

ROUNDS = 2
"""So often are rings fitted, with what the fit before told."""


def fitted(turn: SlowTurn, turns: Sequence[Turn], rings: Sequence[Ring]) -> Measured:
    """Friction and backlash help to fit the rings, which help to tell both apart. turn : the first of the `turns`"""
    why: list[str] = []
    torn = found = None
    try:
        torn = friction_and_backlash(turns)
    except ValueError as error:
        why.append(f"friction and backlash: {error}")
    try:
        for _ in range(ROUNDS):
            play, friction = (0.0, None) if torn is None else (max(torn.backlash.value, 0.0), torn.friction)
            found = fit_ring_downs(rings, play, friction)
            torn = torn and friction_and_backlash(turns, found)
    except ValueError as error:
        why.append(f"resonance, damping, inertia: {error}")
    return Measured(turn, torn, found, why)
