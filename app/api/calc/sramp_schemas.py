"""Shapes of what a TMC4361's ramp is answered with, beside its curve."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ...calc.motor_torque import StepperMotor
from ..schemas import Answer, Body

Positive = Annotated[float, Field(strict=True, gt=0, le=1e9, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(strict=True, ge=0, le=1e9, allow_inf_nan=False)]


class RampMotor(Body):
    """The motor, its driver and its load, to compare a ramp with; the defaults are a common 40 mm motor and a slide."""

    holding_torque_nm: Positive = Field(
        default=StepperMotor.holding_torque_nm, description="both phases at the rated current"
    )
    rated_current_a: Positive = StepperMotor.rated_current_a
    current_a: Positive = Field(
        default=StepperMotor.current_a, description="what the driver is set to, peak of the sine"
    )
    resistance_ohm: Positive = StepperMotor.resistance_ohm
    inductance_h: Positive = StepperMotor.inductance_h
    supply_v: Positive = StepperMotor.supply_v
    inertia_kgm2: Positive = Field(default=StepperMotor.inertia_kgm2, description="rotor and load, at the shaft")
    full_steps_per_rev: Positive = StepperMotor.full_steps_per_rev
    microsteps_per_full_step: Positive = StepperMotor.microsteps_per_full_step
    friction_nm: NotNegative = StepperMotor.friction_nm
    damping_nms: NotNegative = Field(default=StepperMotor.damping_nms, description="friction that grows with speed")
    load_nm: NotNegative = Field(default=StepperMotor.load_nm, description="against the motion")


class RampTorque(Answer):
    """What the ramp asks of the motor at each of its samples, and what that could give."""

    available_nm: list[float] = Field(description="not negative")
    required_nm: list[float] = Field(description="signed")
    margin: float = Field(description="the least part of the available torque that is left; below 0 it is too little")
    margin_at_s: float
    speed_pps: list[float] = Field(description="of the motor's curve, from 0 on")
    curve_nm: list[float]


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
