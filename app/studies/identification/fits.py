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
    if torn is not None and torn.backlash.value + torn.backlash.half < 0:
        why.append(
            "friction and backlash: both ways of a turn are closer together than friction alone puts them, by "
            f"{-torn.backlash.value:.3g} rad of a period: samples that came late, or something else turns the shaft"
        )
        torn = None
    return Measured(turn, torn, found, why)
