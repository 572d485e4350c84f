"""Waves for an MSLUT, from formulas: sine, the sigma family, the sin^f linearity correction, harmonics.

One formula composes them all. With theta the electrical angle,

    current = A * ( |s(theta')|^f * sign + sum of a_n * sin(n * theta' + phase_n) )
    theta'  = theta + sum of c_k * sin(k * theta + phase_k)

where s is the shape of sigma (a sine at 0), a_n a harmonic, and c_k a correction of the angle of order 4, 8 or 12. Both
phases read the same table a quarter period apart, so a correction of these orders turns the whole current vector by
c_k and leaves its length alone.

A deflection of the rotor by r rad (electrical) of fourth order, which is what a disturbing torque of r times the
motor's torque makes, is cancelled to first order by f = 1 + 3r: |sin|^f turns the field by -(f - 1)/3 * sin(4 theta).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from .mslut import ENTRIES, MIRROR_DEFAULT, POSITIONS, Refusal, Wave
from .shapes import f_sigma

Grid = Literal["complement", "opposite", "whole_step"]
GRIDS: tuple[Grid, ...] = get_args(Grid)
AMPLITUDE_DEFAULT: dict[Grid, float] = {"complement": 248.0, "opposite": 248.0, "whole_step": 247.0}
EXPONENT_RANGE = (0.2, 5.0)
THOUSANDTHS_RANGE = (30, 200)
"""Where firmware applies its linearity correction: below it is off, above it stays at the upper end."""
HARMONICS = (3, 5, 7, 9, 11)
CORRECTIONS = (4, 8, 12)
ASYMMETRY_MAX = 0.01
"""[counts]: below it a wave is as symmetric as floating point can tell."""


@dataclass(frozen=True, slots=True)
class Term:
    """A harmonic of the current (`amplitude` relative to A), or a correction of the angle (in degrees, electrical).

    `phase_deg` belongs to the term itself: 0 is a sine that rises where the current does, 180 one that falls.
    """

    order: int
    amplitude: float
    phase_deg: float = 0.0


@dataclass(frozen=True, slots=True)
class Formula:
    """What a wave is made of.

    `grid` says how the formula's current becomes table values:

    - "complement": angles in the middle of the microsteps, round(current) - 1, negative half -1 - value. That is the
      power-on wave at sigma 0, exponent 1, amplitude 248.
    - "opposite": the same angles, round(current), negative half -value.
    - "whole_step": angles at the microsteps' beginning, round(current), negative half -value. That is the linearity
      correction of printer firmware at amplitude 247. The table mirrors about the middle, so the angle is half a
      microstep off.

    `amplitude` None is the grid's own: 248, 248, 247. `full_scale` stretches a box (sigma > 0) to reach the amplitude.
    """

    sigma: float = 0.0
    exponent: float = 1.0
    harmonics: tuple[Term, ...] = ()
    corrections: tuple[Term, ...] = ()
    amplitude: float | None = None
    full_scale: bool = False
    grid: Grid = "complement"


@dataclass(frozen=True, slots=True)
class RequestedWave:
    """A wave before anybody asked whether it can be encoded.

    `ideal` is the value before rounding, shape (256,) [counts], None for a wave that no formula made; `wave` the
    rounded one. `refusal` tells of a formula that no quarter wave can hold; then `ideal` and `wave` are its symmetric
    part, which is the nearest in the sense of least squares over the period.
    """

    ideal: NDArray[np.float64] | None
    wave: Wave
    refusal: Refusal | None
    warnings: tuple[str, ...]


def exponent_of_thousandths(thousandths: float) -> float:
    """The exponent of a linearity correction as firmware counts it: 1 + c / 1000."""
    return 1.0 + thousandths / 1000.0


def wanted_wave(formula: Formula) -> RequestedWave:
    """The wave of a formula.

    Raises ValueError for numbers out of range: sigma -1..1, exponent 0.2..5, amplitude above 0 to 400, harmonics of
    order 3, 5, 7, 9, 11 and up to 1, corrections of order 4, 8, 12 and up to 45 degrees.
    """
    _check(formula)
    amplitude = AMPLITUDE_DEFAULT[formula.grid] if formula.amplitude is None else formula.amplitude
    shift, mirror = (-1.0, MIRROR_DEFAULT) if formula.grid == "complement" else (0.0, 0)
    theta = 2 * math.pi * (np.arange(ENTRIES) + (0.0 if formula.grid == "whole_step" else 0.5)) / POSITIONS
    # the table shows its quarter four times; least squares over the period is their mean
    quarters = np.stack(
        [
            _current(formula, theta),
            _current(formula, math.pi - theta),
            -_current(formula, math.pi + theta),
            -_current(formula, 2 * math.pi - theta),
        ]
    )
    ideal = amplitude * quarters.mean(axis=0) + shift
    apart = amplitude * np.ptp(quarters, axis=0)
    values = np.floor(ideal + 0.5).astype(int)
    # A shape that rises slowly would begin with a current of 0 and so with -1, which START_SIN cannot hold.
    values[values == round(shift)] = 0
    return RequestedWave(
        ideal=ideal,
        wave=Wave(tuple(values.tolist()), mirror),
        refusal=_asymmetry(apart),
        warnings=tuple(_warnings(formula, amplitude)),
    )


def _current(formula: Formula, theta: NDArray[np.float64]) -> NDArray[np.float64]:
    """The formula's current at any angle [rad], relative to the amplitude."""
    turned = theta.copy()
    for term in formula.corrections:
        turned += math.radians(term.amplitude) * np.sin(term.order * theta + math.radians(term.phase_deg))
    # the place in the quarter, by folding: t = 1 at the peak
    quarters = (turned / (math.pi / 2)) % 4
    place = np.where(quarters <= 2, 1 - np.abs(1 - quarters), np.abs(3 - quarters) - 1)
    # a small exponent would make a current of what rounding leaves at the zero crossing
    place[np.abs(place) < 1e-12] = 0.0
    shape = f_sigma(np.minimum(np.abs(place), 1.0), formula.sigma)
    if formula.full_scale:
        shape = shape / float(f_sigma(1.0, formula.sigma))
    current = np.sign(place) * shape**formula.exponent
    for term in formula.harmonics:
        current = current + term.amplitude * np.sin(term.order * turned + math.radians(term.phase_deg))
    return np.asarray(current)


def _asymmetry(apart: NDArray[np.float64]) -> Refusal | None:
    worst = int(np.round(apart, 9).argmax())
    if apart[worst] <= ASYMMETRY_MAX:
        return None
    return Refusal(
        worst,
        "asymmetric",
        f"the quarters of this wave are up to {apart[worst]:.1f} counts apart here, and a table holds one for "
        "all four: a harmonic or correction has to have phase 0 or 180 degrees",
    )


def _check(formula: Formula) -> None:
    if formula.grid not in GRIDS:
        raise ValueError(f"no grid is called {formula.grid!r}; known: {', '.join(GRIDS)}")
    lowest, highest = EXPONENT_RANGE
    if not lowest <= formula.exponent <= highest:
        raise ValueError(f"exponent is {formula.exponent}, allowed is {lowest:g}..{highest:g}")
    if formula.amplitude is not None and not 0 < formula.amplitude <= 400:
        raise ValueError(f"amplitude is {formula.amplitude}, allowed is above 0 to 400")
    _check_terms("harmonic", formula.harmonics, HARMONICS, 1.0)
    _check_terms("correction", formula.corrections, CORRECTIONS, 45.0)


def _check_terms(name: str, terms: Sequence[Term], orders: tuple[int, ...], most: float) -> None:
    for term in terms:
        if term.order not in orders:
            raise ValueError(f"{name} of order {term.order}: a quarter wave can hold {', '.join(map(str, orders))}")
        if not (abs(term.amplitude) <= most and math.isfinite(term.phase_deg)):
            raise ValueError(f"{name} {term.order} has amplitude {term.amplitude}, allowed is {-most:g}..{most:g}")


def _warnings(formula: Formula, amplitude: float) -> list[str]:
    found: list[str] = []
    if amplitude > AMPLITUDE_DEFAULT["complement"]:
        found.append(f"amplitude {amplitude:g} is above 248 and leaves the current regulator less headroom")
    thousandths = (formula.exponent - 1.0) * 1000.0
    lowest, highest = THOUSANDTHS_RANGE
    if formula.exponent != 1.0 and not lowest - 1e-6 <= thousandths <= highest + 1e-6:
        found.append(f"exponent {formula.exponent:g} is outside what firmware uses, 1.03 to 1.2")
    return found
