"""Currents and chopper times of a driver with one current scale (TMC26x): forth, and back from a wanted current.

A sine wave through a coil has the peak V_FS / R_sense * (CS + 1) / 32, V_FS by vsense (KLIPPER-TMC2660). The times of
the chopper are those of a TMC5130 (inferred): a slow decay is 24 + 32 TOFF clocks, TBL one of four blank times.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..families import CHIPS
from ..tmc5xxx.chopper import BLANK_CLOCKS

SCALES = 32


class ScaleSetting(NamedTuple):
    """scale : CS. rms_a : [A]."""

    scale: int
    vsense: int
    rms_a: float


def full_scale_rms_a(model: str, sense_ohm: float, vsense: int) -> float:
    """RMS of a coil at CS 31 [A]. `sense_ohm` [Ohm] is above 0."""
    return CHIPS[model].sensing.full_scale_v[vsense] / sense_ohm / math.sqrt(2)


def setting(model: str, sense_ohm: float, scale: int, vsense: int) -> ScaleSetting:
    """What a scale gives."""
    return ScaleSetting(scale, vsense, full_scale_rms_a(model, sense_ohm, vsense) * (scale + 1) / SCALES)


def nearest(model: str, sense_ohm: float, wanted_rms_a: float) -> list[ScaleSetting]:
    """The best of each vsense for a current [A], the nearest first; of two alike the finer one."""
    found = []
    for vsense in (1, 0):
        scale = round(SCALES * wanted_rms_a / full_scale_rms_a(model, sense_ohm, vsense)) - 1
        found.append(setting(model, sense_ohm, min(max(scale, 0), SCALES - 1), vsense))
    return sorted(found, key=lambda one: abs(one.rms_a - wanted_rms_a))


def off_s(clock_hz: float, toff: int) -> float:
    """A slow decay [s]; TOFF 0 switches the bridges off."""
    return (24 + 32 * toff) / clock_hz


def blank_s(clock_hz: float, tbl: int) -> float:
    """For how long the comparator is blind behind each switching [s]."""
    return BLANK_CLOCKS[tbl] / clock_hz


def highest_chopper_hz(clock_hz: float, toff: int, tbl: int) -> float:
    """Two slow decays and two blank times are the shortest cycle [Hz]."""
    return 1 / (2 * off_s(clock_hz, toff) + 2 * blank_s(clock_hz, tbl))
