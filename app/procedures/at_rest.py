"""Bringing motors to rest: when the server ends, and when the session that had the bench has vanished."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterable

from ..devices.core.device import Device
from ..devices.core.results import AxisState
from ..errors import BenchError
from ..settings import OnVanish
from .procedures import Procedures

OPEN_ENDED = ("VELOCITY_MODE", "HOLD_MODE")
"""Modes of a TMC428 and TMC4210, whose x_target is there in every mode and means nothing in these."""

Chosen = Callable[[int, AxisState], bool]
"""Of axes that move, by index and state: those to stop."""


async def stop_moving(device: Device, chosen: Chosen = lambda _, __: True) -> None:
    """Ramp down every axis of `device` that moves and is chosen. Raises BenchError: the first that went wrong."""
    moving = []
    for axis in device.axes:
        state = await device.monitor.axis_state(axis.index)
        if state.moving and chosen(axis.index, state):
            moving.append(axis.index)
    for outcome in await device.stop_axes(moving) if moving else ():
        if outcome.problem is not None:
            raise outcome.problem


async def anything_moves(devices: Iterable[Device], procedures: Procedures) -> bool:
    """Whether a motor that this server has moved moves, or is about to; True also where a device does not say."""

    async def moves(device: Device) -> bool:
        if procedures.running(device):
            return True
        try:
            return any(
                [
                    (await device.monitor.axis_state(axis.index)).moving
                    for axis in device.axes
                    if device.session.motion_commands[axis.index]
                ]
            )
        except BenchError:
            return True

    return any(await asyncio.gather(*(moves(device) for device in devices if device.state != "disconnected")))


def has_an_end(state: AxisState) -> bool:
    """Whether a motion comes to rest by itself: at its target."""
    return state.target_position is not None and state.mode not in OPEN_ENDED


async def after_vanishing(
    how: OnVanish, devices: Iterable[Device], procedures: Procedures
) -> list[tuple[Device, BenchError]]:
    """What happens to the motors that this server has moved; returns the devices that could not be told.

    "stop": procedures end, and what moves is ramped down. "hold": procedures end, and so does what would go on for
    ever; a move to a target runs to its end. "nothing": all go on.
    """
    if how == "nothing":
        return []

    async def tell(device: Device) -> tuple[Device, BenchError] | None:
        await procedures.cancel(device, why="the session that had the bench has vanished")
        moved = [axis.index for axis in device.axes if device.session.motion_commands[axis.index]]

        def chosen(axis: int, state: AxisState) -> bool:
            return axis in moved and (how == "stop" or not has_an_end(state))

        try:
            if moved:
                await stop_moving(device, chosen)
        except BenchError as error:
            return device, error
        return None

    there = [device for device in devices if device.state != "disconnected"]
    return [missed for missed in await asyncio.gather(*(tell(device) for device in there)) if missed is not None]
