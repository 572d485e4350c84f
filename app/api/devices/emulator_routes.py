"""The emulated chip or module behind a link: switches, faults, motor, time."""

from __future__ import annotations

from typing import Annotated, Protocol, cast

from fastapi import APIRouter, Depends
from pydantic import BaseModel, ValidationError

from ...emulators.tmc5xxx import MODELS as TMC5XXX
from ...emulators.tmc5xxx import Tmc5xxxPatch, Tmc5xxxState
from ...emulators.tmc428.options import EmulatorPatch
from ...emulators.tmc428.state import EmulatorState
from ...emulators.tmc4361.options import Tmc4361Patch
from ...emulators.tmc4361.state import Tmc4361State
from ...emulators.tmcl.options import Pd42Patch
from ...emulators.tmcl.state import Pd42State
from ...errors import UnknownThing, UsageError, WrongState
from ...links.emulator import EmulatorPort
from ..deps import CurrentBench, CurrentDevice
from ..http.problems import findings, problems

router = APIRouter(prefix="/devices/{device}/emulator", tags=["emulator"])


async def _emulator_port(device: CurrentDevice) -> EmulatorPort:
    if not isinstance(device.port, EmulatorPort):
        raise WrongState(f"{device.name} is not emulated here", "its switches and faults are real")
    return device.port


AnyState = EmulatorState | Tmc4361State | Tmc5xxxState | Pd42State
AnyPatch = EmulatorPatch | Tmc4361Patch | Tmc5xxxPatch | Pd42Patch
PATCHES: dict[str, type[BaseModel]] = {
    "tmc428": EmulatorPatch,
    "tmc4210": EmulatorPatch,
    "tmc4361": Tmc4361Patch,
    **dict.fromkeys(TMC5XXX, Tmc5xxxPatch),
    "pd42-1241": Pd42Patch,
}
"""What changes the emulator of each model."""

CurrentEmulator = Annotated[EmulatorPort, Depends(_emulator_port)]


class Emulated(Protocol):
    """What emulators of chips and of modules have in common."""

    def state(self, at_s: float) -> AnyState: ...

    def patch(self, change: BaseModel, at_s: float) -> AnyState: ...


@router.get("", responses=problems(UnknownThing, WrongState))
async def get_emulator(port: CurrentEmulator) -> AnyState:
    """Mechanics, switches, faults and time of what is emulated, as no driver sees them; `model` tells which it is."""
    return cast("Emulated", port.wire).state(port.take_turn())


@router.patch("", responses=problems(UnknownThing, WrongState, UsageError))
async def change_emulator(
    bench: CurrentBench, device: CurrentDevice, port: CurrentEmulator, body: AnyPatch
) -> AnyState:
    """Force switches, cause faults, load the motor, run faster or slower, cut the power; what is left out stays."""
    state = cast("Emulated", port.wire).patch(_suited(body, PATCHES[port.wire.model]), port.take_turn())
    bench.endless.hurry(device)  # how fast its time runs may have changed, and its chip may have been reset
    bench.conditions.stirred(device)
    return state


def _suited(body: BaseModel, wanted: type[BaseModel]) -> BaseModel:
    """A change as that emulator understands it: some bodies fit both. Raises UsageError."""
    if isinstance(body, wanted):
        return body
    try:
        return wanted.model_validate(body.model_dump(exclude_unset=True))
    except ValidationError as error:
        raise UsageError(f"not for this emulator: {findings(error)}") from error
