"""Shapes of a start-up: how an axis shall move after power-on, and what is written to that end."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from ...profiles.diff import Difference
from ..schemas import Answer, AxisIndex, Body, Flag

Speed = Annotated[float, Field(strict=True, gt=0, le=8e6, allow_inf_nan=False)]
Acceleration = Annotated[float, Field(strict=True, gt=0, le=1e7, allow_inf_nan=False)]
Amperes = Annotated[float, Field(strict=True, gt=0, le=1000, allow_inf_nan=False)]
Ohms = Annotated[float, Field(strict=True, gt=0, le=1000, allow_inf_nan=False)]
Scale = Annotated[int, Field(strict=True, ge=0, le=255)]
Microsteps = Literal[1, 2, 4, 8, 16, 32, 64, 128, 256]


class StartFigures(Body):
    """How each of the axes shall move. What is null follows from the motor and the soft limits, or is the family's;
    the answer says what was chosen and why."""

    velocity_pps: Speed | None = Field(default=None, description="of moves [microsteps/s]; null: a turn a second")
    acceleration_pps2: Acceleration | None = Field(
        default=None, description="[microsteps/s^2]; null: a turn a second within 0.25 s"
    )
    deceleration_pps2: Acceleration | None = Field(default=None, description="null: the same [microsteps/s^2]")
    microsteps: Microsteps | None = Field(default=None, description="of a full step; null: the finest of the chip")
    run_current_a: Amperes | None = Field(default=None, description="of a coil in motion, RMS [A]")
    hold_current_a: Amperes | None = Field(default=None, description="of a coil at rest, RMS [A]; null: half of it")
    run_scale: Scale | None = Field(default=None, description="current in motion in steps of the chip's own scale")
    hold_scale: Scale | None = Field(default=None, description="current at rest in steps of the chip's own scale")
    counts_per_rev: Annotated[int, Field(strict=True, ge=0, le=1 << 22)] = Field(
        default=0,
        description="of the encoder, four a line; 0: none. That of a second axis takes the pins of both right switches",
    )
    invert_encoder: Flag = False
    stops: Flag = Field(default=True, description="the stop switches are in force")
    stop_low_active: Flag = False


class MotorData(Body):
    """The motor and its power stage; null as the axis's settings have it."""

    full_steps_per_rev: Annotated[int, Field(strict=True, ge=1, le=100_000)] | None = Field(
        default=None, description="becomes the axis's setting"
    )
    rated_current_a: Amperes | None = Field(default=None, description="of a coil, RMS [A]: what it is run with")
    sense_resistor_ohm: Ohms | None = Field(default=None, description="makes amperes of current scales [ohm]; not kept")
    current_full_scale_a: Amperes | None = Field(
        default=None, description="RMS at the greatest current scale, instead of the resistor [A]; not kept"
    )


class DeviceStartUp(StartFigures):
    """Set axes up after power-on."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"axes": [0], "dry_run": True}]})

    axes: Annotated[list[AxisIndex], Field(min_length=1, max_length=8)] | None = Field(
        default=None, description="which; null: all of the device"
    )
    motor: MotorData | None = None
    dry_run: Flag = Field(default=False, description="only tell what would be written")


class AxisStartUp(StartFigures):
    """Set one axis up after power-on. irun and ihold are other names of run_scale and hold_scale."""

    irun: Scale | None = None
    ihold: Scale | None = None


class StartWrite(Difference):
    """A register: `left` is what it holds, or held, and `right` what it shall hold."""

    now: int | None = Field(description="as read back; null of a dry run, and where it cannot be read")
    verified: bool | None = Field(description="it was read back; null of a dry run, and where it cannot be read")


class StartChoice(Answer):
    """A figure that nobody asked for."""

    name: str
    axis: int
    value: float
    unit: str
    why: str


class StartUpReport(Answer):
    """What a start-up writes, or has written and read back."""

    state: Literal["dry run", "applied", "unchanged"]
    axes: list[int]
    writes: list[StartWrite] = Field(description="what was not as it shall be, in the order of writing")
    same: int = Field(description="how many registers were right already")
    chosen: list[StartChoice] = Field(description="figures that nobody asked for, and why they are these")
    prepared: list[str] = Field(description="what was done before, so that nothing moves; it stays")
    warnings: list[str]
    took_s: float | None = None
