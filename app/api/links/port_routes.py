"""Where a device could be: the machine's serial ports, the modules that answer on them, and the emulators."""

from __future__ import annotations

import asyncio

from serial.tools import list_ports

from ...errors import UsageError, WrongState
from ...registers.catalog import MODELS
from ..deps import CurrentBench
from ..http.problems import problems
from ..policy import policy
from ..router import subject_router
from ..schemas import Port
from .schemas import ProbeStart, ProbeState

router = subject_router(tags=["server"])


def serial_ports() -> list[Port]:
    """The serial ports of this machine, with their USB ids. Blocks for some milliseconds."""
    return [
        Port(
            kind="serial",
            name=port.device,
            description=port.description if port.description not in ("", "n/a") else port.device,
            usb_vid=port.vid,
            usb_pid=port.pid,
            usb_serial=port.serial_number,
        )
        for port in sorted(list_ports.comports())
    ]


@router.get("/ports")
async def get_ports(bench: CurrentBench) -> list[Port]:
    """Serial ports found right now, who uses them, and the chips and modules that can be emulated."""
    emulated = [
        Port(kind="emulator", name=f"emulator:{model.name}", description=f"emulated {model.title}", model=model.name)
        for model in MODELS.values()
    ]
    found = await asyncio.to_thread(bench.list_serial_ports)
    return [port.model_copy(update={"in_use_by": bench.users_of(port.name)}) for port in found] + emulated


@router.get("/ports/probe")
async def get_probe(bench: CurrentBench) -> ProbeState:
    """How far the search for modules is, or what the latest one found."""
    return bench.probing.state()


@router.post("/ports/probe", status_code=202, responses=problems(UsageError, WrongState))
@policy(audit="silent")
async def start_probe(bench: CurrentBench, body: ProbeStart) -> ProbeState:
    """Look for modules, or chips, on a port, rate by rate and address by address. One search at a time.

    Answers at its start.

    A line that devices use is asked at their baud rate, and their commands go first.
    """
    return bench.probing.start(body.port, body.bauds, body.addresses, chips=body.kind == "chips")


@router.delete("/ports/probe")
@policy(audit="silent")
async def abort_probe(bench: CurrentBench) -> ProbeState:
    """End the search; what it has found so far stays."""
    return await bench.probing.abort()
