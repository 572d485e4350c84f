"""The emulated device behind a link: switches, faults, time."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends

from app.api.deps import CurrentDevice
from app.api.problems import problems
from app.emulators.device import EmulatedDevice
from app.emulators.options import EmulatorPatch
from app.emulators.state import EmulatorState
from app.links.emulator import EmulatorPort
from app.links.errors import OutOfRange, UnknownThing, WrongState

router = APIRouter(prefix="/devices/{device}/emulator", tags=["emulator"])


async def _emulator(device: CurrentDevice) -> tuple[EmulatedDevice, EmulatorPort]:
    port = device.port
    if not (isinstance(port, EmulatorPort) and isinstance(port.wire, EmulatedDevice)):
        raise WrongState(f"{device.name} is not emulated here", "its switches and faults are real")
    return port.wire, port


CurrentEmulator = Annotated[tuple[EmulatedDevice, EmulatorPort], Depends(_emulator)]


@router.get("", responses=problems(UnknownThing, WrongState))
async def get_emulator(emulator: CurrentEmulator) -> EmulatorState:
    """The mechanics, switches, faults and time of an emulated device, as no driver can see them."""
    chip, port = emulator
    return chip.state(port.take_turn())


@router.patch("", responses=problems(UnknownThing, WrongState, OutOfRange))
async def change_emulator(emulator: CurrentEmulator, body: EmulatorPatch) -> EmulatorState:
    """Force switches, cause faults, run faster or slower, cut the power; what is left out stays."""
    chip, port = emulator
    return chip.patch(body, port.take_turn())
