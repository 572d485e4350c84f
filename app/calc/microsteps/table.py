"""Microstep tables for the TMC428: designed from a formula, or checked when drawn by hand.

Source: DS-TMC428 chapter 12. This module is the front door: datagrams, sequencer and metrics of a table
live in the modules beside it and are handed on from here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from ..driver_chain.ram_words import CELL_MAX
from .datagrams import checked_values, table_datagrams, table_ram_words, values_from_ram_words
from .metrics import AngleStep, TableMetrics, metrics
from .sequencer import SequencerStep, step_through
from .shapes import SIGMA_RANGE_OF_THE_SHEET, f_sigma, quarter_positions

__all__ = [
    "METHODS",
    "AngleStep",
    "Method",
    "SequencerStep",
    "TableDesign",
    "TableMetrics",
    "checked_values",
    "design_table",
    "metrics",
    "step_through",
    "table_datagrams",
    "table_ram_words",
    "values_from_ram_words",
]

Method = Literal["half_rounded_64", "63", "offset"]
METHODS: tuple[Method, ...] = get_args(Method)


@dataclass(frozen=True, slots=True)
class TableDesign:
    """A designed table: 64 `values` of 0..63 [DAC counts] and the wanted ones before rounding.

    `ideal` is what the formula gives before int() and clamp, without its added 1/2.
    """

    sigma: float
    offset: float
    amplitude: float
    method: Method
    full_scale: bool
    values: tuple[int, ...]
    ideal: tuple[float, ...]
    warnings: tuple[str, ...]


def design_table(
    sigma: float = 0.0,
    offset: float = 0.0,
    amplitude: float = CELL_MAX,
    method: Method = "half_rounded_64",
    *,
    full_scale: bool = False,
) -> TableDesign:
    """The 64 values of a quarter period of the shape `sigma`.

    With f = f_sigma(i / 64), o = `offset` and A = `amplitude` (the sheet's 63):

    - "half_rounded_64": int(1/2 + o + (A + 1 - o) * f), and A where that is more;
    - "63": int(A * f);
    - "offset": int(o + (A - o) * f).

    At o = 0, A = 63, sigma = 0 these are the three formulas of chapter 12 in its order. An offset
    given with "63" makes it the formula "offset", with a warning.

    Normalisation: f = 1 stands for A, and no value is above A. The sine and the rhomb reach 1 at the
    end of the quarter; the box stands inside the unit circle and reaches only 1/sqrt(2) (Figure
    12-1), so sigma > 0 uses less than A. `full_scale` stretches the shape until it reaches 1.

    Raises ValueError for sigma outside -1..1, amplitude outside 0..63, offset outside
    0..amplitude (NaN is outside everything), or an unknown method.
    """
    if method not in METHODS:
        raise ValueError(f"no method is called {method!r}; known: {', '.join(METHODS)}")
    if not 0 <= amplitude <= CELL_MAX:
        raise ValueError(f"amplitude is {amplitude}, allowed is 0..{CELL_MAX}")
    if not 0 <= offset <= amplitude:
        raise ValueError(f"offset is {offset}, allowed is 0..{amplitude:g} (the amplitude)")
    shape = f_sigma(quarter_positions(), sigma)
    if full_scale:
        shape = shape / float(f_sigma(1.0, sigma))
    rounding, gain = (0.5, amplitude + 1 - offset) if method == "half_rounded_64" else (0.0, amplitude - offset)
    ideal = offset + gain * shape
    # The clamp is for every formula: int() of the others never passes A except by a last-digit error.
    values = np.minimum(np.floor(rounding + ideal), math.floor(amplitude)).astype(int)
    return TableDesign(
        sigma=float(sigma),
        offset=float(offset),
        amplitude=float(amplitude),
        method=method,
        full_scale=full_scale,
        values=tuple(values.tolist()),
        ideal=tuple(ideal.tolist()),
        warnings=tuple(_warnings(sigma, offset, amplitude, method)),
    )


def _warnings(sigma: float, offset: float, amplitude: float, method: Method) -> list[str]:
    found: list[str] = []
    lowest, highest = SIGMA_RANGE_OF_THE_SHEET
    if not lowest <= sigma <= highest:
        found.append(f"sigma {sigma:g} is outside the data sheet's range {lowest:g}..{highest:g}")
    if offset > 0 and method == "63":
        found.append('the formula "63" knows no offset; with one it is the formula "offset"')
    if offset > 0:
        found.append("an offset makes the current jump at each zero crossing; it is meant for mixed decay")
    if amplitude == 0:
        found.append("amplitude 0 leaves the motor without current")
    return found
