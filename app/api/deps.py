"""What a route may ask for in its signature."""

from __future__ import annotations

from typing import Annotated, cast

from fastapi import Depends, Path, Query
from starlette.requests import HTTPConnection

from ..devices.core.device import Device
from ..devices.core.session import Axis
from .server_state import ServerState

# All of these are coroutines, although none waits: FastAPI would send plain functions to a thread.


async def _bench(connection: HTTPConnection) -> ServerState:
    return cast("ServerState", connection.app.state.bench)


CurrentBench = Annotated[ServerState, Depends(_bench)]
DeviceId = Annotated[str, Path(description="the device's id: a slug of its name", max_length=200)]


def device_of(connection: HTTPConnection, device: str) -> Device:
    """The device of that id, for the one route where a dependency would cost too much. Raises UnknownThing."""
    return cast("ServerState", connection.app.state.bench).manager.get(device)


async def _device(device: DeviceId, connection: HTTPConnection) -> Device:
    # Not by way of CurrentBench: each level of dependencies costs a quarter of what reading a register does.
    return device_of(connection, device)


CurrentDevice = Annotated[Device, Depends(_device)]
AxisNumber = Annotated[int, Path(description="the axis, from 0", ge=0, le=31)]


async def _axis(axis: AxisNumber, device: CurrentDevice) -> Axis:
    return device.axis(axis)


CurrentAxis = Annotated[Axis, Depends(_axis)]
AxisQuery = Annotated[
    int | None, Query(description="the axis, from 0; none for registers of the whole chip", ge=0, le=31)
]
RegisterName = Annotated[
    str, Path(description="register or field, as in the data sheet, without regard to case", max_length=60)
]
