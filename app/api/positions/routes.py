"""Extended positions: an axis beyond its counter's range, and one that turns for ever."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated

from fastapi import Query

from ...devices.core.device import Device
from ...errors import SoftLimit, UnknownThing, UsageError, WrongState
from ..deps import CurrentAxis, CurrentBench, CurrentDevice
from ..http.problems import DEVICE_PROBLEMS, problems
from ..router import subject_router
from ..server_state import ServerState
from .schemas import ExtendedHistory, ExtendedPosition, ExtendedPositionChange, LatchedPosition
from .views import extended_out, history_out, latched_out

router = subject_router(prefix="/devices/{device}/axes/{axis}/extended-position", tags=["extended position"])


@router.get("", responses=problems(UnknownThing))
async def get_extended_position(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis) -> ExtendedPosition:
    """Where the axis is, looked at now; where that fails, as it was last seen, and why it is not trusted."""
    return extended_out(await bench.positions.state(device, axis.index), device.device_time_s())


@router.put("", responses=problems(*DEVICE_PROBLEMS, SoftLimit))
async def put_extended_position(
    bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis, body: ExtendedPositionChange
) -> ExtendedPosition:
    """Set the position or the turn, or set off somewhere. Answers when it has started, not when it has arrived."""
    await _change(bench, device, axis.index, body)
    return extended_out(await bench.positions.state(device, axis.index), device.device_time_s())


@router.delete("", responses=problems(*DEVICE_PROBLEMS))
async def delete_extended_position(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis) -> ExtendedPosition:
    """Watch the axis no more, and forget where it is; a move under way is stopped by its ramp."""
    await bench.positions.unwatch(device, axis.index)
    return extended_out(await bench.positions.state(device, axis.index), device.device_time_s())


@router.get("/history", responses=problems(UnknownThing, WrongState))
async def get_extended_history(
    bench: CurrentBench,
    device: CurrentDevice,
    axis: CurrentAxis,
    seconds: Annotated[float, Query(description="how far back [s]", gt=0, le=1e9)] = 600.0,
) -> ExtendedHistory:
    """Where the axis was, as far as it was looked at."""
    return history_out(bench.positions.history(device, axis.index, seconds))


@router.get("/latched", responses=problems(*DEVICE_PROBLEMS))
async def get_latched_position(bench: CurrentBench, device: CurrentDevice, axis: CurrentAxis) -> LatchedPosition:
    """What the chip's snapshot register holds, extended: right as long as the axis is not half a range away from it."""
    return latched_out(await bench.positions.latched(device, axis.index))


async def _change(bench: ServerState, device: Device, axis: int, body: ExtendedPositionChange) -> None:
    service = bench.positions
    thing = next(iter(body.model_fields_set - {"way"}))
    match thing:
        case "watch":
            await service.watch(device, axis)
        case "target" if body.target is not None:
            await service.go_to(device, axis, int(body.target))
        case "actual" if body.actual is not None:
            await service.set_actual(device, axis, int(body.actual))
        case "confirm":
            await service.confirm(device, axis)
        case "microsteps_per_turn":
            turn = body.microsteps_per_turn
            await service.set_turn(device, axis, None if turn is None else _fraction(turn))
        case "gear" if body.gear is not None:
            gear = body.gear
            await service.set_gear(device, axis, (gear.microsteps_per_motor_turn, gear.motor_teeth, gear.driven_teeth))
        case "zero" if body.zero is not None:
            await service.set_zero(device, axis, int(body.zero))
        case "angle_deg" if body.angle_deg is not None:
            await service.go_to_angle(device, axis, body.angle_deg, body.way)
        case "place" if body.place is not None:
            await service.go_to_place(device, axis, _fraction(body.place), body.way)
        case "turns" if body.turns is not None:
            await service.go_turns(device, axis, body.turns)
        case "compare":
            await service.set_compare(device, axis, None if body.compare is None else int(body.compare))
        case _:
            raise UsageError(f"{thing} cannot be changed")


def _fraction(text: int | str) -> Fraction:
    """Raises UsageError for a division by zero."""
    try:
        return Fraction(text)
    except ZeroDivisionError as error:
        raise UsageError(f"{text} is no number") from error
