"""Current and chopper of a driver with one current scale: shapes, and the way to the calculator behind them."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field

from ....calc.families import CHIPS
from ....calc.tmcdrivers import scale_current as calc
from ....registers.names import ScaleName
from ...schemas import Answer, Body


class ScaleCurrent(Body):
    """The fields of current and chopper, and how the board measures; with `wanted_rms_a` the nearest settings, too."""

    model: ScaleName
    clock_hz: Annotated[float, Field(strict=True, ge=4e6, le=20e6, allow_inf_nan=False)] = 15e6
    sense_resistor_ohm: Annotated[float, Field(strict=True, ge=0.001, le=1000, allow_inf_nan=False)]
    scale: Annotated[int, Field(strict=True, ge=0, le=31)] = Field(description="CS")
    vsense: Annotated[int, Field(strict=True, ge=0, le=1)] = 0
    toff: Annotated[int, Field(strict=True, ge=0, le=15)] = 0
    tbl: Annotated[int, Field(strict=True, ge=0, le=3)] = 0
    wanted_rms_a: Annotated[float, Field(strict=True, gt=0, le=100, allow_inf_nan=False)] | None = None


class ScaleCurrentSetting(Answer):
    scale: int
    vsense: int
    rms_a: float


class ScaleCurrentResult(Answer):
    rms_a: float
    peak_a: float
    full_scale_rms_a: float = Field(description="at CS 31 and this vsense")
    sense_power_w: float = Field(description="of one sense resistor, at rest at the peak of the wave")
    off_s: float | None = Field(description="slow decay; null: TOFF 0, the bridges are off")
    blank_s: float
    chopper_max_hz: float | None
    nearest: list[ScaleCurrentSetting] = Field(description="the best of each vsense, the nearest first; else empty")
    source: str
    warnings: list[str]


def scale_current(body: ScaleCurrent) -> ScaleCurrentResult:
    ohm, clock_hz = body.sense_resistor_ohm, body.clock_hz
    sensing = CHIPS[body.model].sensing
    now = calc.setting(body.model, ohm, body.scale, body.vsense)
    peak_a = now.rms_a * math.sqrt(2)
    warnings = []
    if now.rms_a > sensing.rated_rms_a:
        warnings.append(f"{now.rms_a:.2f} A RMS is more than the {sensing.rated_rms_a:g} A that the chip is made for")
    if body.toff == 0:
        warnings.append("TOFF 0 switches the bridges off")
    elif body.toff == 1 and body.tbl < 2:
        warnings.append("TOFF 1 needs a blank time of 36 clocks or more: TBL 2 or 3")
    return ScaleCurrentResult(
        rms_a=now.rms_a,
        peak_a=peak_a,
        full_scale_rms_a=calc.full_scale_rms_a(body.model, ohm, body.vsense),
        sense_power_w=peak_a**2 * ohm,
        off_s=calc.off_s(clock_hz, body.toff) if body.toff else None,
        blank_s=calc.blank_s(clock_hz, body.tbl),
        chopper_max_hz=calc.highest_chopper_hz(clock_hz, body.toff, body.tbl) if body.toff else None,
        nearest=[
            ScaleCurrentSetting.model_validate(one._asdict())
            for one in (calc.nearest(body.model, ohm, body.wanted_rms_a) if body.wanted_rms_a else ())
        ],
        source=sensing.source,
        warnings=warnings,
    )
