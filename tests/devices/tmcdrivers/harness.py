"""A harness for the driver of a TMC22xx: the real driver, the real emulator, time owned by the test."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Any, cast

from app.clock import Clock, VirtualClock
from app.devices.core.config import AxisSettings, DeviceConfig
from app.devices.core.device import Device
from app.devices.core.events import DeviceEvent
from app.devices.core.results import AxisState
from app.devices.manager import DeviceManager
from app.emulators.build import build_emulator, options_of
from app.emulators.tmcdrivers import EmulatedDriver, TmcDriverPatch
from app.links.emulator import EmulatorPort
from app.links.port import FramePort
from app.links.registry import Link


def emulator_port(model: str, link: Link, clock: Clock) -> FramePort:
    options = {key: value for key, value in link.items() if key != "kind"}
    return EmulatorPort(build_emulator(model, clock, options_of(model).model_validate(options)))


@dataclass
class Bench:
    """One device, connected, and everything around it."""

    clock: VirtualClock
    manager: DeviceManager
    device: Device
    told: list[DeviceEvent] = field(default_factory=list)

    @property
    def chip(self) -> EmulatedDriver:
        return cast("EmulatedDriver", cast("EmulatorPort", self.device.session.port).wire)

    def patch(self, **change: object) -> None:
        port = cast("EmulatorPort", self.device.session.port)
        self.chip.patch(TmcDriverPatch.model_validate(change), port.take_turn())

    def held(self, name: str) -> int:
        """What the chip itself has, whether a bus can read it or not."""
        return self.chip._chip.held(self.device.family.table.get(name, 0).address)

    async def put(self, **values: int) -> None:
        for name, value in values.items():
            await self.device.registers.write(name, None, value)

    async def value(self, name: str) -> int:
        return (await self.device.registers.read(name, None)).value

    async def state(self) -> AxisState:
        return await self.device.monitor.axis_state(0)

    async def ready(self) -> None:
        await self.put(IHOLD_IRUN=0x1_10_08, CHOPCONF=0x1000_0053)
        await self.device.registers.write("GCONF", None, fields={"mstep_reg_select": 1, "pdn_disable": 1})


@asynccontextmanager
async def bench(model: str = "tmc2209", axis: AxisSettings | None = None, **link: Any) -> AsyncIterator[Bench]:
    clock = VirtualClock()
    manager = DeviceManager({"emulator": emulator_port}, clock)
    axes = () if axis is None else (axis,)
    try:
        device = await manager.add(DeviceConfig("driver", model, {"kind": "emulator", **link}, axes=axes))
        made = Bench(clock, manager, device)
        device.listen(made.told.append)
        yield made
    finally:
        await manager.close()
