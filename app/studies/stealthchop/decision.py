"""Whether a setting of StealthChop is better than the one before, by pairs of runs."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from ..proof import LEVEL, mean_interval, paired_effect
from .found import StealthEffect, StealthPair

ADDED_LEAST = 0.02
"""What the regulation adds less than before counts from so much of the amplitude on."""
ENOUGH = 7
"""So many pairs have to tell it: with fewer no paired test of two figures says anything at 5 %."""
FASTER = 1.1
"""A switch-over counts as faster from so many times the one before on."""
AS_FAST = 0.99
WRONG = 0.25
"""An amplitude that is off by more of what is needed, and that nothing regulates, heats the motor or loses steps."""


@dataclass(frozen=True, slots=True)
class Reach:
    """Up to which speed StealthChop works before and now [turns a second]; 0 where it does not."""

    before: float
    now: float


@dataclass(frozen=True, slots=True)
class Decision:
    """improved, by what of it."""

    improved: bool
    calm: bool
    farther: bool
    effects: tuple[StealthEffect, ...]


def decide(
    pairs: Sequence[StealthPair],
    reach: Reach,
    jolt_max: float,
    smallest_gain: float,
    seed: int,
    *,
    regulated: bool = True,
) -> Decision:
    """Better is what is shown to jolt by no more than asked, and goes farther, or jolts less, or needs less regulation.

    A reach that shrinks counts against it, unless the old one jolted by more than asked, or had a wrong current.
    regulated : whether the amplitude before is
    """
    old, new = [each.baseline_jolt_fullsteps for each in pairs], [each.winner_jolt_fullsteps for each in pairs]
    added = [
        (each.baseline_added_share, each.winner_added_share)
        for each in pairs
        if each.baseline_added_share is not None and each.winner_added_share is not None
    ]
    # A machine with other work too may see no amplitude in a run.
    told = len(added) >= ENOUGH
    count = 1 + told
    effects = [_effect("jolt", "full steps", old, new, smallest_gain * statistics.fmean(old), count, seed)]
    if told:
        before, after = zip(*added, strict=True)
        effects.append(_effect("added", "of the amplitude", before, after, ADDED_LEAST, count, seed))
    calm = effects[0].winner_interval.high <= jolt_max
    farther = reach.now >= FASTER * reach.before
    wrong = effects[0].baseline > jolt_max or (told and not regulated and effects[1].baseline > WRONG)
    shrinks = reach.now < AS_FAST * reach.before and not wrong
    better = farther or any(each.significant for each in effects)
    return Decision(calm and better and not shrinks, calm, farther, tuple(effects))


def _effect(
    name: Literal["jolt", "added"],
    unit: str,
    old: Sequence[float],
    new: Sequence[float],
    least: float,
    count: int,
    seed: int,
) -> StealthEffect:
    """`count` figures are looked at: each p so many times (Bonferroni)."""
    effect = paired_effect(old, new, seed)
    p = min(count * effect.p, 1.0)
    return StealthEffect(
        name=name,
        unit=unit,
        pairs=len(old),
        baseline=statistics.fmean(old),
        winner=statistics.fmean(new),
        difference=effect.mean,
        interval=effect.interval,
        winner_interval=mean_interval(new),
        p=p,
        significant=p < LEVEL and effect.interval.high < -least,
    )
