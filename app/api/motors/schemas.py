"""Shapes of the motor data base."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ..schemas import Answer, Body

Positive = Annotated[float, Field(strict=True, gt=0, le=1e4, allow_inf_nan=False)]


class MotorFigures(Body):
    """A motor as its sheet or plate names it."""

    rated_current_a: Positive = Field(description="of a coil [A]")
    full_steps_per_rev: Annotated[int, Field(strict=True, ge=1, le=100_000)] = Field(
        default=200, description="200 for 1.8 degrees a step, 400 for 0.9"
    )
    resistance_ohm: Positive | None = Field(default=None, description="of a coil [ohm]")
    inductance_h: Positive | None = Field(default=None, description="of a coil [H]")
    holding_torque_nm: Positive | None = Field(default=None, description="[N m]")
    rotor_inertia_kgm2: Annotated[float, Field(strict=True, gt=0, le=1e-2, allow_inf_nan=False)] | None = Field(
        default=None, description="[kg m2]"
    )


class MotorInfo(Answer):
    """A motor of the data base; null for what nobody tells."""

    name: str
    own: bool = Field(description="kept on this server, not of the public list")
    source: str = Field(description="where the figures are from")
    rated_current_a: float
    full_steps_per_rev: int
    resistance_ohm: float | None
    inductance_h: float | None
    holding_torque_nm: float | None
    rotor_inertia_kgm2: float | None = Field(description="of motors of your own alone: the public list has none")


class MotorList(Answer):
    """Motors that were found."""

    found: int = Field(description="how many there are; the first `limit` of them are told")
    motors: list[MotorInfo]
