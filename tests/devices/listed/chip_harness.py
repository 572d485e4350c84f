"""A harness for chips of which only a table is known: real driver, plain emulated chip, in this process."""

from __future__ import annotations

from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Any, cast

from app.clock import VirtualClock
from app.devices.core.config import AxisSettings, DeviceConfig
from app.devices.core.device import Device
from app.devices.core.events import DeviceEvent
from app.devices.manager import DeviceManager
from app.emulators.listed.chip import PlainChip
from app.emulators.listed.options import ListedPatch
from app.links.emulator import EmulatorPort
from app.main import emulator_port
from app.registers.catalog import MODELS
from app.registers.entry import Model, Slot
from app.registers.listed.chips import chip, table_of
from app.registers.model import Access, Field, Register

NAME = "made-up"
SOURCE = "made up"


def row(name: str, address: int, width: int = 32, **more: object) -> Register:
    return Register(name, width, "", address=address, source=SOURCE, **{"reset": None, **more})  # type: ignore[arg-type]


RAMP = (
    row("RAMPMODE", 0x20, 2),
    row("XACTUAL", 0x21),
    row("VACTUAL", 0x22, 24, access=Access.R),
    row("AMAX", 0x26, 16),
    row("VMAX", 0x27, 23),
    row("DMAX", 0x28, 16),
    row("XTARGET", 0x2D),
)
PLAIN = (
    row("GCONF", 0x00, fields=(Field("first", 1, ""), Field("second", 3, "", lsb=4))),
    row("GSTAT", 0x01, 3, read_clears=True, access=Access.UNKNOWN),
    row("UNSURE", 0x10, access=Access.UNKNOWN, fields=(Field("low", 8, ""), Field("high", 8, "", lsb=8))),
    row("TOLD", 0x11, access=Access.R),
)


def made(rows: Sequence[Register] = (*PLAIN, *RAMP), **more: object) -> Model:
    """A chip with these registers."""
    return chip(NAME, "Made-up", "a chip of a test", table_of(NAME, rows), **more)  # type: ignore[arg-type]


BOARD_ONLY: dict[str, Any] = {"spi": None, "slot": Slot("driver")}


@dataclass
class Bench:
    clock: VirtualClock
    manager: DeviceManager
    device: Device
    told: list[DeviceEvent] = field(default_factory=list)

    @property
    def chip(self) -> PlainChip:
        return cast("PlainChip", cast("EmulatorPort", self.device.session.port).wire)

    def patch(self, **change: object) -> None:
        self.chip.patch(ListedPatch.model_validate(change))


@asynccontextmanager
async def bench(model: Model | str, *axes: AxisSettings) -> AsyncIterator[Bench]:
    """A connected chip that has just been switched on; time is the test's."""
    name = model if isinstance(model, str) else model.name
    if isinstance(model, Model):
        MODELS[name] = model
    clock = VirtualClock()
    manager = DeviceManager({"emulator": emulator_port}, clock)
    try:
        device = await manager.add(DeviceConfig("Bench", name, {"kind": "emulator"}, axes=axes))
        assert device.state == "connected", device.problem
        ready = Bench(clock, manager, device)
        device.listen(ready.told.append)
        yield ready
    finally:
        await manager.close()
        if isinstance(model, Model):
            del MODELS[name]
