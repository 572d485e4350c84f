"""The control port of TMCL modules on an emulated line."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, FastAPI, Path, Request

from ...emulators.tmcl.module import EmulatedModule
from ...emulators.tmcl.options import TmclPatch
from ...emulators.tmcl.state import TmclState
from ..line_control import REFUSED, Several, control_app


class Controlled(Several[EmulatedModule]):
    """A line of modules."""


router = APIRouter(tags=["emulator"])


async def _controlled(request: Request) -> Controlled:
    controlled = request.app.state.controlled
    assert isinstance(controlled, Controlled)
    return controlled


CurrentModules = Annotated[Controlled, Depends(_controlled)]
Address = Annotated[int, Path(description="the address that the module was started with", ge=1, le=255)]


# Plain functions, which run in a thread of their own: each waits until the line is between two frames.
@router.get("/emulator", responses=REFUSED)
def get_emulator(far: CurrentModules) -> TmclState:
    """The one module of this line, its motor and its faults."""
    return far.call(far.module(None).state)


@router.patch("/emulator", responses=REFUSED)
def change_emulator(far: CurrentModules, body: TmclPatch) -> TmclState:
    """Cause faults, load the shaft, force switches; what is left out stays."""
    module = far.module(None)
    return far.call(lambda: module.patch(body))


@router.get("/emulator/{address}", responses=REFUSED)
def get_emulator_at(far: CurrentModules, address: Address) -> TmclState:
    """One of several modules."""
    return far.call(far.module(address).state)


@router.patch("/emulator/{address}", responses=REFUSED)
def change_emulator_at(far: CurrentModules, address: Address, body: TmclPatch) -> TmclState:
    """The same for one of several modules."""
    module = far.module(address)
    return far.call(lambda: module.patch(body))


def make_control_app(controlled: Controlled, allowed_hosts: tuple[str, ...] = ()) -> FastAPI:
    """The control port over a line of modules, with the guard and the problems of the dashboard's API."""
    return control_app(controlled, router, allowed_hosts)
