from __future__ import annotations

from collections.abc import AsyncIterator
from dataclasses import dataclass

import pytest

from app.clock import Clock, VirtualClock
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.manager import DeviceManager
from app.emulators.tmc428.device import EmulatedDevice
from app.emulators.tmc428.options import EmulatorPatch
from app.links.emulator import EmulatorPort
from app.main import emulator_port
from app.telemetry.hub import TelemetryHub


@dataclass
class Rig:
    """One emulated TMC428 under its own driver, all on a clock of the test."""

    clock: VirtualClock
    manager: DeviceManager
    hub: TelemetryHub
    device: Device

    @property
    def emulator(self) -> EmulatedDevice:
        port = self.device.session.port
        assert isinstance(port, EmulatorPort)
        assert isinstance(port.wire, EmulatedDevice)
        return port.wire

    def unplug(self, *, unplugged: bool) -> None:
        self.emulator.patch(EmulatorPatch.model_validate({"faults": {"unplugged": unplugged}}))


async def make_rig(clock: Clock, history_minutes: float = 10.0) -> tuple[DeviceManager, TelemetryHub, Device]:
    hub = TelemetryHub(clock, history_minutes)
    manager = DeviceManager({"emulator": emulator_port}, clock, on_change=lambda: hub.sync(manager.devices))
    device = await manager.add(DeviceConfig("chip", "tmc428", {"kind": "emulator"}))
    for name, value in (("v_max", 1000), ("a_max", 500), ("v_min", 1)):
        await device.registers.write(name, 0, value)
    await device.registers.write("pulse_div_ramp_div_usrs", 0, fields={"pulse_div": 4, "ramp_div": 6, "usrs": 4})
    await device.registers.write("pmul_pdiv", 0, fields={"pmul": 100, "pdiv": 6})
    return manager, hub, device


@pytest.fixture
async def rig() -> AsyncIterator[Rig]:
    clock = VirtualClock()
    manager, hub, device = await make_rig(clock)
    yield Rig(clock, manager, hub, device)
    await hub.close()
    await manager.close()
