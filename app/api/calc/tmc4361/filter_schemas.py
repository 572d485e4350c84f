"""Shapes of the input filters of a TMC4361: what becomes of a waveform, and which filters there are."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ...schemas import Answer, Body

Setting = Annotated[int, Field(strict=True, ge=0, le=7)]
Level = Annotated[int, Field(strict=True, ge=0, le=1)]
CLOCKS_MOST = 32_768
"""2 ms at 16 MHz, 32 times what the slowest filter needs for an edge; more would be longer, not better."""


class InputFilter(Body):
    """A waveform at a pin and the filter behind it."""

    clock_hz: Annotated[float, Field(strict=True, ge=4.2e6, le=32e6, allow_inf_nan=False)] = Field(
        default=16e6, description="fCLK [Hz]"
    )
    sample_rate: Setting = Field(description="SR: a sample every 2^SR clocks")
    length: Setting = Field(description="FILT_L: so many equal samples and one more make a level")
    input: Annotated[list[Level], Field(min_length=1, max_length=CLOCKS_MOST)] = Field(
        description="level of the pin, one for each clock"
    )
    initial: Level | None = Field(default=None, description="the level all the time before; null: the first one")
    phase: Annotated[int, Field(strict=True, ge=0, le=127)] = Field(
        default=0, description="clock of the first sample, below 2^SR: the chip does not tell it"
    )


class FilterBounds(Answer):
    """What the filter does to any edge and pulse, wherever its samples fall."""

    period_clocks: int = Field(description="between two samples")
    delay_min_clocks: int
    delay_max_clocks: int = Field(description="from an edge to when it counts")
    stopped_clocks: int = Field(description="pulses up to here never pass")
    passed_clocks: int = Field(description="pulses from here on always pass")
    period_s: float
    delay_min_s: float
    delay_max_s: float
    stopped_s: float
    passed_s: float


class InputFilterResult(Answer):
    """The waveform before and after, with the places where it was looked at."""

    input: list[int]
    output: list[int] = Field(description="the level that the chip works with, one for each clock")
    sample_clocks: list[int]
    samples: list[int] = Field(description="level of each sample")
    bounds: FilterBounds


class FilterGroup(Answer):
    """Pins that share a filter, and its fields in INPUT_FILT_CONF."""

    suffix: str = Field(description="as the fields end: enc_in, ref, s, enc_out")
    pins: list[str]
    sample_rate_field: str
    length_field: str
    step_input_field: str = Field(description="whether the filter also serves STPIN and DIRIN")


class FilterExample(Answer):
    """A setting that the data sheet draws, with a waveform that shows what it does."""

    figure: str
    group: str
    sample_rate: int
    length: int
    pin: str
    input: list[int]


class InputFilters(Answer):
    register_name: str
    groups: list[FilterGroup]
    examples: list[FilterExample]
