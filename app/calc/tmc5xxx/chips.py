"""The chips with SixPoint ramps, in what their calculations differ."""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

Stealth = Literal["none", "fixed", "gradient", "tuned"]
"""Without StealthChop; an amplitude alone; with a gradient besides; with a gradient that the chip tunes by itself."""


class Sensing(NamedTuple):
    """How a chip measures current.

    full_scale_v : at vsense 0 and 1; one number where GLOBALSCALER takes its place
    added_ohm : inside of the chip, on the way to the comparator
    rated_rms_a : of a coil; infinite where transistors outside decide
    range_va : without sense resistors: the resistor at IREF times the peak current of each CURRENT_RANGE [Ohm A]
    """

    full_scale_v: tuple[float, ...]
    added_ohm: float
    rated_rms_a: float
    source: str
    range_va: tuple[float, ...] = ()

    @property
    def scaled(self) -> bool:
        """Whether there is a GLOBALSCALER instead of vsense."""
        return len(self.full_scale_v) < 2


class Sheet(NamedTuple):
    """What a chip's chopper has, and where its data sheet tells it."""

    stealth: Stealth
    least_irun: int
    """Below it StealthChop does not regulate by itself."""
    spreadcycle: str
    stealthchop: str


class Chip(NamedTuple):
    """A chip as its registers count.

    one_axis : its thresholds count TSTEP, and it has a TPOWERDOWN; first_free : whose first unit is a single clock
    dcstep : it has a VDCMIN. eight_point : two corners more, and accelerations of 18 bits
    reference : it can measure current inside, by a resistor at AIN_IREF
    """

    sensing: Sensing
    sheet: Sheet
    one_axis: bool = False
    first_free: bool = False
    dcstep: bool = True
    eight_point: bool = False
    reference: bool = False


_DUAL = ((0.32, 0.18), 0.02, 1.1)
CHIPS = {
    "tmc5031": Chip(Sensing(*_DUAL, "DS-TMC5031 6"), Sheet("none", 0, "DS-TMC5031 7", ""), dcstep=False),
    "tmc5062": Chip(Sensing(*_DUAL, "DS-TMC5062 7"), Sheet("none", 0, "DS-TMC5062 8", "")),
    "tmc5072": Chip(Sensing(*_DUAL, "DS-TMC5072 7 and 23.2"), Sheet("fixed", 6, "DS-TMC5072 9", "DS-TMC5072 8")),
    "tmc5130": Chip(
        Sensing((0.325, 0.18), 0.02, 1.4, "DS-TMC5130 10 and 30.2"),
        Sheet("gradient", 8, "DS-TMC5130 8", "DS-TMC5130 7"),
        one_axis=True,
        first_free=True,
        reference=True,
    ),
    "tmc5160": Chip(
        Sensing((0.325,), 0.0, math.inf, "DS-TMC5160 9 and 28.2"),
        Sheet("tuned", 8, "DS-TMC5160 8", "DS-TMC5160 7"),
        one_axis=True,
    ),
    # its chopper is taken for that of a TMC5160: fields and defaults are the same (inferred)
    "tmc5240": Chip(
        Sensing((), 0.0, 2.1, "KLIPPER; DS-TMC2240", (11_750.0, 24_000.0, 36_000.0, 36_000.0)),
        Sheet("tuned", 8, "DS-TMC5160 8", "DS-TMC5160 7"),
        one_axis=True,
        eight_point=True,
    ),
}
