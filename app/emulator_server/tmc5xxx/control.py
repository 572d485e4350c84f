"""The control port of chips on an emulated UART: as that of a line of modules, with a chip at each node."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from fastapi import APIRouter, Depends, FastAPI, Path, Request

from ...emulators.line.server import LineServer
from ...emulators.tmc5xxx import EmulatedTmc5xxx, Tmc5xxxPatch, Tmc5xxxState
from ..line_control import REFUSED, Several, control_app


class ControlledChips(Several[EmulatedTmc5xxx]):
    """A line that another thread serves, and the chips on it."""

    kind = "chip"


router = APIRouter(tags=["emulator"])


async def _controlled(request: Request) -> ControlledChips:
    controlled = request.app.state.controlled
    assert isinstance(controlled, ControlledChips)
    return controlled


CurrentChips = Annotated[ControlledChips, Depends(_controlled)]
Node = Annotated[int, Path(description="the node that the chip was started with", ge=0, le=254)]


# Plain functions, which run in a thread of their own: each waits until the line is between two datagrams.
@router.get("/emulator", responses=REFUSED)
def get_emulator(far: CurrentChips) -> Tmc5xxxState:
    """The one chip on this line, its motors and its faults."""
    return far.call(far.module(None).state)


@router.patch("/emulator", responses=REFUSED)
def change_emulator(far: CurrentChips, body: Tmc5xxxPatch) -> Tmc5xxxState:
    """Cause faults, load the shaft, force switches; what is left out stays."""
    chip = far.module(None)
    return far.call(lambda: chip.patch(body))


@router.get("/emulator/{node}", responses=REFUSED)
def get_emulator_at(far: CurrentChips, node: Node) -> Tmc5xxxState:
    """One of several chips."""
    return far.call(far.module(node).state)


@router.patch("/emulator/{node}", responses=REFUSED)
def change_emulator_at(far: CurrentChips, node: Node, body: Tmc5xxxPatch) -> Tmc5xxxState:
    """The same for one of several chips."""
    chip = far.module(node)
    return far.call(lambda: chip.patch(body))


def make_chip_control_app(
    server: LineServer, chips: Mapping[int, EmulatedTmc5xxx], allowed_hosts: tuple[str, ...] = ()
) -> FastAPI:
    """The control port over a line of chips, with the guard and the problems of the dashboard's API."""
    return control_app(ControlledChips(server, chips), router, allowed_hosts)
