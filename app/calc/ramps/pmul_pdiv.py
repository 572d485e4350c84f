"""The pair pmul/pdiv that tells the ramp generator when to begin to brake.

The chip needs p = a_max / (128 * 2^(ramp_div - pulse_div)) and keeps it as (128 + pmul) / 2^(3 + pdiv).
A little less than p makes the motor brake a little early; more than p makes it overshoot. So the data
sheets take off 5 % (TMC428) or 1 % (TMC4210) before they truncate to a pair.

The TMC428 data sheet counts `pmul` 0..127, the TMC4210 data sheet `PMUL` 128..255 with its fixed top
bit; the register bits are the same. Here `pmul` is the former and `p_mul` the latter.

Sources: DS-TMC428 8.7.1, 8.10, 8.11, 8.11.1 and the program of chapter 19; DS-TMC4210 6.1.9.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ..units.tmc428 import steps_during_acceleration
from .pmul_pdiv_inverse import RegisterSuggestion, inverse
from .pmul_pdiv_table import (
    MAX_PDIV,
    REDUCTIONS,
    V_MAX_OF_HALF_LIMIT,
    PmulPdivTable,
    a_max_lower_limit,
    a_max_upper_limit,
    default_reduction,
    design_many,
)
from .ticked import DISTANCE_LIMIT, RampParameters, ramp_ending

__all__ = [
    "REDUCTIONS",
    "Candidate",
    "PmulPdivDesign",
    "PmulPdivTable",
    "RegisterSuggestion",
    "a_max_lower_limit",
    "a_max_upper_limit",
    "default_reduction",
    "design",
    "design_many",
    "inverse",
]

# Candidates are the pairs around the reduced p, and those from the sheets' 0.95 < q < 1 to a little beyond 1,
# so that a plot shows where overshooting begins.
_NEAR_TARGET = 0.03
_BAND = (0.92, 1.02)

# A one-step overshoot depends on the remainder in the pulse accumulator, so each pair makes a few moves of
# slightly different length, and the worst counts. Ramps of very many ticks have a p so small that this does not
# matter, and they take the longest: one move is enough, and a slider stays smooth.
_REFERENCE_MOVES = 3
_MANY_RAMP_TICKS = 50_000


@dataclass(frozen=True)
class Candidate:
    """One pair near the wanted p, and how it brakes from v_max (the exact ramp, worst of a few moves).

    pmul 0..127, p_mul 128..255, pdiv 0..13, p = p_mul / 2^(3 + pdiv)
    quality : q = p / p_ideal; above 1 overshoots (DS-TMC428 8.11)
    overshoot_steps : farthest beyond the target [microsteps]
    settling_s : from the first arrival at the target to rest [s]; None where the oscillation is unbounded
    move_s : the whole reference move [s], to compare pairs by; None where the oscillation is unbounded
    The last three are None where `design` was asked not to evaluate, or where v_max or a_max is 0.
    """

    pmul: int
    p_mul: int
    pdiv: int
    p: float
    quality: float
    overshoot_steps: int | None = None
    settling_s: float | None = None
    move_s: float | None = None


@dataclass(frozen=True)
class PmulPdivDesign:
    """What `design` finds. Without a pair that represents p, `pmul`, `p_mul`, `pdiv`, `p`, `quality` are None."""

    p_ideal: float
    p_reduced: float
    pmul: int | None
    p_mul: int | None
    pdiv: int | None
    p: float | None
    quality: float | None
    candidates: tuple[Candidate, ...]
    a_max_lower_limit: int
    a_max_upper_limit: int
    warnings: tuple[str, ...] = field(default=())


def design(
    chip: str,
    a_max: int,
    ramp_div: int,
    pulse_div: int,
    reduction: float | None = None,
    *,
    v_max: int = 2047,
    v_min: int = 1,
    clock_hz: float = 16e6,
    evaluate: bool = True,
) -> PmulPdivDesign:
    """The pair for an acceleration, its neighbours, and what stands against it.

    Parameters
    ----------
    chip : one of `tmc428.chips`; chooses the reduction where `reduction` is None
    a_max : 0..2047; 0 has no p and so no pair
    ramp_div, pulse_div : 0..13
    reduction : part of p to take off, 0 <= reduction < 1 [-]; None is the data sheet's own
    v_max, v_min : 0..2047, for the limits of a_max and for the moves that the candidates make
    clock_hz : above 0 [Hz], for the candidates' times
    evaluate : False leaves the moves out, for callers that want the pair alone

    Raises ValueError outside these ranges. The pair is the one of the program in DS-TMC428 chapter 19: p reduced, then
    truncated. (That program keeps the reduction in single precision, which pushes exact hits, such as its own
    example of a_max 10 and 5 %, down by one pmul. Here 5 % is 5 %.)
    """
    part = default_reduction(chip) if reduction is None else reduction
    table = design_many(a_max, ramp_div, pulse_div, part)
    p_ideal, p_reduced = float(table.p_ideal), float(table.p_reduced)
    found = int(table.pdiv) >= 0
    lower, upper = a_max_lower_limit(ramp_div, pulse_div, v_max), a_max_upper_limit(ramp_div, pulse_div)
    pair = (int(table.pmul), int(table.pdiv)) if found else None
    candidates = _candidates(p_ideal, part, pair)
    if evaluate and a_max > 0 and v_max > 0:
        moving = RampParameters(v_min, v_max, a_max, ramp_div, pulse_div, clock_hz=clock_hz)
        candidates = tuple(_evaluated(candidate, moving) for candidate in candidates)
    return PmulPdivDesign(
        p_ideal=p_ideal,
        p_reduced=p_reduced,
        pmul=int(table.pmul) if found else None,
        p_mul=int(table.p_mul) if found else None,
        pdiv=int(table.pdiv) if found else None,
        p=float(table.p) if found else None,
        quality=float(table.quality) if found else None,
        candidates=candidates,
        a_max_lower_limit=lower,
        a_max_upper_limit=upper,
        warnings=tuple(_warnings(a_max, p_reduced, found, lower, upper, v_max)),
    )


def _candidates(p_ideal: float, reduction: float, chosen: tuple[int, int] | None) -> tuple[Candidate, ...]:
    """Every pair in the bands: the chosen one first, the others by their distance from the reduced p."""
    if p_ideal == 0:
        return ()
    wanted = 1.0 - reduction
    pdiv, p_mul = np.mgrid[0 : MAX_PDIV + 1, 128:256]
    quality = np.ldexp(p_mul / p_ideal, -3 - pdiv)
    near = (np.abs(quality - wanted) <= _NEAR_TARGET * wanted) | ((quality >= _BAND[0]) & (quality <= _BAND[1]))
    found = [
        Candidate(int(m) - 128, int(m), int(d), float(m) / (8 << int(d)), float(q))
        for m, d, q in zip(p_mul[near], pdiv[near], quality[near], strict=True)
    ]
    return tuple(sorted(found, key=lambda c: ((c.pmul, c.pdiv) != chosen, abs(c.quality - wanted))))


def _evaluated(candidate: Candidate, moving: RampParameters) -> Candidate:
    moving = replace(moving, pmul=candidate.pmul, pdiv=candidate.pdiv)
    braking = moving.v_max**2 / (2048 * candidate.p)
    to_v_max = steps_during_acceleration(moving.v_max, moving.a_max, moving.ramp_div, moving.pulse_div) + braking
    distance = min(DISTANCE_LIMIT - _REFERENCE_MOVES, int(1.05 * to_v_max) + 100)
    moves = 1 if 256 * moving.v_max > _MANY_RAMP_TICKS * moving.a_max else _REFERENCE_MOVES
    endings = [ramp_ending(moving, distance + extra) for extra in range(moves)]
    settling = [ending.settling_s for ending in endings if ending.settling_s is not None]
    durations = [ending.duration_s for ending in endings if ending.duration_s is not None]
    ends = len(durations) == len(endings)
    return replace(
        candidate,
        overshoot_steps=max(ending.overshoot_steps for ending in endings),
        settling_s=max(settling) if ends else None,
        move_s=max(durations) if ends else None,
    )


def _warnings(a_max: int, p_reduced: float, found: bool, lower: int, upper: int, v_max: int) -> list[str]:
    if a_max == 0:
        return ["a_max is 0: the velocity cannot change, so there is no p to represent"]
    said = []
    if not found:
        side = "below 1/512, the least" if p_reduced < 1 / 512 else "32 or more, above the most"
        said.append(f"no pair represents p: {p_reduced:g} is {side} that pmul and pdiv can hold")
    if a_max < lower:
        hint = "" if v_max <= V_MAX_OF_HALF_LIMIT else f" (half of it with v_max up to {V_MAX_OF_HALF_LIMIT})"
        said.append(f"a_max {a_max} is below its lower limit {lower}{hint}: may oscillate around the target")
    if a_max > upper:
        said.append(f"a_max {a_max} is above its upper limit {upper}: may oscillate around the target")
    return said
