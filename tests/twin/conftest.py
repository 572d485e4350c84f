from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from typing import Any

import pytest

from app.clock import VirtualClock
from app.devices.core.config import AxisSettings, DeviceConfig
from app.devices.core.device import Device
from app.devices.manager import DeviceManager
from app.main import emulator_port
from app.telemetry.hub import TelemetryHub
from app.twin.process import Address, Renderer, TwinFailed
from app.twin.service import Twin


@dataclass
class Noting:
    """A renderer that notes what it is told, on the clock of the test: the process itself is tested on its own."""

    clock: VirtualClock
    takes_s: float = 0.0
    told: list[tuple[float, dict[str, Any]]] = field(default_factory=list)
    closed: bool = False
    broken: str = ""
    dead: asyncio.Event = field(default_factory=asyncio.Event)
    address: Address = field(default_factory=lambda: Address(1, ()))
    pid: int = 1

    async def show(self, message: dict[str, Any]) -> None:
        if self.broken:
            raise TwinFailed(self.broken)
        self.told.append((self.clock.now(), message))
        if self.takes_s and "look" in message:
            await self.clock.sleep(self.takes_s)

    async def ended(self) -> TwinFailed:
        await self.dead.wait()
        return TwinFailed("was ended by signal 9")

    async def close(self) -> None:
        self.closed = True

    @property
    def looks_s(self) -> list[float]:
        return [at_s for at_s, message in self.told if "look" in message]

    @property
    def look(self) -> dict[str, Any]:
        look: dict[str, Any] = next(message["look"] for _, message in reversed(self.told) if "look" in message)
        return look


@dataclass
class Rig:
    """A twin over emulated chips, all on a clock of the test."""

    clock: VirtualClock
    manager: DeviceManager
    hub: TelemetryHub
    twin: Twin
    device: Device
    """A TMC5160 with an encoder on a stage, ready to move."""
    renderers: list[Noting]

    @property
    def renderer(self) -> Noting:
        return self.renderers[-1]


IDLE_S = 4.0
RAMP = {"CHOPCONF": 0x0001_0153, "IHOLD_IRUN": 0x0007_1F0A, "A1": 1000, "V1": 50_000, "AMAX": 500, "VMAX": 200_000}
MORE = {"DMAX": 700, "D1": 1400, "VSTOP": 10, "ENCMODE": 1 << 10, "ENC_CONST": 1 << 16 | 2800}


@pytest.fixture
async def rig() -> AsyncIterator[Rig]:
    clock = VirtualClock(100.0)
    hub = TelemetryHub(clock, 1.0)

    def changed() -> None:
        hub.sync(manager.devices)
        twin.sync(manager.devices)

    renderers: list[Noting] = []

    async def start() -> Renderer:
        renderers.append(Noting(clock))
        return renderers[-1]

    twin = Twin(clock, hub, start, IDLE_S)
    manager = DeviceManager({"emulator": emulator_port}, clock, on_change=changed)
    axes = (AxisSettings(name="X", travel_mm_per_rev=8.0),)
    device = await manager.add(DeviceConfig("chip", "tmc5160", {"kind": "emulator"}, axes=axes))
    for name, value in (RAMP | MORE).items():
        await device.registers.write(name, 0, value)
    yield Rig(clock, manager, hub, twin, device, renderers)
    await twin.off()
    await hub.close()
    await manager.close()
