"""A macro as a document: a name, and steps in registers' own names and physical units."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field, StringConstraints, model_validator

from ..deferred import DeferredModel
from ..number_text import plain

FORMAT = "stepscope.macro"
STEPS_MAX = 200
LONGEST_S = 3600.0
CHANNELS_MAX = 32

PositionUnit = Literal["microsteps", "fullsteps", "rev", "deg", "rad", "mm"]
VelocityUnit = Literal["pps", "chip", "fullsteps_per_s", "rps", "rpm", "rad_per_s", "mm_per_s"]
AxisIndex = Annotated[int, Field(strict=True, ge=0, le=31)]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Seconds = Annotated[float, Field(strict=True, ge=0, le=LONGEST_S, allow_inf_nan=False)]
Bound = Annotated[float, Field(strict=True, gt=0, le=LONGEST_S, allow_inf_nan=False)]
Name = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=60, pattern=r"^[^\x00-\x1f\x7f]+$")]
Label = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=80, pattern=r"^[^\x00-\x1f\x7f]+$")]
ChannelName = Annotated[str, StringConstraints(strict=True, pattern=r"^[a-z][a-z0-9_]{0,40}\.[0-9]{1,2}$")]
Word = Annotated[int, Field(strict=True, ge=-(1 << 63), lt=1 << 63)]


class _Step(DeferredModel):
    model_config = ConfigDict(extra="forbid")


class WriteStep(_Step):
    """Write a register, parameter or field, and read it back."""

    do: Literal["write"]
    name: Name = Field(description="as in the data sheet")
    axis: AxisIndex | None = Field(default=None, description="null for registers of the whole chip")
    value: Word | None = Field(default=None, description="the whole value; else `fields`")
    fields: dict[Name, Word] | None = Field(default=None, min_length=1, max_length=64)

    @model_validator(mode="after")
    def _one_of_both(self) -> WriteStep:
        if (self.value is None) == (self.fields is None):
            raise ValueError("a write has a value, or fields")
        return self

    @property
    def text(self) -> str:
        to = self.value if self.fields is None else ", ".join(f"{name} {value}" for name, value in self.fields.items())
        return f"write {self.name}{_of(self.axis)}: {to}"


class MoveStep(_Step):
    """Start a move by the axis's ramp as it is set. A wait that follows waits for its end."""

    do: Literal["move"]
    axis: AxisIndex = 0
    target: Number
    relative: bool = Field(default=False, strict=True)
    unit: PositionUnit = "microsteps"

    @property
    def text(self) -> str:
        return f"move axis {self.axis} {'by' if self.relative else 'to'} {plain(self.target)} {self.unit}"


class RotateStep(_Step):
    """Turn on and on, until a later step, or a stop."""

    do: Literal["rotate"]
    axis: AxisIndex = 0
    velocity: Number
    unit: VelocityUnit = "pps"

    @property
    def text(self) -> str:
        return f"rotate axis {self.axis} at {plain(self.velocity)} {self.unit}"


class StopStep(_Step):
    """Stop an axis."""

    do: Literal["stop"]
    axis: AxisIndex = 0
    mode: Literal["ramp", "immediate"] = "ramp"

    @property
    def text(self) -> str:
        return f"stop axis {self.axis}{' dead' if self.mode == 'immediate' else ''}"


class WaitStep(_Step):
    """Wait for a time."""

    do: Literal["wait"]
    seconds: Seconds

    @property
    def text(self) -> str:
        return f"wait {plain(self.seconds)} s"


class WaitPosition(_Step):
    """Wait until an axis is where it was sent."""

    do: Literal["wait position"]
    axis: AxisIndex = 0
    at_most_s: Bound = Field(default=60.0, description="then the macro has failed")

    @property
    def text(self) -> str:
        return f"wait until axis {self.axis} is there, at most {plain(self.at_most_s)} s"


class WaitChannel(_Step):
    """Wait until a telemetry channel is above, or below, a value."""

    do: Literal["wait channel"]
    channel: ChannelName
    when: Literal["above", "below"]
    value: Number = Field(description="in the channel's unit")
    at_most_s: Bound = Field(default=60.0, description="then the macro has failed")

    @property
    def text(self) -> str:
        return f"wait until {self.channel} is {self.when} {plain(self.value)}, at most {plain(self.at_most_s)} s"


class RecordStart(_Step):
    """Begin to record. The macro's end ends it too."""

    do: Literal["record start"]
    name: Label = "macro"
    channels: Annotated[list[ChannelName], Field(min_length=1, max_length=CHANNELS_MAX)]
    rate_hz: Annotated[float, Field(strict=True, ge=1, le=1000, allow_inf_nan=False)] = 200.0

    @property
    def text(self) -> str:
        return f"record {', '.join(self.channels)} as {self.name!r}"


class RecordStop(_Step):
    """End the recording."""

    do: Literal["record stop"]

    @property
    def text(self) -> str:
        return "stop recording"


class ApplyProfile(_Step):
    """Bring a kept profile into the device: all of it, or nothing. Its motors have to stand."""

    do: Literal["profile"]
    profile: Annotated[int, Field(strict=True, ge=1, lt=1 << 53)] = Field(description="number of the kept profile")
    name: Annotated[str, StringConstraints(strict=True, max_length=100)] = Field(
        default="", description="what it was called, for people"
    )

    @property
    def text(self) -> str:
        return f"apply profile {self.profile}{f', {self.name}' if self.name else ''}"


Step = Annotated[
    WriteStep
    | MoveStep
    | RotateStep
    | StopStep
    | WaitStep
    | WaitPosition
    | WaitChannel
    | RecordStart
    | RecordStop
    | ApplyProfile,
    Field(discriminator="do"),
]


class MacroDocument(DeferredModel):
    """A macro. Its steps are done one after the other, each once."""

    model_config = ConfigDict(extra="forbid")

    format: Literal["stepscope.macro"] = Field(description="what this document is")
    version: Literal[1]
    name: Label
    note: Annotated[str, StringConstraints(strict=True, max_length=2000)] = ""
    model: Annotated[str, StringConstraints(strict=True, max_length=60)] = Field(
        default="", description="what it was made for; it runs on no other one. Empty: on any"
    )
    steps: Annotated[list[Step], Field(max_length=STEPS_MAX)]

    @model_validator(mode="after")
    def _recordings_in_turn(self) -> MacroDocument:
        runs = False
        for number, step in enumerate(self.steps, 1):
            if isinstance(step, RecordStart | RecordStop):
                if runs == isinstance(step, RecordStart):
                    raise ValueError(f"step {number}: {'a recording runs already' if runs else 'no recording runs'}")
                runs = not runs
        return self

    @property
    def axes(self) -> list[int]:
        """Those that its steps move or wait for."""
        return sorted(
            {step.axis for step in self.steps if isinstance(step, MoveStep | RotateStep | StopStep | WaitPosition)}
        )


def _of(axis: int | None) -> str:
    return "" if axis is None else f" of axis {axis}"
