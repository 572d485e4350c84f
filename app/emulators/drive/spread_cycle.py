"""What SpreadCycle makes of a wave: the mean current of its cycles, their ripple and length, in closed formulas.

A cycle drives the current up to its reference plus half the hysteresis, lets it decay slowly, drives it down to the
reference less half the hysteresis, and lets it decay slowly again; both driven phases last the blank time at least
(DS-TMC5160 8.1). So with too little hysteresis the blank time takes a small current down to nothing: a plateau where
the wave crosses zero (AN-SPREADCYCLE), four times an electrical period. With much of it the lower edge lies below zero,
where the comparator, which knows one direction, sees nothing: the current is driven down to zero alone, and its mean is
a little too high there (INFERRED). The rest of too much is noise and heat, which no shaft shows.

Not in it: the back-EMF's part in the slow decays, which shifts a sine and bends nothing; the decrement from HSTRT to
HEND within a cycle; ringing at the sense resistor, which a short blank time would see.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Chopper:
    """SI units. blank_s, decay_s : of each driven phase at the least, and of each slow decay; band_a : hysteresis from
    edge to edge [A]."""

    resistance_ohm: float
    inductance_h: float
    supply_v: float
    blank_s: float
    decay_s: float
    band_a: float


@dataclass(frozen=True, slots=True)
class Cycles:
    """Of cycles at each of some references: mean current and ripple from peak to peak [A], length [s]."""

    mean_a: Floats
    ripple_a: Floats
    length_s: Floats


def cycles(chopper: Chopper, wanted_a: Floats) -> Cycles:
    """Steady cycles at currents `wanted_a` of one direction, 0 or more [A].

    Slopes are those at the reference. A current that the supply cannot drive is its own mean: nothing is chopped.
    """
    lost = chopper.resistance_ohm * chopper.decay_s / chopper.inductance_h
    """Share of a current that a slow decay takes."""
    up = (chopper.supply_v - chopper.resistance_ohm * wanted_a) / chopper.inductance_h
    down = (chopper.supply_v + chopper.resistance_ohm * wanted_a) / chopper.inductance_h
    peak = np.maximum(wanted_a + chopper.band_a / 2, 0.0)
    decayed = peak * (1 - lost)
    edge = np.maximum(wanted_a - chopper.band_a / 2, 0.0)
    low = np.minimum(edge, decayed - down * chopper.blank_s)
    start = low * (1 - lost)
    chopped = up > 0.0
    rise_s = np.divide(peak - start, up, out=np.zeros_like(up), where=chopped)
    fall_s = np.divide(decayed - low, down, out=np.zeros_like(down), where=chopped)
    length_s = rise_s + fall_s + 2 * chopper.decay_s
    area = ((start + peak) * rise_s + (peak + decayed + low + start) * chopper.decay_s + (decayed + low) * fall_s) / 2
    highest, lowest = np.maximum(peak, start), np.minimum(low, start)
    return Cycles(
        np.where(chopped, np.maximum(np.divide(area, length_s, out=np.zeros_like(area), where=chopped), 0.0), wanted_a),
        np.where(chopped, highest - lowest, 0.0),
        np.where(chopped, length_s, 0.0),
    )


def bent(chopper: Chopper, wave: Floats, peak_a: float) -> Floats:
    """A wave of shares of `peak_a` [A] as the chopper makes it, in such shares."""
    if peak_a <= 0.0:
        return wave
    return np.sign(wave) * cycles(chopper, np.abs(wave) * peak_a).mean_a / peak_a
