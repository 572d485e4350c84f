"""A harness for a TMCL module: real driver, real emulator, time owned by the test, and every frame noted down."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import TypeVar, cast

from app.clock import Clock, ScaledClock, VirtualClock
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.manager import DeviceManager
from app.emulators.tmcl.family import FAMILY
from app.emulators.tmcl.module import EmulatedModule
from app.emulators.tmcl.options import TmclOptions, TmclPatch
from app.links.emulator import EmulatorPort
from app.links.port import FramePort
from app.links.registry import Link
from app.links.tmcl import Request
from app.registers.tmcl.commands import Opcode


@dataclass
class Tap:
    """The module's wire, with a note of each frame that reached it and, if wanted, a hand in its answers."""

    module: EmulatedModule
    frames: list[Request] = field(default_factory=list)
    spoil: Callable[[Request, bytes], bytes] | None = None

    @property
    def model(self) -> str:
        return self.module.model

    @property
    def clock(self) -> ScaledClock:
        return self.module.clock

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        request = Request.decode(frame)
        if not self.module.faults.unplugged:
            self.frames.append(request)
        reply = self.module.exchange(frame, at_s)
        return reply if self.spoil is None else self.spoil(request, reply)

    def count(self, *opcodes: Opcode) -> int:
        """How many frames with one of these commands reached the module."""
        return sum(request.opcode in opcodes for request in self.frames)


P = TypeVar("P")

MOVERS = (Opcode.MVP, Opcode.ROR, Opcode.ROL, Opcode.MST, Opcode.RFS)


def module_port(model: str, link: Link, clock: Clock) -> FramePort:
    options = TmclOptions.model_validate({key: value for key, value in link.items() if key != "kind"})
    return EmulatorPort(Tap(FAMILY.make(model, clock, options)))


def state_of(device: Device) -> str:
    """Its state, as a type checker that remembers earlier comparisons must not narrow it."""
    return device.state


@dataclass
class Bench:
    """One module, connected, and everything around it."""

    clock: VirtualClock
    manager: DeviceManager
    device: Device

    def part(self, kind: type[P]) -> P:
        """What this family alone has."""
        part = self.device.part(kind)
        assert part is not None
        return part

    @property
    def tap(self) -> Tap:
        return cast("Tap", cast("EmulatorPort", self.device.session.port).wire)

    @property
    def module(self) -> EmulatedModule:
        return self.tap.module

    def patch(self, **change: object) -> None:
        """Change the plant; samples that fell due before are taken first, as by everybody who uses the port."""
        cast("EmulatorPort", self.device.session.port).take_turn()
        self.module.patch(TmclPatch.model_validate(change))

    async def at_rest(self, within_s: float = 60.0) -> int:
        """Let time pass until the axis rests; returns where."""
        for _ in range(int(within_s / 0.05)):
            await self.clock.advance(0.05)
            state = await self.device.monitor.axis_state(0)
            if not state.moving:
                return state.position
        raise AssertionError(f"the axis still moves after {within_s} s")


@asynccontextmanager
async def bench(model: str = "pd42-1241", **options: object) -> AsyncIterator[Bench]:
    """A connected module, as it comes from the factory."""
    clock = VirtualClock()
    manager = DeviceManager({"emulator": module_port}, clock)
    device = await manager.add(DeviceConfig("Bench", model, {"kind": "emulator", **options}))
    assert device.state == "connected", device.problem
    try:
        yield Bench(clock, manager, device)
    finally:
        await manager.close()
