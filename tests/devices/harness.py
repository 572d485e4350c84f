"""A harness for driver tests: real drivers, real emulators, time owned by the test."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import cast

from app.clock import Clock, VirtualClock
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.manager import DeviceManager
from app.devices.tmc428.memory import RampMemory
from app.devices.tmc428.start_up import AxisStart, start_up
from app.emulators.build import build_emulator
from app.emulators.drive.documents import ChipFaultsChange
from app.emulators.tmc428.device import EmulatedDevice
from app.emulators.tmc428.options import EmulatorOptions, EmulatorPatch
from app.links.emulator import EmulatorPort
from app.links.port import FramePort
from app.links.registry import Link, tcp_factory

START = AxisStart(v_max=1500, a_max=200, pulse_div=4, ramp_div=6)
"""22.9 kpps, 93 kpps^2 at 16 MHz: 1500 microsteps to full speed."""


def emulator_port(model: str, link: Link, clock: Clock) -> FramePort:
    options = EmulatorOptions.model_validate({key: value for key, value in link.items() if key != "kind"})
    return EmulatorPort(build_emulator(model, clock, options))


KINDS = {"emulator": emulator_port, "tcp": tcp_factory}


def emulator_of(device: Device) -> EmulatedDevice:
    """The chip behind an emulated device."""
    return cast("EmulatedDevice", cast("EmulatorPort", device.session.port).wire)


def state_of(device: Device) -> str:
    """Its state, as a type checker that remembers earlier comparisons must not narrow it."""
    return device.state


@dataclass
class Bench:
    """One device, connected, and everything around it."""

    clock: VirtualClock
    manager: DeviceManager
    device: Device

    @property
    def chip(self) -> RampMemory:
        """What its driver remembers of the chip."""
        chip = self.device.part(RampMemory)
        assert chip is not None
        return chip

    @property
    def wire(self) -> EmulatedDevice:
        return emulator_of(self.device)

    def fault(self, *, silence: bool | None = None, unplugged: bool | None = None, errors: float | None = None) -> None:
        change = ChipFaultsChange(silence=silence, unplugged=unplugged, bit_error_rate=errors)
        self.wire.patch(EmulatorPatch(faults=change))

    async def at_rest(self, axis: int = 0, within_s: float = 60.0) -> int:
        """Let time pass until the axis rests; returns where."""
        for _ in range(int(within_s / 0.05)):
            await self.clock.advance(0.05)
            state = await self.device.monitor.axis_state(axis)
            if not state.moving:
                return state.position
        raise AssertionError(f"axis {axis} still moves after {within_s} s")


@asynccontextmanager
async def bench(
    model: str = "tmc428", *, started: bool = True, stops: bool = False, **options: object
) -> AsyncIterator[Bench]:
    """A connected device; `started` after chapter 13, with stop switches as `stops` says."""
    clock = VirtualClock()
    manager = DeviceManager(KINDS, clock)
    device = await manager.add(DeviceConfig("Bench", model, {"kind": "emulator", **options}))
    assert device.state == "connected", device.problem
    if started:
        start = AxisStart(START.v_max, START.a_max, START.pulse_div, START.ramp_div, stops=stops)
        await start_up(device, [start] * len(device.axes))
    try:
        yield Bench(clock, manager, device)
    finally:
        await manager.close()
