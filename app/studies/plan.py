"""What a study will do to the machine, told before it does."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from pydantic import Field

from ..devices.core.axis_limits import AxisLimits
from ..devices.core.capabilities import EncoderSetting, PositionFromEncoder, PositionSetting
from ..devices.core.device import Device
from ..devices.core.results import AxisState
from ..errors import BenchError, WrongState
from ..profiles.capture import CapturedConfiguration
from .document import Twin
from .driver_faults import faults_told
from .families import ramp_of
from .parts import Part
from .ramp_settings import RampSpace, held_of
from .until_switch import Side

Ground = TypeVar("Ground")


class StudyPlan(Part):
    """What will happen. Nothing begins while something is `missing`."""

    title: str
    missing: list[str] = Field(description="what is missing, each with its cure; empty: it can begin")
    warnings: list[str] = Field(default_factory=list)
    steps: list[str] = Field(default_factory=list, description="what it does, in order, for people")
    position_from: int | None = Field(default=None, description="it stays between these [microsteps]")
    position_to: int | None = None
    velocity_max_pps: float | None = None
    acceleration_max_pps2: float | None = None
    moves_max: int = 0
    way_fullsteps: float = Field(default=0.0, description="at most, of the motor [full steps]")
    time_s: float = Field(default=0.0, description="about, at most [s]")
    registers: list[str] = Field(default_factory=list, description="those that it sets, and sets back")
    unwatched: list[str] = Field(default_factory=list, description="what nothing of it would notice")
    goes_on: bool = Field(
        default=False, description="cut off, it keeps what is whole and goes on with the rest; else it begins anew"
    )
    no_twin: str = Field(
        default="",
        description="why nothing of it is tried on an emulated twin first, and what helps; empty: it is, or not to be",
    )


@dataclass(slots=True)
class Looked(Generic[Ground]):
    """What a study finds before it moves anything: its ground to stand on, and what is missing.

    ground : None where something is missing without which nothing else can be told
    """

    ground: Ground | None = None
    missing: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def required(self) -> Ground:
        """The ground. Raises WrongState where anything is missing."""
        if self.missing or self.ground is None:
            raise WrongState("; ".join(self.missing) or "nothing to look at", "see what the plan says is missing")
        return self.ground


@dataclass(frozen=True, slots=True)
class AxisNow:
    """An axis as every study finds it. held : what the device is set to; full_step, turn : [microsteps]."""

    space: RampSpace
    held: CapturedConfiguration
    state: AxisState
    full_step: int
    turn: int


async def axis_now(device: Device, axis: int, missing: list[str]) -> AxisNow | None:
    """The axis before a study; what keeps any study from it is added to `missing`. Nothing moves.

    None where that is all that can be told. Raises BenchError where the device does not answer.
    """
    device.session.require_connected()
    try:
        held = await held_of(device)
        space = RampSpace(device, axis, ramp_of(device), held)
    except WrongState as error:
        missing.append(str(error))
        return None
    state = await device.monitor.axis_state(axis)
    microsteps = device.axis(axis).microsteps
    if microsteps is None:
        missing.append("how many microsteps a turn has is not known: start the axis up")
        return None
    if state.moving:
        missing.append("the axis moves: stop it first")
    missing += faults_told(device, axis, state)
    return AxisNow(space, held, state, *microsteps)


async def axis_that_sees_lost_steps(device: Device, axis: int, missing: list[str], why: str) -> AxisNow | None:
    """`axis_now` for a study that loses steps, and has to see it and mend it; `why` it needs an encoder for that.

    Nothing moves. Raises BenchError where the device does not answer.
    """
    try:
        device.need(EncoderSetting).require_encoder(axis)
        device.need(PositionFromEncoder)
    except WrongState as error:
        missing.append(str(error))
        return None
    found = await axis_now(device, axis, missing)
    if found is not None and found.state.encoder_position is None:
        missing.append(f"no encoder tells its position: {why}")
    return found


async def axis_seen_by(device: Device, axis: int, missing: list[str], switch: Side | None, why: str) -> AxisNow | None:
    """The same where a switch may see lost steps, and sets them right; None: the encoder does. Raises BenchError."""
    if switch is None:
        return await axis_that_sees_lost_steps(device, axis, missing, why)
    try:
        device.need(PositionSetting)
    except WrongState as error:
        missing.append(str(error))
        return None
    found = await axis_now(device, axis, missing)
    if found is None:
        return None
    pressed = found.state.switches.left if switch == "left" else found.state.switches.right
    if pressed is None:
        missing.append(f"the {switch} switch is not read as the axis is set: nothing else tells of lost steps")
    elif pressed:
        missing.append(pressed_told(switch))
    return found


def pressed_told(switch: Side) -> str:
    """What keeps a study from moves near a switch; one that was cut off in it and goes on leaves it first."""
    return f"the {switch} switch is pressed: begin a little beside it"


def room_told(limits: AxisLimits) -> list[str]:
    """What to mind where no soft limits of position are set."""
    if limits.ranged:
        return []
    return ["no soft limits of position are set: nothing keeps it from going further than it shall"]


def twin_told(twin: Twin, what: str) -> str:
    """The step in which `what` is tried on a twin, and where that twin's motor is from."""
    source = f" ({twin.source})" if twin.source else ""
    return f"{what} on an emulated twin{source}: the motor rests meanwhile"


async def planned(
    title: str, looking: Awaitable[Looked[Ground]], tell: Callable[[StudyPlan, Ground], None]
) -> StudyPlan:
    """What a study would do, as `tell` has it of the ground that it stands on. Nothing moves."""
    try:
        looked = await looking
    except BenchError as error:
        return StudyPlan(title=title, missing=[str(error)])
    plan = StudyPlan(title=title, missing=looked.missing, warnings=looked.warnings)
    if looked.ground is not None:
        tell(plan, looked.ground)
    return plan
