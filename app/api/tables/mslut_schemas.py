"""Shapes of the microstep table of 256 one-bit differences (MSLUT), designed or in a chip."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ...calc.microsteps.mslut import ENTRIES, MIRROR_DEFAULT, Reason
from ...calc.microsteps.mslut_nearest import Norm
from ...calc.microsteps.mslut_waves import Grid
from ...registers.names import MslutName
from ..schemas import Answer, Body, Flag, Int, Number

MslutChip = MslutName
"""Chips whose table is an MSLUT."""
Word = Annotated[int, Field(strict=True, ge=0, le=0xFFFF_FFFF)]
WantedValue = Annotated[int, Field(strict=True, ge=-1000, le=1000)]
WantedValues = Annotated[list[WantedValue], Field(min_length=ENTRIES, max_length=ENTRIES)]
Mirror = Annotated[int, Field(strict=True, ge=-3, le=511)]
MIRROR = "the negative half is mirror - value: -1 its bitwise complement, as after power-on, 0 the exact opposite"


class MslutWords(Body):
    """The registers as they are."""

    mslut: Annotated[list[Word], Field(min_length=8, max_length=8)]
    mslutsel: Word
    mslutstart: Word = Field(description="START_SIN 7:0, START_SIN90 23:16; DAC_OFFSET 31:24 is not touched")


class Harmonic(Body):
    """A harmonic of the current."""

    order: Int = Field(description="3, 5, 7, 9 or 11")
    amplitude: Number = Field(description="relative to the wave's amplitude, -1..1")
    phase_deg: Number = Field(default=0.0, description="0 or 180; anything else is refused as asymmetric")


class AngleCorrection(Body):
    """A turn of the current vector by degrees * sin(order * angle + phase)."""

    order: Int = Field(description="4, 8 or 12, times the electrical angle")
    degrees: Number = Field(description="electrical, -45..45")
    phase_deg: Number = Field(default=0.0, description="0 or 180; anything else is refused as asymmetric")


class MslutDesign(Body):
    """A wave from a formula; or from `values` drawn by hand, or `registers` of a chip, of which the rest is figures.

    The formula is amplitude * (shape(sigma)^exponent + harmonics), at an angle turned by `corrections`.
    """

    chip: MslutChip
    sigma: Annotated[float, Field(strict=True, ge=-1, le=1, allow_inf_nan=False)] = 0.0
    exponent: Number = Field(default=1.0, description="f of the sin^f linearity correction, 0.2..5")
    thousandths: Number | None = Field(
        default=None, description="instead of `exponent`, as printer firmware has it: f = 1 + thousandths / 1000"
    )
    harmonics: Annotated[tuple[Harmonic, ...], Field(max_length=8)] = ()
    corrections: Annotated[tuple[AngleCorrection, ...], Field(max_length=4)] = ()
    amplitude: Number | None = Field(default=None, description="the grid's own where null: 248, 248, 247")
    full_scale: Flag = Field(default=False, description="stretch a box (sigma > 0) until it reaches the amplitude")
    grid: Grid | None = Field(
        default=None,
        description="where angles are taken and what the negative half is: complement (as after power-on), opposite "
        "(the truest), whole_step (as printer firmware); null: whole_step with an exponent, else complement",
    )
    values: WantedValues | None = Field(default=None, description="a quarter wave drawn by hand, encodable or not")
    mirror: Mirror = Field(default=MIRROR_DEFAULT, description=f"with `values`: {MIRROR}")
    registers: MslutWords | None = None
    norm: Norm = Field(default="least_squares", description="what the nearest encodable wave is nearest by")


class MslutRegister(Answer):
    """One register to write."""

    name: str
    address: int
    value: int
    hex: str


class MslutSegment(Answer):
    """Entries first..last differ from the one before by `low` or `low` + 1; W of MSLUTSEL is `width`."""

    first: int
    last: int
    low: int
    width: int


class MslutTable(Answer):
    """A wave that can be encoded, and its registers."""

    values: list[int] = Field(description="the quarter wave, 256 values of 0..255")
    mirror: int = Field(description=MIRROR)
    registers: list[MslutRegister]
    segments: list[MslutSegment]


class AngleOrderOut(Answer):
    order: int
    amplitude_deg: float
    amplitude_microsteps: float


class MslutFigures(Answer):
    """Figures over the electrical period; angles are electrical, microsteps 1/1024 of the period."""

    amplitude_min: float
    amplitude_mean: float
    amplitude_max: float
    torque_ripple: float | None = Field(description="(max - min) / mean of the vector length; null without current")
    torque_ripple_rms: float | None
    angle_error_deg: list[float] | None = Field(description="at positions 0..255; the other quarters repeat it")
    vector_length: list[float]
    angle_error_max_deg: float | None
    angle_error_rms_deg: float | None
    angle_error_max_microsteps: float | None
    angle_error_rms_microsteps: float | None
    worst_position: int | None
    angle_orders: list[AngleOrderOut] | None = Field(description="sine parts of the angle error, 4 to 16 a period")
    largest_step_ratio: float | None
    smallest_step_ratio: float | None
    quantisation_max: float | None = Field(description="from the formula's value [counts]; null without a formula")
    quantisation_rms: float | None
    harmonics: list[float] | None = Field(description="of the current, 1 to 15, relative to the first")
    thd: float | None
    warnings: list[str]


class MslutRefusal(Answer):
    """Why a wave cannot be encoded at entry `index`."""

    index: int
    reason: Reason
    detail: str


class MslutNearest(Answer):
    """The encodable wave nearest to a wanted one that is not."""

    norm: Norm
    table: MslutTable
    distance_rms: float = Field(description="from the wanted wave [counts]")
    distance_max: float
    metrics: MslutFigures


class MslutResult(Answer):
    """A wave as it was wanted; its registers, or why there are none and which wave is nearest."""

    chip: MslutChip
    encodable: bool
    values: list[int] = Field(description="as wanted, rounded; 256 values that need not be encodable")
    mirror: int
    ideal: list[float] | None = Field(description="before rounding; null without a formula")
    table: MslutTable | None
    refusals: list[MslutRefusal] = Field(description="from left to right; empty for an encodable wave")
    nearest: MslutNearest | None
    metrics: MslutFigures = Field(description="of the wave as wanted")
    warnings: list[str]


class MslutWrite(Body):
    """A table for the chip: its values, or the registers themselves. One of the two."""

    values: WantedValues | None = None
    mirror: Mirror = Field(default=MIRROR_DEFAULT, description=f"with `values`: {MIRROR}")
    registers: MslutWords | None = None


class MslutHeld(MslutTable):
    """The table that a chip holds.

    Its registers can be written only, so they are what was last written through this connection, or those of power-on.
    What the chip shows of it is `position` (MSCNT) and both currents; `current_*_expected` is what the table has there.
    """

    written: bool = Field(description="false: nothing was written yet, the power-on wave is assumed")
    position: int
    current_a: int
    current_b: int
    current_a_expected: int
    current_b_expected: int
    agrees: bool = Field(description="at rest; of a moving motor the three readings may belong to different microsteps")
