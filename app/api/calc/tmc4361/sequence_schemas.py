"""Shapes of sequences of a TMC4361: targets, triggers and shadow registers, and the whole motion."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ...schemas import Answer, Body, Flag

Place = Annotated[int, Field(strict=True, ge=-(1 << 31), lt=1 << 31)]
Amount = Annotated[float, Field(strict=True, ge=0, le=1e12, allow_inf_nan=False)]
Clocks = Annotated[int, Field(strict=True, ge=0, lt=1 << 32)]
Time = Annotated[float, Field(strict=True, ge=0, le=3600, allow_inf_nan=False)]


class SequenceRamp(Body):
    """Ramp registers by their names in lower case [pps, pps^2, pps^3]."""

    values: dict[str, Amount] = Field(max_length=12, description="vmax, amax, dmax, bow1...; what is left out is 0")
    shape: Literal["s", "trapezoid", "hold"] = "s"


class SequenceShadow(Body):
    """Shadow registers that a start exchanges the ramp with."""

    option: Annotated[int, Field(strict=True, ge=0, le=3)] = Field(description="shadow_option")
    sets: list[SequenceRamp] = Field(
        min_length=1, max_length=2, description="one for option 0; what a set leaves out is as in the ramp"
    )
    cyclic: Flag = Field(default=False, description="cyclic_shadow_regs")
    misses: Annotated[int, Field(strict=True, ge=0, le=15)] = Field(default=0, description="shadow_miss_cnt")


class TargetSequence(Body):
    """Targets, and what leads from one to the next."""

    position: Place = Field(default=0, description="where it stands [microsteps]")
    targets: list[Place] = Field(min_length=1, max_length=9, description="8 at most where START triggers")
    ramp: SequenceRamp
    trigger: Literal["target", "start"] = Field(default="target", description="TARGET_REACHED, or the pin START")
    shadow: SequenceShadow | None = None
    clock_hz: Annotated[float, Field(strict=True, ge=4.2e6, le=32e6, allow_inf_nan=False)] = 16e6
    direct_acc_val_en: Flag = False
    direct_bow_val_en: Flag = False
    use_astart_and_vstart: Flag = False
    delay: Clocks = Field(default=0, description="START_DELAY")
    zero_wait: Clocks = Field(default=0, description="TZEROWAIT")
    pulses_s: list[Time] = Field(default=[], max_length=64, description="edges of START, rising times")
    immediate: Flag = Field(default=False, description="immediate_start_in")
    active_high: Flag = Field(default=False, description="pol_start_signal")
    ring: Flag = Field(default=False, description="the pipeline goes round (xpipe_rewrite_reg)")
    moves_most: Annotated[int, Field(strict=True, ge=1, le=64)] = Field(default=20, description="moves to look at")
    samples: Annotated[int, Field(strict=True, ge=2, le=4000)] = 800


class SequenceWord(Answer):
    name: str
    value: int


class SequenceMove(Answer):
    """A way to a target."""

    start_s: float = Field(description="when the start gives the target")
    begin_s: float = Field(description="when the motor moves")
    end_s: float = Field(description="when it is there, or is sent elsewhere")
    origin: float
    target: int
    reached: bool
    shape: Literal["s", "trapezoid", "hold"]
    vmax_pps: float


class TargetSequenceResult(Answer):
    words: list[SequenceWord] = Field(description="in the order of writing: what sets it going comes last")
    moves: list[SequenceMove]
    starts_s: list[float] = Field(description="every start, also those after which nothing moves")
    ends: bool = Field(description="it comes to rest by itself; else only the first moves are here")
    duration_s: float
    time_s: list[float]
    position: list[float]
    velocity_pps: list[float]
    findings: list[str]
