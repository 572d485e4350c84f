"""Shapes of several devices as one machine: wires between emulators, and starts together."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ...procedures.start_together import AXES_MAX
from ...procedures.straight_line import POINTS_MAX
from ..motion.schemas import Move
from ..schemas import Answer, AxisIndex, Body, Flag, Int

DeviceIds = Annotated[list[Annotated[str, Field(min_length=1, max_length=200)]], Field(min_length=2, max_length=24)]


class NetPin(Answer):
    """A pin on a net."""

    device: str = Field(validation_alias="key", description="id of the device")
    pin: str = Field(
        description="START; STEP1 to STEP3: step and direction of an axis; DIAG of a driver; STOPL, STOPR, REF1 to "
        "REF3: inputs for stop switches"
    )
    role: Literal["level", "output", "input", "signal", "sense"] = Field(
        description="level: either way, as the chip is set; output and input of steps; signal: a level that goes out, "
        "and sense: one that is taken"
    )


class WirablePin(NetPin):
    """A pin of an emulated device that can be wired to others."""

    nets: list[str] = Field(description="the nets it is on")


class PinOfDevice(Body):
    device: Annotated[str, Field(min_length=1, max_length=200)] = Field(description="id of the emulated device")
    pin: Annotated[str, Field(min_length=1, max_length=32)]


class NetPins(Body):
    """All pins of a net."""

    pins: Annotated[list[PinOfDevice], Field(min_length=2, max_length=64)]


class Net(Answer):
    """Pins of emulated devices that are wired together: those whose options (`wires`) name the same net."""

    net: str
    pins: list[NetPin]
    open: str | None = Field(description="why it connects nothing; null where it does")
    equal_clocks: bool = Field(
        description="an edge is seen at the very clock of the others; false: rounded to a clock of whoever sees it"
    )
    seen_within_s: float = Field(description="how far apart an edge is seen at the most [s]")


class TogetherMove(Move):
    device: Annotated[str, Field(min_length=1, max_length=200)] = Field(description="id of the device")
    axis: AxisIndex


class StartTogether(Body):
    """Moves of axes of any devices that start together."""

    moves: Annotated[list[TogetherMove], Field(min_length=1, max_length=AXES_MAX)]
    use_wires: Flag = Field(
        default=True, description="start chips whose START pins are wired by one edge; false: each by its command"
    )
    start_wires: Annotated[list[DeviceIds], Field(max_length=8)] = Field(
        default=[],
        description="devices on real links whose START pins are wired together; emulated ones tell of their wires",
    )


class AxisStart(Answer):
    """How one axis started."""

    device: str
    axis: int
    how: Literal["START wire", "command"]
    from_position: int
    target_position: int
    skew_s: float = Field(description="after the first one [s]")
    uncertainty_s: float = Field(description="how much more or less that may be [s]")
    predicted_duration_s: float | None
    warnings: list[str]


class StartedTogether(Answer):
    """How all of them started."""

    axes: list[AxisStart]
    spread_s: float = Field(description="between the first and the last start [s]")
    uncertainty_s: float = Field(description="how much more or less that may be [s]")


class LineAxis(Body):
    device: Annotated[str, Field(min_length=1, max_length=200)] = Field(description="id of the device")
    axis: AxisIndex


Positions = Annotated[list[Int], Field(min_length=1, max_length=AXES_MAX)]


class StraightLine(Body):
    """A straight line of several axes from where they stand, and on to further points; all arrive together at each."""

    axes: Annotated[list[LineAxis], Field(min_length=1, max_length=AXES_MAX)]
    points: Annotated[list[Positions], Field(min_length=1, max_length=POINTS_MAX)] = Field(
        description="of each point a position for each axis [microsteps]"
    )
    pace: Annotated[float, Field(strict=True, gt=0, le=1, allow_inf_nan=False)] = Field(
        default=1.0, description="share of the highest speed that all can go"
    )
    duration_s: Annotated[float, Field(strict=True, gt=0, le=3600, allow_inf_nan=False)] | None = Field(
        default=None, description="of each leg, where that is slower than the pace [s]"
    )


class LegAxis(Answer):
    """One axis on one leg, as its registers will have it."""

    device: str
    axis: int
    from_position: int
    to_position: int
    velocity_pps: float = Field(description="0 for an axis that stands [pps]")
    acceleration_pps2: float
    duration_s: float
    off_line: float = Field(description="how far it is from the line at the most [microsteps]")
    position: list[float] = Field(description="at the times of the leg [microsteps]")
    warnings: list[str] = Field(description="why it cannot keep to the line any better, where that is far off")


class Leg(Answer):
    """From one point to the next."""

    duration_s: float
    arrival_spread_s: float = Field(description="between the first and the last arrival [s]")
    time_s: list[float]
    axes: list[LegAxis]


class LinePlan(Answer):
    """What the planners expect of a line."""

    legs: list[Leg]
    duration_s: float


class Arrival(Answer):
    device: str
    axis: int
    after_s: float = Field(description="when it was seen to be there, after the start of its leg [s]")
    uncertainty_s: float = Field(description="how much sooner it may have been there [s]")


class LineState(Answer):
    """How a line goes, or went; starts and arrivals are those of the latest leg."""

    state: Literal["idle", "running", "done", "failed", "aborted"]
    leg: int = Field(description="the one under way, from 0")
    legs: int
    started: StartedTogether | None
    arrivals: list[Arrival]
    message: str
    off_line: float | None = Field(
        description="how far one of them was seen off the line at the most, on any leg [microsteps]; null: nothing seen"
    )
    off_line_uncertainty: float | None = Field(description="how much more or less that may be [microsteps]")


class AxisPath(Answer):
    """Where one axis was seen on a leg."""

    device: str
    axis: int
    time_s: list[float] = Field(description="after the first start of that leg, of each sample [s]")
    position: list[int | None] = Field(description="[microsteps]; null where a reading was lost")
    off_line: float | None = Field(
        description="how far it was from the line at the most, by the way that the axis of the longest way had gone "
        "[microsteps]; null where nothing was seen"
    )
    uncertainty: float | None = Field(
        description="how much more or less that may be, by when the samples were taken and what lies between them "
        "[microsteps]"
    )


class LegPath(Answer):
    axes: list[AxisPath]


class LinePath(Answer):
    """Where the axes were seen, on each leg that has begun, and how that was planned."""

    plan: LinePlan | None = Field(description="null before the first line")
    legs: list[LegPath]


class Wiring(Answer):
    """All nets by name, and all pins that can be wired by device."""

    nets: list[Net]
    pins: list[WirablePin]
