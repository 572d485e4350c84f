"""The shapes of the REST contract. Names are stable; the UI's TypeScript types are generated from them.

What all share, devices and registers are here; each other subject has a module `schemas_*` of its own.
Numbers are strict: `true` is no integer, NaN and infinity are no numbers, unknown keys are errors.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import ConfigDict, Field, StringConstraints

from ..conditions.judge import Kind
from ..deferred import DeferredModel
from ..form_hints import form, shown
from ..registers.names import AnyModelName, PmulName, SixPointName, SRampName

Int = Annotated[int, Field(strict=True)]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Flag = Annotated[bool, Field(strict=True)]
Name = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=60, strip_whitespace=True)]
AxisIndex = Annotated[int, Field(strict=True, ge=0, le=31)]
ChipName = PmulName
"""Chips of 32-bit datagrams, whose ramps come from pmul and pdiv."""
Chip40Name = SRampName
"""Chips of 40-bit datagrams that have SPI alone and put ramps into a driver outside."""
Tmc5xxxName = SixPointName
"""Chips with a SixPoint ramp and the driver inside."""


class Body(DeferredModel):
    """What comes in: an unknown key is an error, not a silence."""

    model_config = ConfigDict(extra="forbid")


class Answer(DeferredModel):
    """What goes out; also made from the drivers' own records, whose fields bear the same names."""

    # Defaults are sent too: clients may rely on every field being there.
    model_config = ConfigDict(from_attributes=True, json_schema_serialization_defaults_required=True)


class Evidence(Answer):
    """What was seen: a register or a figure, its value, and when."""

    what: str
    value: str
    seen_s: float | None = Field(description="device time [s]; null where nobody knows")


class Remedy(Answer):
    """A call of this API that mends something, to be made as it stands."""

    label: str
    method: Literal["POST", "PUT", "PATCH"]
    path: str
    body: dict[str, object] | None
    moves: bool = Field(description="it may set the motor in motion")


class Condition(Answer):
    """What is so with an axis: one of eleven kinds, why, by which evidence, and what helps."""

    kind: Kind
    cause: str = Field(description="one plain sentence")
    evidence: list[Evidence]
    remedies: list[Remedy]
    remedy: Remedy | None = Field(description="the first of them")
    since_s: float | None = Field(description="device time since when it is of this kind [s]")


class GroundTruth(Answer):
    """Emulated axes alone: the emulator's ground truth, not what the driver reads."""

    summary: str
    lost_steps: float | None = Field(description="since power-on, whole electrical turns [microsteps]")
    shaft_position: float | None = Field(description="from where the shaft was at the beginning [microsteps]")
    blocked: bool | None
    speed_pps: float | None = Field(description="of the shaft [microsteps/s]")
    bridges: str = Field(description='"regulated", "open", "shorted", "voltage"; "" where there are none')


class Standing(Answer):
    """The condition of an axis with what belongs to it."""

    condition: Condition
    referenced: bool | None = Field(description="whether its position counts from a known place; null: not known")
    ground_truth: GroundTruth | None = Field(description="emulators alone")


class Problem(Answer):
    """An error, RFC 9457. `type` is stable and made for code, `detail` for people."""

    type: str = Field(description="stable identifier, e.g. /problems/out-of-range")
    title: str
    status: int
    detail: str
    instance: str | None = None
    way_out: str | None = Field(default=None, description="what to do about it")
    facts: dict[str, object] = Field(default_factory=dict, description="the numbers behind: minimum, maximum, known...")
    remedies: list[Remedy] = Field(default_factory=list, description="calls that put it right, the main one first")


class AxisProblem(Problem):
    """An error of an axis that could not be read or moved."""

    model_config = ConfigDict(json_schema_serialization_defaults_required=False)

    condition: Condition | None = Field(default=None, description="of the axis, where its link or state is the reason")


# --- health, ports ------------------------------------------------------------------------------


class Health(Answer):
    status: Literal["ok"] = "ok"
    version: str


class Port(Answer):
    kind: Literal["serial", "emulator"]
    name: str
    description: str
    model: str | None = None
    usb_vid: int | None = None
    usb_pid: int | None = None
    usb_serial: str | None = None
    in_use_by: list[str] = Field(default_factory=list, description="ids of the devices that are connected through it")


# --- devices ------------------------------------------------------------------------------------


Limit = Annotated[float, Field(gt=0, le=1e12, allow_inf_nan=False, strict=True)]
Threshold = Annotated[int, Field(ge=1, le=1 << 31, strict=True)]
Counted = Annotated[int, Field(ge=-(1 << 31), lt=1 << 31, strict=True)]


class AxisLimits(Body):
    """Soft limits of an axis: null is no limit. Whatever asks for more is refused before anything is sent."""

    model_config = ConfigDict(extra="forbid", from_attributes=True, json_schema_serialization_defaults_required=True)

    position_min: Counted | None = shown(
        None, "From", "of the chip's counter [microsteps]", unit="µsteps", empty="no limit"
    )
    position_max: Counted | None = shown(
        None, "To", "of the chip's counter [microsteps]", unit="µsteps", empty="no limit", at_least="position_min"
    )
    velocity_max_pps: Limit | None = shown(None, "Speed", "either way [microsteps/s]", unit="pps", empty="no limit")
    acceleration_max_pps2: Limit | None = shown(
        None,
        "Acceleration",
        "of every acceleration and deceleration that can be set [microsteps/s^2]",
        unit="pps²",
        empty="no limit",
    )
    current_max_a: Limit | None = shown(
        None,
        "Current",
        "of a coil, RMS, in motion or at rest [A]",
        unit="A rms",
        empty="no limit",
        where={"current_scale": ["sense_resistor", "full_scale"]},
    )
    sense_resistor_ohm: Annotated[float, Field(gt=0, le=1000, allow_inf_nan=False, strict=True)] | None = shown(
        None,
        "Sense resistor",
        "of a TMC5xxx: what makes amperes of its current scales [ohm]",
        unit="Ω",
        where={"current_scale": ["sense_resistor"]},
        needed_with="current_max_a",
    )
    current_full_scale_a: Annotated[float, Field(gt=0, le=1000, allow_inf_nan=False, strict=True)] | None = shown(
        None,
        "Full scale",
        "RMS at the greatest current scale [A]: needed with TMC428, TMC4361 and PD42-1241, else instead of "
        "the sense resistor",
        unit="A rms",
        where={"current_scale": ["full_scale"]},
        needed_with="current_max_a",
    )


class AxisConfig(Body):
    """The motor on an axis and what it moves."""

    name: Name = Field(default="axis", title="Name", json_schema_extra=form(proposed="axis"))
    full_steps_per_rev: Annotated[int, Field(strict=True, ge=1, le=100_000)] = shown(
        200, "Full steps per revolution", "of the motor: 200 where a full step is 1.8 deg", heading="Full steps/rev"
    )
    driver_microsteps: Annotated[int, Field(strict=True, ge=1, le=256)] = shown(
        16,
        "Driver microsteps per full step",
        "microsteps per full step of the step/direction driver (TMC4210); others know theirs",
        heading="Driver µsteps",
        where={"capabilities": ["step_dir"]},
    )
    gear_ratio: Annotated[float, Field(gt=0, le=1e6, allow_inf_nan=False, strict=True)] = shown(
        1.0, "Motor turns per turn of the load", "the gear between motor and load", heading="Gear : 1"
    )
    travel_mm_per_rev: Annotated[float, Field(gt=0, le=1e6, allow_inf_nan=False, strict=True)] | None = shown(
        None,
        "Travel per revolution",
        "travel of the load per turn of the load [mm]; null for a rotary axis",
        unit="mm",
        heading="Travel mm/rev",
        empty="rotary",
    )
    limits: AxisLimits = Field(
        default_factory=AxisLimits,
        title="Soft limits",
        description="the server refuses what is beyond, and stops an axis at its ends; what is left out is not limited",
    )
    lost_steps_microsteps: Threshold | None = shown(
        None,
        "Lost steps from",
        "deviation of the encoder that tells of lost steps at rest [microsteps]; null: two full steps",
        unit="µsteps",
        empty="two full steps",
        group="Encoder thresholds",
        where={"capabilities": ["encoder"]},
    )
    following_error_microsteps: Threshold | None = shown(
        None,
        "Following error from",
        "deviation that tells of a motion not followed [microsteps]; null: four full steps",
        unit="µsteps",
        empty="four full steps",
        group="Encoder thresholds",
        where={"capabilities": ["encoder"]},
    )


class AxisInfo(Standing):
    index: int
    name: str
    full_steps_per_rev: int
    driver_microsteps: int
    gear_ratio: float
    travel_mm_per_rev: float | None
    limits: AxisLimits
    lost_steps_microsteps: int | None
    following_error_microsteps: int | None
    limit_warnings: list[str] = Field(
        description="what the chip is set to beyond these limits, and what to write; motion is refused until then"
    )
    microsteps_per_full_step: int | None = Field(description="as the chip is set now; null while unknown")
    pulse_div: int | None
    ramp_div: int | None
    rates_known: bool = Field(
        description="false: velocities and accelerations are the device's own numbers, of no known unit"
    )


class ChannelInfo(Answer):
    name: str = Field(description="quantity.axis, e.g. position.0")
    quantity: str
    axis: int
    unit: str


DeviceState = Literal["connected", "connecting", "disconnected", "failed"]


class DriverBehind(Answer):
    """A driver whose link goes through a controller."""

    axis: int
    device: str
    name: str
    model: AnyModelName
    title: str
    state: DeviceState


class DeviceInfo(Answer):
    id: str
    name: str
    model: AnyModelName
    title: str
    link: dict[str, object] = Field(
        description="`kind` and its options: emulator, tcp, spidev; for chips of 40-bit datagrams also "
        "landungsbruecke, for those with a UART uart, for a PD42-1241 serial and can. As in DeviceCreate"
    )
    clock_hz: float
    state: DeviceState
    problem: Problem | None
    notes: list[str] = Field(
        description="what a user has to know now: motors that were found moving, a connection that is not on disk"
    )
    emulated: bool
    demo: bool = Field(description="made by --demo; not kept")
    start_up: bool = Field(description="an emulator that is set up whenever it is powered, so that it can move")
    axes: list[AxisInfo]
    drivers: list[DriverBehind] = Field(
        default_factory=list,
        description="devices with a link of kind cover through this one, by the axis that each drives",
    )
    channels: list[ChannelInfo]
    rate_max_hz: float
    chip_timed: bool = Field(description="samples bear the device's own time (emulators), else the server's")


class LinkTest(Answer):
    """What a trial of a link found, without keeping anything."""

    ok: bool
    detail: str
    round_trip_ms: float | None
    problem: Problem | None


# --- registers ----------------------------------------------------------------------------------


Space = Literal["register", "ap", "gp0", "gp2", "gp3", "in", "pullup", "ain", "out", "coord"]
"""Which set of numbers an address counts in: a module has several."""


class RegisterReading(Answer):
    name: str
    address: int
    space: Space = "register"
    axis: int | None
    raw: int
    value: int
    fields: dict[str, int]
    unit: str
    kept: bool = Field(default=False, description="it cannot be read: as last written, or as after the last reset")


class RegisterWrite(Body):
    """Either the whole value, or some fields (the others keep what the chip holds)."""

    value: Int | None = None
    fields: dict[str, Int | str] | None = Field(default=None, description="numbers, or names of enumerated values")


class RegisterWritten(RegisterReading):
    """The read-back. `verified` is null where the chip may change the register by itself."""

    written: int
    verified: bool | None
    note: str


class RegisterBatch(Body):
    """Several writes in order; the first that fails ends it and the answer says how far it came."""

    writes: Annotated[list[RegisterBatchItem], Field(min_length=1, max_length=256)]


class RegisterBatchItem(RegisterWrite):
    name: str = Field(description="register or field")
    axis: AxisIndex | None = None


class RegisterBatchResult(Answer):
    done: list[RegisterWritten]
    failed: Problem | None
    not_tried: int


class Exchange(Body):
    frame: Annotated[str, StringConstraints(strict=True, max_length=64, pattern=r"^ *([0-9A-Fa-f]{2} *)+$")] = Field(
        description="hex digits in pairs, spaces between them allowed; as long as the device's frames are"
    )


class ExchangeReply(Answer):
    reply: str
    decoded: dict[str, object]


RegisterBatch.model_rebuild()
