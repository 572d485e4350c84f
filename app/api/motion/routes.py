"""One axis: its state, and moving it."""

from __future__ import annotations

from typing import Annotated

from fastapi import Query

from ...devices.core.results import AxisMove
from ...errors import OutOfRange, SoftLimit, UnknownThing, WrongState
from ..abilities import CurrentEncoderPosition, CurrentEventLog, CurrentLatchedFlags
from ..audit import wording
from ..deps import CurrentAxis, CurrentBench, CurrentDevice
from ..devices.views import axis_out, prediction_out, stops_out
from ..http.problems import DEVICE_PROBLEMS, problems
from ..policy import policy
from ..router import subject_router
from ..schemas import AxisProblem
from .event_schemas import AxisEvents
from .schemas import AxisStateOut, KeepRotating, MotionEnd, Move, Moves, MoveStarted, Prediction, Rotate, Rotating

router = subject_router(prefix="/devices/{device}", tags=["axes"])


@router.get("/axes/{axis}", responses=problems(*DEVICE_PROBLEMS, shape=AxisProblem))
async def get_axis(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis) -> AxisStateOut:
    """Position, velocity, switches and flags, read now, and the condition that the axis is of by them."""
    return axis_out(device, *await bench.conditions.poll(device, axis.index))


@router.post("/axes/{axis}/move", responses=problems(*DEVICE_PROBLEMS, SoftLimit))
@policy(words=wording.move)
async def move_axis(device: CurrentDevice, axis: CurrentAxis, body: Move) -> MoveStarted:
    """Start a move to a position, or by a distance. Answers when it has started, not when it has arrived."""
    return MoveStarted.model_validate(await device.motion.move(axis.index, body.target, body.relative, body.unit))


@router.post("/axes/{axis}/position-from-encoder", responses=problems(*DEVICE_PROBLEMS, SoftLimit))
async def take_position_from_encoder(
    bench: CurrentBench, device: CurrentDevice, encoded: CurrentEncoderPosition, axis: CurrentAxis
) -> AxisStateOut:
    """Call the place where the motor stands what its encoder shows: the way out after lost steps. Nothing moves."""
    await encoded.position_from_encoder(axis.index)
    return axis_out(device, *await bench.conditions.poll(device, axis.index))


@router.post("/axes/{axis}/clear-flags", responses=problems(*DEVICE_PROBLEMS))
async def clear_flags(
    bench: CurrentBench, device: CurrentDevice, flagged: CurrentLatchedFlags, axis: CurrentAxis
) -> AxisStateOut:
    """Take notice of the flags that the device keeps, so that they tell of what comes next."""
    await flagged.clear_flags(axis.index)
    return axis_out(device, *await bench.conditions.poll(device, axis.index))


@router.post("/move", responses=problems(*DEVICE_PROBLEMS, SoftLimit))
@policy(words=wording.moves)
async def move_axes(device: CurrentDevice, body: Moves) -> list[MoveStarted]:
    """Start several axes together: everything is prepared first, then all targets go out in successive datagrams."""
    moves = [AxisMove(move.axis, move.target, move.relative, move.unit) for move in body.moves]
    return [MoveStarted.model_validate(started) for started in await device.motion.move_together(moves)]


@router.post("/axes/{axis}/rotate", responses=problems(*DEVICE_PROBLEMS, SoftLimit))
@policy(words=wording.rotate)
async def rotate_axis(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis, body: Rotate) -> Rotating:
    """Turn on and on at a velocity, until told otherwise; with `hold_s` only for as long as it is kept up."""
    if body.hold_s is None:
        return Rotating.model_validate(await device.motion.rotate(axis.index, body.velocity, body.unit))
    held = await bench.procedures.rotate_held(device, axis.index, body.velocity, body.unit, body.hold_s)
    return Rotating.model_validate(held)


@router.patch("/axes/{axis}/rotate", responses=problems(UnknownThing, WrongState, OutOfRange))
@policy(audit="silent")
async def keep_rotating(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis, body: KeepRotating) -> Rotating:
    """Keep a rotation with `hold_s` up. It never begins one: coming late, behind a stop, it moves nothing."""
    return Rotating.model_validate(bench.procedures.keep_rotating(device, axis.index, body.hold_s))


@router.get("/axes/{axis}/stops", responses=problems(UnknownThing))
async def list_stops(device: CurrentDevice, axis: CurrentAxis) -> list[MotionEnd]:
    """When, where and why this motor came to rest, the latest first, up to 200. Chips do not watch: always empty."""
    return stops_out(device.monitor.motion_ends(axis.index))


@router.get("/axes/{axis}/prediction", responses=problems(UnknownThing))
async def get_prediction(device: CurrentDevice, axis: CurrentAxis) -> Prediction | None:
    """The ramp expected for the present motion, on device time; null where there is none."""
    return prediction_out(device.motion.prediction(axis.index))


@router.get("/axes/{axis}/events", responses=problems(UnknownThing, WrongState))
async def list_events(
    device: CurrentEventLog,
    axis: CurrentAxis,
    after: Annotated[int, Query(description="the highest `seq` that is known already", ge=0)] = 0,
    limit: Annotated[int, Query(description="how many at the most", ge=1, le=2000)] = 500,
) -> AxisEvents:
    """What the chip's event register has told since this device is connected, oldest first; reading loses nothing."""
    return AxisEvents.model_validate(device.events(axis.index, after, limit))
