"""Shapes of the calculator that corrects a motor's angle error."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ..schemas import Answer, Body

Part = Annotated[float, Field(strict=True, ge=-20, le=20, allow_inf_nan=False)]


class ErrorHarmonic(Body):
    """sine * sin(order * angle) + cosine * cos(order * angle): rotor less field, over the field's angle."""

    order: Annotated[int, Field(strict=True, ge=1, le=16)]
    sine_deg: Part = Field(default=0.0, description="[deg electrical]")
    cosine_deg: Part = Field(default=0.0, description="the same")


class MicrostepCorrection(Body):
    """A motor's own angle error, measured with a sine: by an encoder, or a laser pointer as DS-TMC428 12.3 has it."""

    table: Literal["ram64", "mslut"] = Field(
        default="mslut", description="64 entries of 6 bits in RAM, or one-bit differences (MSLUT)"
    )
    harmonics: Annotated[list[ErrorHarmonic], Field(max_length=16)]


class ShapedTable(Answer):
    """The best table of the formula of DS-TMC428 12.3."""

    sigma: float
    offset: float
    values: list[int]
    left_deg: float = Field(description="what it is expected to leave, root mean square [deg electrical]")


class MicrostepCorrectionResult(Answer):
    """Errors are root mean square [deg electrical]; of tables what they are expected to leave."""

    values: list[int] = Field(description="64 of a table in RAM, 256 of an MSLUT, as PUT /microstep-table takes them")
    left_deg: float
    sine_deg: float = Field(description="with the table of a sine that the data sheet has")
    beyond_deg: float = Field(description="what no table of a quarter wave takes away, of any resolution")
    shaped: ShapedTable | None = Field(description="of a table in RAM; an MSLUT has no such formula")
