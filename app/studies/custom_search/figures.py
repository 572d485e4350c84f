"""Figures of moves as objectives and bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..document import CustomSearch, FigureBound, ScoredFigure
from ..scored_move.found import Scored

NAMES: dict[ScoredFigure, tuple[str, str]] = {
    "time_s": ("time until it rests", "s"),
    "overshoot_fullsteps": ("overshoot", "full steps"),
    "peak_fullsteps": ("greatest deviation", "full steps"),
    "vibration_fullsteps": ("vibration under way", "full steps"),
    "rest_fullsteps": ("vibration at the end", "full steps"),
    "load_min": ("least load value", ""),
}
"""Each in words, and its unit."""
MORE_IS_BETTER: frozenset[ScoredFigure] = frozenset({"load_min"})


@dataclass(frozen=True, slots=True)
class Judged:
    """A setting's figures by what is asked. costs : of each objective, the less the better; None where one is not told.
    violation : above 0 where it does not count, and `why`."""

    costs: tuple[float, ...] | None
    violation: float
    why: str


def value_of(found: Scored, figure: ScoredFigure) -> float | None:
    """A figure; None where it could not be told."""
    value: float | None = getattr(found, figure)
    return value


def named(figure: ScoredFigure) -> str:
    """With its unit, for people."""
    name, unit = NAMES[figure]
    return f"{name} [{unit}]" if unit else name


def sign_of(figure: ScoredFigure) -> int:
    """By what a figure is multiplied for less to be better."""
    return -1 if figure in MORE_IS_BETTER else 1


def judged(wanted: CustomSearch, found: Scored) -> Judged:
    """What the figures are worth."""
    told = [value_of(found, figure) for figure in wanted.objectives]
    known = [value for value in told if value is not None]
    costs = (
        tuple(sign_of(figure) * value for figure, value in zip(wanted.objectives, known, strict=True))
        if len(known) == len(told)
        else None
    )
    if found.lost_fullsteps:
        return Judged(costs, found.lost_fullsteps, f"{found.lost_fullsteps:g} full steps lost")
    missing = [NAMES[figure][0] for figure, value in zip(wanted.objectives, told, strict=True) if value is None]
    if missing:
        return Judged(None, 1.0, f"{missing[0]} could not be told: it did not settle in its band, or nothing tells it")
    return Judged(costs, *broken(wanted.bounds, found))


def broken(bounds: Sequence[FigureBound], found: Scored) -> tuple[float, str]:
    """By how much the bounds are broken altogether, as shares, and which; at most 0 where all hold."""
    sum_, why = 0.0, list[str]()
    for bound in bounds:
        value, name = value_of(found, bound.figure), NAMES[bound.figure][0]
        if value is None:
            sum_, why = sum_ + 1.0, [*why, f"{name} could not be told"]
        elif bound.most is not None and value > bound.most:
            sum_, why = sum_ + (value - bound.most) / (abs(bound.most) or 1.0), [*why, f"{name} above its bound"]
        elif bound.least is not None and value < bound.least:
            sum_, why = sum_ + (bound.least - value) / (abs(bound.least) or 1.0), [*why, f"{name} below its bound"]
    return (sum_ if why else -1.0), ", ".join(why)
