"""A harness for listed modules: real driver, plain emulated module, in this process or behind a wire."""

from __future__ import annotations

import threading
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import cast

from app.clock import VirtualClock, WallClock
from app.devices.core.config import AxisSettings, DeviceConfig
from app.devices.core.device import Device
from app.devices.manager import DeviceManager
from app.emulators.build import build_emulator
from app.emulators.line.line import Line
from app.emulators.listed.module import ListedModule
from app.emulators.listed.options import ListedPatch
from app.links.emulator import EmulatorPort
from app.links.registry import PortFactory, can_factory, serial_factory, tcp_factory
from app.main import emulator_port
from app.registers import catalog
from app.registers.listed.modules import Role, role_of
from app.registers.model import Register, Space
from tests.links.test_can_port import can_module
from tests.peers.served_line import served

NAMES = [model.name for model in catalog.listings() if model.kind == "module"]
SEVERAL = next(model.name for model in catalog.listings() if model.kind == "module" and model.axes > 1)
"""One with several axes."""
KINDS: dict[str, PortFactory] = {
    "emulator": emulator_port,
    "tcp": tcp_factory,
    "serial": serial_factory,
    "can": can_factory,
}


@dataclass
class Bench:
    clock: VirtualClock
    manager: DeviceManager
    device: Device

    @property
    def module(self) -> ListedModule:
        return cast("ListedModule", cast("EmulatorPort", self.device.session.port).wire)

    def patch(self, **change: object) -> None:
        self.module.patch(ListedPatch.model_validate(change))

    def row(self, role: Role, axis: int = 0) -> Register:
        return row_of(self.device, role, axis)


def row_of(device: Device, role: Role, axis: int = 0) -> Register:
    return next(row for row in device.family.table if row.axis == axis and role_of(row) == role)


def writable(device: Device) -> list[Register]:
    """Every parameter that can be written without the module answering elsewhere, or not at all, from then on."""
    return [
        row
        for row in device.family.table
        if row.access.writable and not (row.space is Space.GLOBAL_0 and row.address in (66, 255))
    ]


@asynccontextmanager
async def bench(model: str = NAMES[0], *axes: AxisSettings, **options: object) -> AsyncIterator[Bench]:
    """A connected module that has just been switched on; time is the test's."""
    clock = VirtualClock()
    manager = DeviceManager(KINDS, clock)
    device = await manager.add(DeviceConfig("Bench", model, {"kind": "emulator", **options}, axes=axes))
    assert device.state == "connected", device.problem
    try:
        yield Bench(clock, manager, device)
    finally:
        await manager.close()


@contextmanager
def far_line(model: str, path: Path) -> Iterator[tuple[ListedModule, tuple[str, int]]]:
    """A module on a line in a thread: a serial port at `path`, and a TCP port: where that is."""
    clock = WallClock()
    module = cast("ListedModule", build_emulator(model, clock))
    with served(Line([module], clock), path) as where:
        yield module, where


@contextmanager
def on_can(model: str, channel: str) -> Iterator[None]:
    """A module on python-can's virtual bus."""
    module = cast("ListedModule", build_emulator(model, WallClock()))
    turn = threading.Lock()

    def behave(data: bytes) -> bytes | None:
        frame = bytes((1, *data[:7]))
        with turn:
            reply = module.receive(frame + bytes((sum(frame) & 0xFF,)))
        return None if reply is None else reply[1:8]

    with can_module(channel) as bus:
        bus.behave = behave
        yield
