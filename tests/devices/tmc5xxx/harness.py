"""A harness for the driver of the TMC5xxx: the real driver, the real emulator, time owned by the test."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace
from typing import cast

from app.clock import Clock, VirtualClock
from app.devices.core.capabilities import EventLog
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.core.events import DeviceEvent
from app.devices.core.results import AxisState
from app.devices.manager import DeviceManager
from app.devices.tmc5xxx.decoded_registers import DecodedRegisters
from app.devices.tmc5xxx.memory import ChipMemory
from app.devices.tmc5xxx.ramp import Ramp
from app.devices.tmc5xxx.start_up import Start, start_up
from app.emulators.build import build_emulator
from app.emulators.drive.documents import ChipFaultsChange
from app.emulators.tmc5xxx import EmulatedTmc5xxx, Tmc5xxxOptions, Tmc5xxxPatch
from app.emulators.tmc5xxx.options import AxisChange, SwitchesChange
from app.links.emulator import EmulatorPort
from app.links.port import FramePort
from app.links.registry import Link
from app.registers.tmc5xxx.table import AXES

MODELS = ("tmc5031", "tmc5062", "tmc5072", "tmc5130", "tmc5160", "tmc5240")
START = Start(vmax=50_000, amax=200_000, vstart=0, counts_per_rev=40_000)
"""0.25 s to full speed, on 6250 microsteps."""


class Overheard(EmulatorPort):
    """An emulator's port that remembers what goes over it, and lets a test come between."""

    def __init__(self, wire: EmulatedTmc5xxx) -> None:
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
    options = Tmc5xxxOptions.model_validate({key: value for key, value in link.items() if key != "kind"})
    wire = build_emulator(model, clock, options)
    assert isinstance(wire, EmulatedTmc5xxx)
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
        """What the driver knows of the chip's registers."""
        memory = self.device.part(ChipMemory)
        assert memory is not None
        return memory

    @property
    def decoded(self) -> DecodedRegisters:
        """What that means."""
        decoded = self.device.part(DecodedRegisters)
        assert decoded is not None
        return decoded

    def ramp(self, axis: int = 0) -> Ramp:
        """The ramp as the user wants it."""
        return self.decoded.ramp(axis)

    @property
    def port(self) -> Overheard:
        return cast("Overheard", self.device.session.port)

    @property
    def wire(self) -> EmulatedTmc5xxx:
        return cast("EmulatedTmc5xxx", self.port.wire)

    def patch(self, change: Tmc5xxxPatch) -> None:
        self.wire.patch(change, self.port.take_turn())

    def fault(self, *, silence: bool | None = None, unplugged: bool | None = None, errors: float | None = None) -> None:
        self.patch(Tmc5xxxPatch(faults=ChipFaultsChange(silence=silence, unplugged=unplugged, bit_error_rate=errors)))

    def switches(self, axis: int = 0, *, left: bool | None = None, right: bool | None = None) -> None:
        self.patch(Tmc5xxxPatch(axes=[AxisChange(axis=axis, switches=SwitchesChange(left=left, right=right))]))

    def address(self, name: str, axis: int = 0) -> int:
        return self.memory.table.get(name, axis).address

    async def state(self, axis: int = 0) -> AxisState:
        return await self.device.monitor.axis_state(axis)

    async def at_rest(self, axis: int = 0, within_s: float = 30.0) -> AxisState:
        """Let time pass until the axis rests."""
        for _ in range(int(within_s / 0.05)):
            await self.clock.advance(0.05)
            state = await self.state(axis)
            if not state.moving:
                return state
        raise AssertionError(f"the axis still moves after {within_s} s")

    def event_names(self, axis: int = 0) -> list[str]:
        """Every event of the timeline, in order."""
        return [name for entry in self.device.need(EventLog).events(axis).events for name in entry.names]


@asynccontextmanager
async def bench(
    model: str = "tmc5160", start: Start | None = START, *, motor: object = "rigid", **options: object
) -> AsyncIterator[Bench]:
    """A connected device, all axes set up by `start`; None leaves it as after power-on. Rigid motors unless told."""
    clock = VirtualClock()
    manager = DeviceManager({"emulator": emulator_port}, clock)
    link = {"kind": "emulator", "motor": motor, **options}
    device = await manager.add(DeviceConfig("Bench", model, {name: value for name, value in link.items() if value}))
    assert device.state == "connected", device.problem
    made = Bench(clock, manager, device)
    if start is not None:
        first = start if made.memory.rows(0).x_enc is not None else replace(start, counts_per_rev=0)
        # A second encoder would take the pins of the right switches.
        await start_up(device, [first, replace(start, counts_per_rev=0)][: AXES[model]])
    device.listen(made.told.append)
    try:
        yield made
    finally:
        await manager.close()
