"""The shapes of the REST contract. Names are stable; the UI's TypeScript types are generated from them.

Numbers are strict: `true` is no integer, NaN and infinity are no numbers, unknown keys are errors.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

Int = Annotated[int, Field(strict=True)]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Flag = Annotated[bool, Field(strict=True)]
Name = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=60, strip_whitespace=True)]
AxisIndex = Annotated[int, Field(strict=True, ge=0, le=31)]
ModelName = Literal["tmc428", "tmc4210"]

PositionUnit = Literal["microsteps", "fullsteps", "rev", "deg", "rad", "mm"]
VelocityUnit = Literal["pps", "chip", "fullsteps_per_s", "rpm", "rad_per_s", "mm_per_s"]
AccelerationUnit = Literal["pps2", "chip", "fullsteps_per_s2", "rpm_per_s", "rad_per_s2", "mm_per_s2"]


class Body(BaseModel):
    """What comes in: an unknown key is an error, not a silence."""

    model_config = ConfigDict(extra="forbid")


class Answer(BaseModel):
    """What goes out; also made from the drivers' own records, whose fields bear the same names."""

    # Defaults are sent too: clients may rely on every field being there.
    model_config = ConfigDict(from_attributes=True, json_schema_serialization_defaults_required=True)


class Problem(Answer):
    """An error, RFC 9457. `type` is stable and made for code, `detail` for people."""

    type: str = Field(description="stable identifier, e.g. /problems/out-of-range")
    title: str
    status: int
    detail: str
    instance: str | None = None
    way_out: str | None = Field(default=None, description="what to do about it")
    facts: dict[str, object] = Field(default_factory=dict, description="the numbers behind: minimum, maximum, known...")


# --- health, catalog, ports ---------------------------------------------------------------------


class Health(Answer):
    status: Literal["ok"] = "ok"
    version: str


class FieldRow(Answer):
    name: str
    lsb: int
    width: int
    access: str
    signed: bool
    minimum: int
    maximum: int
    reset: int | None
    unit: str
    help: str
    values: dict[str, str] = Field(description="names of enumerated values, by value")


class RegisterRow(Answer):
    name: str
    address: int
    axis: int | None
    group: str
    access: str
    width: int
    signed: bool
    minimum: int
    maximum: int
    reset: int | None
    unit: str
    help: str
    write_note: str
    volatile: bool
    source: str
    values: dict[str, str]
    fields: list[FieldRow]


class CatalogEntry(Answer):
    name: str
    title: str
    summary: str
    axes: int
    registers: int
    clock_hz_default: float
    clock_hz_max: float


class CatalogModel(CatalogEntry):
    rows: list[RegisterRow]


class Port(Answer):
    kind: Literal["serial", "emulator"]
    name: str
    description: str
    model: str | None = None
    usb_vid: int | None = None
    usb_pid: int | None = None
    usb_serial: str | None = None


# --- devices ------------------------------------------------------------------------------------


class AxisConfig(Body):
    """The motor on an axis and what it moves."""

    name: Name = "axis"
    full_steps_per_rev: Annotated[int, Field(strict=True, ge=1, le=100_000)] = 200
    driver_microsteps: Annotated[int, Field(strict=True, ge=1, le=256)] = Field(
        default=16, description="microsteps per full step of the step/direction driver (TMC4210); TMC428 has usrs"
    )
    gear_ratio: Annotated[float, Field(gt=0, le=1e6, allow_inf_nan=False, strict=True)] = Field(
        default=1.0, description="motor turns per turn of the load"
    )
    travel_mm_per_rev: Annotated[float, Field(gt=0, le=1e6, allow_inf_nan=False, strict=True)] | None = Field(
        default=None, description="travel of the load per turn of the load [mm]; null for a rotary axis"
    )


class AxisInfo(Answer):
    index: int
    name: str
    full_steps_per_rev: int
    driver_microsteps: int
    gear_ratio: float
    travel_mm_per_rev: float | None
    microsteps_per_full_step: int | None = Field(description="as the chip is set now; null while unknown")
    pulse_div: int | None
    ramp_div: int | None


class ChannelInfo(Answer):
    name: str = Field(description="quantity.axis, e.g. position.0")
    quantity: str
    axis: int
    unit: str


DeviceState = Literal["connected", "connecting", "disconnected", "failed"]


class DeviceInfo(Answer):
    id: str
    name: str
    model: ModelName
    title: str
    link: dict[str, object]
    clock_hz: float
    state: DeviceState
    problem: Problem | None
    emulated: bool
    demo: bool = Field(description="made by --demo; not kept")
    axes: list[AxisInfo]
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


class RegisterReading(Answer):
    name: str
    address: int
    axis: int | None
    raw: int
    value: int
    fields: dict[str, int]
    unit: str


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


# --- axes ---------------------------------------------------------------------------------------


class Switches(Answer):
    left: bool | None
    right: bool | None
    home: bool | None


class AxisStateOut(Answer):
    position: int
    target_position: int | None
    velocity_pps: float
    target_velocity_pps: float | None
    acceleration_pps2: float | None
    encoder_position: int | None
    deviation: int | None
    position_reached: bool
    moving: bool
    mode: str
    switches: Switches
    flags: dict[str, bool]
    time_s: float = Field(description="when it was read: the device's own time for emulators, else the server's [s]")


class Move(Body):
    target: Number
    relative: Flag = False
    unit: PositionUnit = "microsteps"


class AxisMove(Move):
    axis: AxisIndex


class Moves(Body):
    """Moves of several axes that start together (001, 9.10): all targets in successive datagrams."""

    moves: Annotated[list[AxisMove], Field(min_length=1, max_length=8)]


class MoveStarted(Answer):
    axis: int
    from_position: int
    target_position: int
    started_at_s: float
    predicted_duration_s: float | None
    warnings: list[str]


HoldSeconds = Annotated[float, Field(strict=True, ge=0.1, le=10, allow_inf_nan=False)]


class Rotate(Body):
    velocity: Number
    unit: VelocityUnit = "pps"
    hold_s: HoldSeconds | None = Field(
        default=None,
        description="stop by itself after so long unless kept up (PATCH), as a jog button needs; null: on and on",
    )


class KeepRotating(Body):
    hold_s: HoldSeconds = 1.0


class Rotating(Answer):
    axis: int
    velocity_chip: int
    velocity_pps: float
    warnings: list[str]


class Stop(Body):
    mode: Literal["ramp", "immediate"] = Field(
        default="ramp", description="ramp: slow down with a_max, position kept; immediate: stop dead, steps may be lost"
    )


class StopResult(Answer):
    device: str
    axis: int
    ok: bool
    took_ms: float
    problem: Problem | None


class StopReport(Answer):
    results: list[StopResult]


class Prediction(Answer):
    """The ramp that the calculators expect for the last move, on the device's time."""

    started_at_s: float
    duration_s: float
    time_s: list[float]
    position: list[float]
    velocity_pps: list[float]
    phases: list[Phase]


class ReferenceSearchStart(Body):
    switch: Literal["left", "right", "reference"] = "reference"
    velocity: Annotated[float, Field(strict=True, gt=0, allow_inf_nan=False)] | None = Field(
        default=None, description="search speed [pps]; default a quarter of v_max"
    )
    max_travel: Annotated[int, Field(strict=True, ge=1, lt=1 << 23)] | None = Field(
        default=None, description="give up a part of the search after that many microsteps"
    )


class ReferenceSearchState(Answer):
    state: Literal["idle", "running", "done", "failed", "aborted"]
    phase: str
    progress: float
    edges: list[int] = Field(description="switch edges found so far [microsteps]")
    centre: int | None
    offset: int | None = Field(description="what was subtracted from the position at the end [microsteps]")
    message: str


class ShuttleStart(Body):
    """Move back and forth between two positions until stopped."""

    first: Int
    second: Int
    dwell_s: Annotated[float, Field(strict=True, ge=0, le=60, allow_inf_nan=False)] = 0.3


class ShuttleState(Answer):
    running: bool
    first: int | None
    second: int | None
    dwell_s: float | None
    cycles: int
    message: str


# --- tables of the chip -------------------------------------------------------------------------

TableValue = Annotated[int, Field(strict=True, ge=0, le=63)]


class MicrostepTable(Body):
    values: Annotated[list[TableValue], Field(min_length=64, max_length=64)]


class DriverSpecIn(Body):
    driver: Annotated[str, StringConstraints(max_length=40)]
    fast_decay: Flag = False
    signals: list[str | Int] | None = Field(default=None, description="for driver 'custom': signal names or codes")
    bit_names: list[str] | None = None


class DriverChain(Body):
    drivers: Annotated[list[str | DriverSpecIn], Field(min_length=1, max_length=3)]


class ChainBit(Answer):
    position: int
    motor: int
    signal: str
    code: int
    next_motor: bool
    ram_address: int
    ram_data: int
    bit_name: str


class ChainTable(Answer):
    """A driver chain configuration, readable."""

    bits: list[ChainBit]
    ram_words: list[int] = Field(description="64 cells of 6 bits")
    lsmd: int
    length_bits: int | None = Field(description="null where the datagram never ends")
    findings: list[str]


class ChainDesign(ChainTable):
    datagrams: list[str] = Field(description="hex, to the chip")
    spi_clock_hz: float
    datagram_hz: float
    continuous_update_hz: float | None
    full_step_hz_max: float


class Profile(Answer):
    """A device's whole configuration as a document."""

    format: Literal["stepscope-profile"] = "stepscope-profile"
    version: Literal[1] = 1
    name: str
    model: str
    clock_hz: float
    axes: list[AxisConfig]
    registers: list[ProfileRegister]
    microstep_table: list[int] | None
    driver_chain: list[int] | None


class ProfileRegister(Answer):
    name: str
    axis: int | None
    raw: int
    value: int
    fields: dict[str, int]


# --- calculators --------------------------------------------------------------------------------

Divider = Annotated[int, Field(strict=True, ge=0, le=13)]
ChipValue = Annotated[int, Field(strict=True, ge=0, le=2047)]
ClockHz = Annotated[float, Field(strict=True, ge=1, le=32e6, allow_inf_nan=False)]


class PmulPdiv(Body):
    chip: ModelName = "tmc428"
    a_max: ChipValue
    ramp_div: Divider
    pulse_div: Divider
    reduction: Annotated[float, Field(strict=True, ge=0, lt=1, allow_inf_nan=False)] | None = Field(
        default=None, description="by how much p is made smaller; null: the data sheet's 0.05 (TMC428), 0.01 (TMC4210)"
    )
    v_max: ChipValue = 2047
    v_min: ChipValue = 1
    clock_hz: ClockHz = 16e6


class PmulPdivCandidate(Answer):
    pmul: int
    p_mul: int
    pdiv: int
    p: float
    quality: float
    overshoot_steps: int | None = Field(description="farthest beyond the target, in the exact ramp [microsteps]")
    settling_s: float | None = Field(
        description="from the first arrival at the target to rest [s]; null where it oscillates without end"
    )
    move_s: float | None = Field(default=None, description="the whole reference move [s], to compare pairs by")


class PmulPdivResult(Answer):
    p_ideal: float
    p_reduced: float
    pmul: int | None = Field(description="counted 0..127 as in the TMC428 data sheet")
    p_mul: int | None = Field(description="counted 128..255 as in the TMC4210 data sheet")
    pdiv: int | None
    p: float | None
    quality: float | None
    candidates: list[PmulPdivCandidate]
    a_max_lower_limit: int
    a_max_upper_limit: int
    warnings: list[str]


class Mechanics(Body):
    model_config = ConfigDict(extra="forbid", from_attributes=True)

    full_steps_per_rev: Annotated[int, Field(strict=True, ge=1, le=100_000)] = 200
    microsteps_per_full_step: Annotated[int, Field(strict=True, ge=1, le=1024)] = 64
    gear_ratio: Annotated[float, Field(strict=True, gt=0, le=1e6, allow_inf_nan=False)] = 1.0
    travel_mm_per_rev: Annotated[float, Field(strict=True, gt=0, le=1e6, allow_inf_nan=False)] | None = None


class Quantity(Body):
    """A number with its unit, as it comes from a person."""

    value: Number
    unit: str


class RampInverse(Body):
    """From wanted speed and acceleration to register values."""

    model: ModelName = "tmc428"
    velocity: Quantity
    acceleration: Quantity
    mechanics: Mechanics = Mechanics()
    clock_hz: ClockHz = 16e6
    reduction: Annotated[float, Field(strict=True, ge=0, lt=1, allow_inf_nan=False)] | None = None


class RampInverseResult(Answer):
    pulse_div: int
    ramp_div: int
    v_max: int
    a_max: int
    usrs: int | None
    pmul: int | None
    p_mul: int | None
    pdiv: int | None
    achieved_velocity_pps: float
    achieved_acceleration_pps2: float
    velocity_error: float = Field(description="achieved / wanted - 1")
    acceleration_error: float = Field(description="achieved / wanted - 1")
    mechanics: Mechanics = Field(description="as given, with the microsteps of usrs")
    warnings: list[str]


class Units(Body):
    """Chip units and physical units of one axis, either way: give what you know."""

    model: ModelName = "tmc428"
    pulse_div: Divider
    ramp_div: Divider
    clock_hz: ClockHz = 16e6
    mechanics: Mechanics = Mechanics()
    velocity: Quantity | None = Field(
        default=None, description="unit: chip, pps, fullsteps_per_s, rpm, rad_per_s, mm_per_s"
    )
    acceleration: Quantity | None = Field(
        default=None, description="unit: chip, pps2, fullsteps_per_s2, rpm_per_s, rad_per_s2, mm_per_s2"
    )
    position: Quantity | None = Field(default=None, description="unit: microsteps, fullsteps, rev, deg, rad, mm")


class UnitsResult(Answer):
    """Every unit of each quantity that was given; mm only where the axis knows it."""

    velocity: dict[str, float | None] | None
    acceleration: dict[str, float | None] | None
    position: dict[str, float | None] | None
    acceleration_steps: float | None = Field(description="microsteps from rest to that velocity at that acceleration")
    acceleration_time_s: float | None


class Ramp(Body):
    """`parameters` bear the chip's register names; for "trapezoid" vmax, amax, dmax in pps and pps^2.

    `ramp_mode` "velocity" turns at `v_target`, "hold" at `v_actual`; without them at v_max, the way of `distance`.
    """

    model: Literal["tmc428", "tmc4210", "trapezoid"]
    parameters: dict[str, Number | str]
    distance: Number
    samples: Annotated[int, Field(strict=True, ge=2, le=100_000)] = 500


class Phase(Answer):
    name: str
    start_s: float
    end_s: float


class RampResult(Answer):
    duration_s: float
    phases: list[Phase]
    time_s: list[float]
    position: list[float]
    velocity_pps: list[float]
    acceleration_pps2: list[float]
    overshoot_steps: int
    warnings: list[str]


class MicrostepDesign(Body):
    chip: Literal["tmc428"] = "tmc428"
    sigma: Annotated[float, Field(strict=True, ge=-1, le=1, allow_inf_nan=False)] = 0.0
    offset: Annotated[float, Field(strict=True, ge=0, le=63, allow_inf_nan=False)] = 0.0
    amplitude: Annotated[float, Field(strict=True, ge=0, le=63, allow_inf_nan=False)] | None = None
    full_scale: Flag = Field(default=False, description="stretch a box (sigma > 0) until it reaches the amplitude")
    method: Literal["half_rounded_64", "63", "offset"] = Field(
        default="half_rounded_64", description="the three formulas of chapter 12 of the TMC428 data sheet, in its order"
    )
    values: Annotated[list[TableValue], Field(min_length=64, max_length=64)] | None = Field(
        default=None, description="a table drawn by hand: only its datagrams and metrics are wanted"
    )
    usrs: Annotated[int, Field(strict=True, ge=0, le=6)] = 6


class MicrostepMetrics(Answer):
    vector_length_mean: float
    vector_length_ripple: float | None = Field(description="(max - min) / mean; null for a table without current")
    angle_error_deg: list[float | None] = Field(
        description="electrical, at each microstep of the full period; null where there is no current and so no angle"
    )
    angle_error_max_deg: float | None
    angle_error_rms_deg: float | None
    harmonics: list[float] = Field(description="amplitude of harmonic 1, 2, ... relative to the first; empty without")
    thd: float | None
    worst_step: int | None
    worst_step_ratio: float | None = Field(description="longest angle step over the ideal one")
    smallest_step_ratio: float | None


class SequencerRow(Answer):
    index: int
    current_a: int
    current_b: int
    ph_a: int
    ph_b: int
    fd_a: int
    fd_b: int


class MicrostepResult(Answer):
    values: list[int]
    datagrams: list[str]
    metrics: MicrostepMetrics
    sequence: list[SequencerRow] = Field(description="the full period as the chip steps through it at usrs")
    warnings: list[str]


class ChainRequest(DriverChain):
    clock_hz: ClockHz = 16e6
    clk2_div: Annotated[int, Field(strict=True, ge=0, le=255)] = 7
    ramp_divs: Annotated[list[Divider], Field(min_length=3, max_length=3)] | None = None


RegisterBatch.model_rebuild()
Profile.model_rebuild()
Prediction.model_rebuild()
