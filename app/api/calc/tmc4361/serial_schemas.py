"""Shapes of serial encoders at a TMC4361: the bits of an answer and what the clock settings come to."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ...schemas import Answer, Body, Flag

Clocks = Annotated[int, Field(strict=True, ge=0, le=1 << 20)]


class SerialEncoder(Body):
    """The answer of an encoder, and how it is asked."""

    kind: Literal["ssi", "spi"] = "ssi"
    clock_hz: Annotated[float, Field(strict=True, ge=4.2e6, le=32e6, allow_inf_nan=False)] = Field(
        default=16e6, description="fCLK [Hz]"
    )
    single_bits: Annotated[int, Field(strict=True, ge=1, le=32)] = Field(description="of the angle")
    multi_bits: Annotated[int, Field(strict=True, ge=0, le=32)] = Field(default=0, description="of the turns, 0: none")
    status_bits: Annotated[int, Field(strict=True, ge=0, le=3)] = 0
    gray: Flag = False
    status_last: Flag = Field(default=False, description="left_aligned_data")
    high: Clocks = Field(default=160, description="SER_CLK_IN_HIGH")
    low: Clocks = Field(default=160, description="SER_CLK_IN_LOW")
    delay: Clocks = Field(default=0, description="SSI_IN_CLK_DELAY")
    repeat_wait: Clocks = Field(default=0, description="SSI_IN_WTIME")
    period: Clocks = Field(default=0, description="SER_PTIME")
    twice: Flag = Field(default=False, description="ssi_multi_cycle_data")
    variation: Annotated[int, Field(strict=True, ge=0, le=255)] = Field(default=0, description="SER_ENC_VARIATION")
    counts_per_turn: Annotated[int, Field(strict=True, ge=0, lt=1 << 31)] = Field(default=0, description="ENC_IN_RES")
    turns: Annotated[int, Field(strict=True, ge=-(1 << 31), lt=1 << 31)] = Field(
        default=1, description="of the place whose answer is shown"
    )
    angle: Annotated[int, Field(strict=True, ge=0, lt=1 << 32)] = Field(default=1, description="of that place, counts")


class SerialEncoderResult(Answer):
    names: list[str] = Field(description="T turns, A angle, S status with their places, the first sent first")
    bits: list[int] = Field(description="of the place that was asked for")
    bit_hz: float
    answer_s: float
    period_s: float = Field(description="from one request to the next")
    pause_s: float = Field(description="rest of the clock between two requests")
    angle_deg: float = Field(description="one count")
    turns: int = Field(description="turns that are told apart")
    speed_rpm: float | None = Field(description="fastest that turns are counted right; null: no limit")
    warnings: list[str]
