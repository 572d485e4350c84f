"""Shapes of one axis: its state, moving and stopping it, and the procedures that do so by themselves."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ...devices.core.results import StopReason
from ..calc.schemas import Phase
from ..schemas import Answer, AxisIndex, Body, Flag, Int, Number, Problem, Standing

PositionUnit = Literal["microsteps", "fullsteps", "rev", "deg", "rad", "mm"]
VelocityUnit = Literal["pps", "chip", "fullsteps_per_s", "rps", "rpm", "rad_per_s", "mm_per_s"]


class Switches(Answer):
    left: bool | None
    right: bool | None
    home: bool | None


class AxisStateOut(Standing):
    position: int
    target_position: int | None
    velocity_pps: float
    target_velocity_pps: float | None
    acceleration_pps2: float | None
    encoder_position: int | None
    deviation: float | None = Field(description="encoder minus position, both of one moment [microsteps]")
    external_encoder_position: int | None = None
    external_deviation: float | None = None
    encoder_velocity_pps: float | None = Field(default=None, description="TMC4361: filtered, V_ENC_MEAN")
    load_angle_deg: float | None = Field(
        default=None, description="TMC4361: how far the field leads the rotor, electrical; null without an encoder"
    )
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
    """Moves of several axes that start together (DS-TMC428 9.10): all targets in successive datagrams."""

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


SearchSpeed = Annotated[float, Field(strict=True, gt=0, le=8e6, allow_inf_nan=False)]
SearchMode = Literal[1, 2, 3, 4, 5, 6, 7, 8, 65, 66, 67, 68, 133, 134, 135, 136]
"""AP 193 of a PD42-1241: 1..8, +64 mirrors 1..4, +128 inverts the home switch of 5..8."""


class StallSearchStart(Body):
    """Search the end of the stage without a switch: by the stall that the driver measures (StallGuard)."""

    side: Literal["left", "right"] = Field(description="left is where positions get less")
    velocity: Annotated[float, Field(strict=True, gt=0, le=8e6, allow_inf_nan=False)] | None = Field(
        default=None, description="search speed [pps]; null: a turn a second, or the axis's limit if that is less"
    )
    threshold: Annotated[int, Field(strict=True, ge=-64, le=63)] | None = Field(
        default=None, description="StallGuard threshold, the higher the less sensitive; null: one is found"
    )
    current_percent: Annotated[float, Field(strict=True, gt=0, le=100, allow_inf_nan=False)] | None = Field(
        default=None, description="run current meanwhile, of the driver's full scale [%]; null: as it is set"
    )
    back_off: Annotated[int, Field(strict=True, ge=1, lt=1 << 23)] | None = Field(
        default=None, description="way between two hits [microsteps]; null: what it takes to get up to speed"
    )
    hits: Annotated[int, Field(strict=True, ge=1, le=10)] = Field(
        default=3, description="how often it runs against the end; the places of the hits are `edges`"
    )


class ReferenceSearchStart(Body):
    """Chips search `switch` at `velocity`. A PD42-1241 searches by itself, in one of its modes and at two speeds.
    Devices with StallGuard also search by `stall`."""

    switch: Literal["left", "right", "reference", "home"] = Field(
        default="reference", description='"home" is what a TMC4361 calls it (HOME_REF)'
    )
    velocity: Annotated[float, Field(strict=True, gt=0, allow_inf_nan=False)] | None = Field(
        default=None, description="search speed [pps]; default a quarter of v_max"
    )
    max_travel: Annotated[int, Field(strict=True, ge=1, lt=1 << 31)] | None = Field(
        default=None, description="give up a part of the search after that many microsteps; chips: below 2^23"
    )
    mode: SearchMode | None = Field(
        default=None, description="PD42-1241: 1..8, +64 for 1..4 mirrored, +128 for 5..8 with the home switch inverted"
    )
    search_speed_pps: SearchSpeed | None = Field(default=None, description="PD42-1241: AP 194; null: as it is set")
    switch_speed_pps: SearchSpeed | None = Field(default=None, description="PD42-1241: AP 195; null: as it is set")
    stall: StallSearchStart | None = Field(
        default=None,
        description="search the end of the stage by stall; StealthChop is off meanwhile. Of the others only max_travel "
        "goes with it",
    )


class ReferenceSearchState(Answer):
    state: Literal["idle", "running", "done", "failed", "aborted"]
    phase: str
    progress: float
    edges: list[int] = Field(description="switch edges, or hits of the end, found so far [microsteps]")
    centre: int | None
    offset: int | None = Field(description="what was subtracted from the position at the end [microsteps]")
    message: str
    mode: int | None = Field(default=None, description="PD42-1241: the mode it searches in")
    distance: int | None = Field(default=None, description="PD42-1241: AP 196, between the end switches [microsteps]")
    last_position: int | None = Field(
        default=None, description="where the zero point lay in the old counting [microsteps]; PD42-1241: AP 197"
    )
    stall: bool = Field(default=False, description="by stall: `edges` are the hits of the end, in the old counting")


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


class VelocityProfileBody(Body):
    """A velocity over time: knots between which it is linear, or with `rate_hz` null the very points to send."""

    time_s: Annotated[
        list[Annotated[float, Field(strict=True, ge=0, le=600, allow_inf_nan=False)]],
        Field(min_length=2, max_length=100_000),
    ] = Field(description="rising from 0 [s]")
    velocity_pps: Annotated[
        list[Annotated[float, Field(strict=True, ge=-1e8, le=1e8, allow_inf_nan=False)]],
        Field(min_length=2, max_length=100_000),
    ] = Field(description="one for each time; 0 at the first and the last [pps]")
    rate_hz: Annotated[float, Field(strict=True, ge=1, le=2000, allow_inf_nan=False)] | None = Field(
        default=None, description="points to send a second, on straight lines between those given; null: those given"
    )


class VelocityProfileSummary(Answer):
    """What a velocity profile asks for."""

    points: int
    duration_s: float
    peak_pps: float = Field(description="as the chip rounds it [pps]")
    acceleration_pps2: float = Field(description="of the steepest part [pps^2]")
    lowest: int = Field(description="the lowest position on the way [microsteps]")
    highest: int = Field(description="[microsteps]")
    end: int = Field(description="where it ends if every point comes in time [microsteps]")
    step_pps: float = Field(description="the chip's step of velocity [pps]")


class VelocityProfileState(Answer):
    """How a velocity profile goes, or went; lateness is of the points sent so far."""

    state: Literal["idle", "running", "done", "failed", "aborted"]
    summary: VelocityProfileSummary | None
    sent: int
    skipped: int = Field(description="points left out because the next one was due already")
    late_median_ms: float | None
    late_p99_ms: float | None
    late_max_ms: float | None
    position: int | None = Field(description="where it ended [microsteps]")
    message: str


class VelocityProfileLateness(Answer):
    """How late each point was."""

    time_s: list[float] = Field(description="when each was due, from the start on [s]")
    late_ms: list[float | None] = Field(
        description="until the chip had answered it [ms]; null for one that was left out, or not sent yet"
    )


class MotionEnd(Answer):
    """When, where and why a motor came to rest."""

    axis: int
    time_s: float = Field(description="device time [s]")
    unix_s: float = Field(description="Unix time [s]")
    reason: StopReason
    position: int | None = Field(description="[microsteps]; null where it could not be read")
    detail: str
