"""Shapes of what a TMC4361's ramp is answered with, beside its curve."""

from __future__ import annotations

from pydantic import Field

from app.api.schemas import Answer


class RampLimit(Answer):
    """How much of a limit a ramp uses: both magnitudes."""

    name: str = Field(description="the register: VMAX, AMAX, DMAX")
    limit: float
    peak: float
    unit: str
    reached: bool


class RampFinding(Answer):
    """Something that the data sheet warns of, or that makes a parameter idle."""

    code: str = Field(description="stable, for programs")
    parameter: str | None = Field(description="which parameter to look at, as in `parameters`; null for none alone")
    text: str


class RampRegister(Answer):
    """What a parameter becomes in its register."""

    parameter: str
    name: str = Field(description="the register")
    raw: int
    value: float = Field(description="what the register then stands for [unit]")
    least: float = Field(description="the step from one value to the next [unit]")
    highest: float = Field(description="the greatest that it can stand for [unit]")
    why_highest: str
    unit: str


class RampRival(Answer):
    """Another way to make the same move, to compare with."""

    name: str = Field(description='"trapezoid", "motor_trapezoid", "motor_limit"')
    text: str
    duration_s: float
    saved_s: float = Field(description="how much sooner than that the ramp is done; negative: later [s]")
    vmax_pps: float
    amax_pps2: float
    dmax_pps2: float
