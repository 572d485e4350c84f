"""A harness for extended positions: the service, real drivers and emulators of every family, time and day the test's.

`Hardware` is what a server's end does not touch: a chip that lives on while servers come and go.
"""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from contextvars import Context
from dataclasses import dataclass, field
from functools import partial
from typing import Protocol, cast

from pydantic import BaseModel

from app.clock import Clock, VirtualClock
from app.devices.core.capabilities import PositionSetting
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.core.events import DeviceEvent
from app.devices.core.results import MoveStarted, StopOutcome
from app.devices.manager import DeviceManager
from app.devices.tmc5xxx import start_up as tmc5xxx
from app.devices.tmc428 import start_up as ramp_chips
from app.devices.tmc428.start_up import AxisStart
from app.devices.tmc4361 import start_up as tmc4361
from app.emulators.build import build_emulator, family_of, options_of
from app.links.access32 import SPI32
from app.links.emulator import EmulatorPort
from app.links.port import FramePort, Wire
from app.links.register_access import access_of
from app.links.registry import Link
from app.links.tmcl import Request
from app.positions import ExtendedPositionService
from app.positions.axis import WatchedAxis
from app.positions.state import ExtendedState
from app.registers.catalog import MODELS
from app.registers.tmcl.commands import Opcode
from app.registers.tmcl.modules import MODULES

RAMP = AxisStart(v_max=2047, a_max=500, pulse_div=0, ramp_div=6, stops=False)
"""500 kpps, as fast as these chips get: a counter of 24 bits is round in 34 s."""
SIXPOINT = tmc5xxx.Start(vmax=7_900_000, amax=7_000_000, stops=False)
S_RAMP = tmc4361.Start(vmax=50_000, amax=200_000, bow=2_000_000, counts_per_rev=40_000, stops=False)
FAMILIES = ("tmc428", "tmc4210", "tmc4361", "tmc5160", "pd42-1241", "tmcm-1161")
TARGETS = {"tmc428": "x_target", "tmc4210": "X_TARGET", **dict.fromkeys(MODULES, "target_position")}
"""Names of the target register, where it is not XTARGET."""
DAY_S = 1_700_000_000.0
"""What day it is at second 0 of the test's clock."""


@dataclass
class Hardware:
    """Chips that are there, by name."""

    clock: VirtualClock = field(default_factory=VirtualClock)
    wires: dict[str, Wire] = field(default_factory=dict)

    def port(self, model: str, link: Link, clock: Clock) -> FramePort:
        """`{"kind": "emulator", "chip": name}`: that chip, made where it is not there yet."""
        options = {key: value for key, value in link.items() if key not in ("kind", "chip")}
        name = str(link.get("chip", ""))
        if name not in self.wires:
            self.wires[name] = cast("Wire", build_emulator(model, clock, options_of(model).model_validate(options)))
        return EmulatorPort(self.wires[name])

    slept_s: float = 0.0
    """How much longer the day is than the clock says."""

    def unix_s(self) -> float:
        return DAY_S + self.clock.now() + self.slept_s


class Patched(Protocol):
    """What every emulator can."""

    def patch(self, change: BaseModel) -> object: ...


def patch(wire: Wire, change: dict[str, object]) -> None:
    """Change the plant of an emulator."""
    cast("Patched", wire).patch(family_of(wire.model).patch.model_validate(change))


@dataclass
class Bench:
    """One server: its devices, its service."""

    hardware: Hardware
    manager: DeviceManager
    service: ExtendedPositionService
    changes: list[int]
    told: list[DeviceEvent] = field(default_factory=list)
    stopped: asyncio.Future[list[StopOutcome]] | None = None

    @property
    def clock(self) -> VirtualClock:
        return self.hardware.clock

    @property
    def device(self) -> Device:
        return self.manager.devices[0]

    @property
    def wire(self) -> Wire:
        return cast("EmulatorPort", self.device.session.port).wire

    def patch(self, **change: object) -> None:
        """Change the plant of the first device's emulator."""
        cast("EmulatorPort", self.device.session.port).take_turn()
        patch(self.wire, change)

    @property
    def whole(self) -> int:
        """How many positions the counter tells apart."""
        bits = self.device.counter.counter_bits(0)
        assert bits is not None
        return 1 << bits

    @property
    def half(self) -> int:
        return self.whole // 2

    async def stand(self, count: int) -> int:
        """Have the counter of axis 0 show `count` while the motor stands; before anybody watches. Returns `count`."""
        setting = self.device.part(PositionSetting)
        if setting is None:
            await self.device.stop(0)
            await self.device.registers.write("actual_position", 0, count)
        else:
            await setting.set_position(0, count)
        return count

    async def write_target(self, count: int) -> None:
        """Write the target register by its name."""
        await self.device.registers.write(self.target_row, 0, count)

    @property
    def target_row(self) -> str:
        """The target register's name."""
        return TARGETS.get(self.device.model, "XTARGET")

    async def target(self) -> int:
        """What the target register holds."""
        return (await self.device.registers.read(self.target_row, 0)).value

    def frame_of_target(self, count: int) -> bytes:
        """The same as a raw frame."""
        model = self.device.family
        if model.kind == "module":
            return Request(1, Opcode.SAP, 0, 0, count).encode()
        row = model.table.get(next(name for name in ("XTARGET", "x_target") if self._has(name)), 0)
        access = access_of(self.device.link, model.name) if model.datagram_bits == 40 else SPI32
        return access.write_frames([(row.address, count & row.mask)])[0]

    def _has(self, name: str) -> bool:
        return self.device.family.table.find(name, 0) is not None

    def stop_within_the_next_retarget(self) -> None:
        """Somebody stops axis 0 as soon as the service's next command has sent its first frame: `stopped`."""
        port, exchange, retarget = (
            cast("EmulatorPort", self.device.session.port),
            self.wire.exchange,
            self.device.motion.retarget,
        )

        def stopping(frame: bytes, at_s: float | None = None) -> bytes:
            port.wire.exchange = exchange  # type: ignore[method-assign]
            Context().run(stop)  # by somebody else
            return exchange(frame, at_s)

        def stop() -> None:
            # An emulator answers at once, so that a task gets its turn too late: what a stop does before it waits.
            self.device.session.stops[0] += 1
            self.device.session.commanded(0, "stop")
            self.stopped = asyncio.ensure_future(self.device.stop_axes([0]))

        async def caught(axis: int, count_target: int) -> MoveStarted:
            port.wire.exchange = stopping  # type: ignore[method-assign]
            return await retarget(axis, count_target)

        self.device.motion.retarget = caught  # type: ignore[method-assign]

    async def state(self, axis: int = 0) -> ExtendedState:
        """As somebody gets it who asks: looked at now."""
        return await self.service.state(self.device, axis)

    def watched(self, axis: int = 0) -> WatchedAxis:
        return self.service._axes[self.device, axis]

    def seen(self, axis: int = 0) -> ExtendedState:
        """As of the service's own latest look."""
        return self.watched(axis).state()

    async def arrived_within(self, seconds: float, axis: int = 0) -> ExtendedState:
        """The state in `seconds` [s], looked at by nobody but the service."""
        await self.clock.advance(seconds)
        return self.seen(axis)

    async def until(
        self, wanted: Callable[[ExtendedState], bool], within_s: float, step_s: float = 1.0, axis: int = 0
    ) -> ExtendedState:
        """Let time pass until the state is as wanted, by nobody's look but the service's own."""
        for _ in range(int(within_s / step_s) + 1):
            if wanted(self.seen(axis)):
                return self.seen(axis)
            await self.clock.advance(step_s)
        raise AssertionError(f"not within {within_s} s: {self.seen(axis)}")

    async def arrived(self, within_s: float, axis: int = 0) -> ExtendedState:
        return await self.until(lambda state: state.state != "moving", within_s, axis=axis)


@asynccontextmanager
async def server(
    hardware: Hardware, model: str, *, set_up: bool = True, kind: str = "emulator"
) -> AsyncIterator[Bench]:
    """A server with one device; with `set_up` its chip is made ready to move."""
    changes: list[int] = []
    service = ExtendedPositionService(hardware.clock, partial(changes.append, 1), hardware.unix_s)
    manager = DeviceManager(
        {"emulator": hardware.port, "tcp": hardware.port}, hardware.clock, lambda: service.sync(manager.devices)
    )
    made = Bench(hardware, manager, service, changes)
    link: dict[str, object] = {"kind": kind, "chip": model}
    if model.startswith("tmc5"):
        link["motor"] = "rigid"  # no physics: counters alone are looked at here
    device = await manager.add(DeviceConfig("Bench", model, link))
    assert device.state == "connected", device.problem
    device.listen(made.told.append)
    if set_up:
        await set_up_axes(device)
    try:
        yield made
    finally:
        await service.close()
        await manager.close()


async def set_up_axes(device: Device) -> None:
    """Make every axis ready to move, fast."""
    axes = MODELS[device.model].axes
    if device.model in ("tmc428", "tmc4210"):
        await ramp_chips.start_up(device, [RAMP] * axes)
    elif device.model == "tmc4361":
        await tmc4361.start_up(device, S_RAMP)
    elif device.model not in MODULES:
        await tmc5xxx.start_up(device, [SIXPOINT] * axes)


@asynccontextmanager
async def bench(model: str, *, set_up: bool = True) -> AsyncIterator[Bench]:
    """A server with new hardware."""
    async with server(Hardware(), model, set_up=set_up) as made:
        yield made
