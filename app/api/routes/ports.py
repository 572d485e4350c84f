"""Where a device could be: the machine's serial ports, and the emulators."""

from __future__ import annotations

import asyncio

from fastapi import APIRouter
from serial.tools import list_ports

from app.api.deps import CurrentBench
from app.api.schemas import Port
from app.registers.catalog import MODELS

router = APIRouter(tags=["server"])


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
    """Serial ports found right now, and the chips that can be emulated."""
    emulated = [
        Port(kind="emulator", name=f"emulator:{model.name}", description=f"emulated {model.title}", model=model.name)
        for model in MODELS.values()
    ]
    return await asyncio.to_thread(bench.list_serial_ports) + emulated
