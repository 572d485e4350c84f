"""A harness for the driver of a TMC4361: the real driver, the real emulator, time owned by the test."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import cast

from app.clock import Clock, VirtualClock
from app.devices.core.capabilities import EventLog
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.core.events import DeviceEvent
from app.devices.core.results import AxisState
from app.devices.manager import DeviceManager
from app.devices.tmc4361.memory import ChipMemory
from app.devices.tmc4361.start_up import Closed, Start, start_up
from app.emulators.build import build_emulator
from app.emulators.tmc4361 import EmulatedTmc4361, Tmc4361Options
from app.emulators.tmc4361.options import FaultsChange, PinsChange, SwitchesChange, Tmc4361Patch
from app.links.emulator import EmulatorPort
from app.links.port import FramePort
from app.links.registry import Link

START = Start(vmax=50_000, amax=200_000, bow=2_000_000, counts_per_rev=40_000, closed=Closed())
"""0.35 s to full speed, on 8750 microsteps (NOTES-TMC4361-RAMPS 2)."""


class Overheard(EmulatorPort):
    """An emulator's port that remembers what goes over it, and lets a test come between."""

    def __init__(self, wire: EmulatedTmc4361) -> None:
        super().__init__(wire)
        self.frames: list[bytes] = []
        self.before_frame: Callable[[bytes], None] = lambda _: None

    def _answer(self, frame: bytes, at_s: float) -> bytes:
        self.frames.append(frame)
        self.before_frame(frame)
        return super()._answer(frame, at_s)

    def written(self, address: int) -> list[int]:
        """The data of every write to that address."""
        return [int.from_bytes(frame[1:], "big") for frame in self.frames if frame[0] == address | 0x80]


def emulator_port(model: str, link: Link, clock: Clock) -> FramePort:
    options = Tmc4361Options.model_validate({key: value for key, value in link.items() if key != "kind"})
    wire = build_emulator(model, clock, options)
    assert isinstance(wire, EmulatedTmc4361)
    return Overheard(wire)


@dataclass
class Bench:
    """One device, connected, and everything around it."""

    clock: VirtualClock
    manager: DeviceManager
    device: Device
    told: list[DeviceEvent] = field(default_factory=list)

    @property
    def memory(self) -> ChipMemory:
        """The shadow of the chip's registers."""
        memory = self.device.part(ChipMemory)
        assert memory is not None
        return memory

    @property
    def port(self) -> Overheard:
        return cast("Overheard", self.device.session.port)

    @property
    def wire(self) -> EmulatedTmc4361:
        return cast("EmulatedTmc4361", self.port.wire)

    def patch(self, change: Tmc4361Patch) -> None:
        self.wire.patch(change, self.port.take_turn())

    def fault(self, *, silence: bool | None = None, unplugged: bool | None = None, errors: float | None = None) -> None:
        self.patch(Tmc4361Patch(faults=FaultsChange(silence=silence, unplugged=unplugged, bit_error_rate=errors)))

    def switches(self, *, left: bool | None = None, right: bool | None = None, home: bool | None = None) -> None:
        self.patch(Tmc4361Patch(switches=SwitchesChange(left=left, right=right, home=home)))

    def freeze(self) -> None:
        self.patch(Tmc4361Patch(pins=PinsChange(freeze=False)))

    async def state(self) -> AxisState:
        return await self.device.monitor.axis_state(0)

    async def at_rest(self, within_s: float = 30.0) -> AxisState:
        """Let time pass until the axis rests."""
        for _ in range(int(within_s / 0.05)):
            await self.clock.advance(0.05)
            state = await self.state()
            if not state.moving:
                return state
        raise AssertionError(f"the axis still moves after {within_s} s")

    def event_names(self) -> list[str]:
        """Every event of the timeline, in order."""
        return [name for entry in self.device.need(EventLog).events(0).events for name in entry.names]


@asynccontextmanager
async def bench(start: Start | None = START, **options: object) -> AsyncIterator[Bench]:
    """A connected device, set up by `start`; None leaves it as after power-on."""
    clock = VirtualClock()
    manager = DeviceManager({"emulator": emulator_port}, clock)
    device = await manager.add(DeviceConfig("Bench", "tmc4361", {"kind": "emulator", **options}))
    assert device.state == "connected", device.problem
    if start is not None:
        await start_up(device, start)
    made = Bench(clock, manager, device)
    device.listen(made.told.append)
    try:
        yield made
    finally:
        await manager.close()
