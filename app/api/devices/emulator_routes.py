"""The emulated chip or module behind a link: switches, faults, motor, time."""

from __future__ import annotations

from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, cast

from fastapi import Depends
from pydantic import BaseModel, ValidationError

from ...emulators.build import family_of
from ...emulators.core.family import Emulator
from ...emulators.families import FAMILIES
from ...errors import UnknownThing, UsageError, WrongState
from ...links.emulator import EmulatorPort
from ..deps import CurrentBench, CurrentDevice
from ..http.problems import findings, problems
from ..router import subject_router

router = subject_router(prefix="/devices/{device}/emulator", tags=["emulator"])


async def _emulator_port(device: CurrentDevice) -> EmulatorPort:
    if not isinstance(device.session.port, EmulatorPort):
        raise WrongState(f"{device.name} is not emulated here", "its switches and faults are real")
    return device.session.port


if TYPE_CHECKING:
    AnyState = BaseModel
    AnyPatch = BaseModel
else:  # the schema names each family's own
    AnyState = reduce(or_, (family.state for family in FAMILIES))
    AnyPatch = reduce(or_, (family.patch for family in FAMILIES))

CurrentEmulator = Annotated[EmulatorPort, Depends(_emulator_port)]


@router.get("", responses=problems(UnknownThing, WrongState))
async def get_emulator(port: CurrentEmulator) -> AnyState:
    """Mechanics, switches, faults and time of what is emulated, as no driver sees them; `model` tells which it is."""
    return cast("Emulator", port.wire).state(port.take_turn())


@router.patch("", responses=problems(UnknownThing, WrongState, UsageError))
async def change_emulator(
    bench: CurrentBench, device: CurrentDevice, port: CurrentEmulator, body: AnyPatch
) -> AnyState:
    """Force switches, cause faults, load the motor, run faster or slower, cut the power; what is left out stays."""
    state = cast("Emulator", port.wire).patch(_suited(body, family_of(port.wire.model).patch), port.take_turn())
    bench.positions.hurry(device)  # how fast its time runs may have changed, and its chip may have been reset
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
