"""The emulated chip or module behind a link: switches, faults, motor, time."""

from __future__ import annotations

from typing import Annotated, Protocol, cast

from fastapi import APIRouter, Depends
from pydantic import BaseModel, ValidationError

from app.api.deps import CurrentDevice
from app.api.problems import findings, problems
from app.emulators.options import EmulatorPatch
from app.emulators.pd42.options import Pd42Patch
from app.emulators.pd42.state import Pd42State
from app.emulators.state import EmulatorState
from app.links.emulator import EmulatorPort
from app.links.errors import UnknownThing, UsageError, WrongState
from app.registers.catalog import MODELS

router = APIRouter(prefix="/devices/{device}/emulator", tags=["emulator"])


async def _emulator_port(device: CurrentDevice) -> EmulatorPort:
    if not isinstance(device.port, EmulatorPort):
        raise WrongState(f"{device.name} is not emulated here", "its switches and faults are real")
    return device.port


CurrentEmulator = Annotated[EmulatorPort, Depends(_emulator_port)]


class Emulated(Protocol):
    """What emulators of chips and of modules have in common."""

    def state(self, at_s: float) -> EmulatorState | Pd42State: ...

    def patch(self, change: BaseModel, at_s: float) -> EmulatorState | Pd42State: ...


@router.get("", responses=problems(UnknownThing, WrongState))
async def get_emulator(port: CurrentEmulator) -> EmulatorState | Pd42State:
    """Mechanics, switches, faults and time of what is emulated, as no driver sees them; `model` tells which it is."""
    return cast("Emulated", port.wire).state(port.take_turn())


@router.patch("", responses=problems(UnknownThing, WrongState, UsageError))
async def change_emulator(port: CurrentEmulator, body: EmulatorPatch | Pd42Patch) -> EmulatorState | Pd42State:
    """Force switches, cause faults, load the motor, run faster or slower, cut the power; what is left out stays."""
    wanted = EmulatorPatch if MODELS[port.wire.model].kind == "chip" else Pd42Patch
    return cast("Emulated", port.wire).patch(_suited(body, wanted), port.take_turn())


def _suited(body: BaseModel, wanted: type[BaseModel]) -> BaseModel:
    """A change as that emulator understands it: some bodies fit both. Raises UsageError."""
    if isinstance(body, wanted):
        return body
    try:
        return wanted.model_validate(body.model_dump(exclude_unset=True))
    except ValidationError as error:
        raise UsageError(f"not for this emulator: {findings(error)}") from error
