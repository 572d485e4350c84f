"""For profiles: real drivers and emulators of every family, a wire that can be made to fail, and the truth."""

from __future__ import annotations

import contextlib
import random
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Any, cast

from app.clock import Clock, ScaledClock, VirtualClock
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.core.results import WriteItem
from app.devices.manager import DeviceManager
from app.devices.tmc5xxx import start_up as start_5xxx
from app.devices.tmc428 import start_up as start_ramps
from app.devices.tmc4361 import start_up as start_4361
from app.emulators.build import build_emulator, options_of
from app.emulators.tmc5xxx import EmulatedTmc5xxx
from app.emulators.tmc4361 import EmulatedTmc4361
from app.emulators.tmcdrivers import EmulatedDriver, TmcDriverPatch
from app.emulators.tmcdrivers.tagged import EmulatedTagged
from app.errors import OutOfRange
from app.links import datagram32, tmcl
from app.links.emulator import EmulatorPort
from app.links.port import FramePort, Wire
from app.links.registry import Link
from app.profiles.items import Item, Key, items_of
from app.profiles.steps import write_of
from app.registers.catalog import MODELS
from app.registers.model import Space, to_raw
from app.registers.tmcl.modules import MODULES

EVERY_MODEL = tuple(MODELS)
FAMILIES = ("tmc428", "tmc4210", "tmc4361", "tmc5160", "tmc5062", "pd42-1241")
"""One of each, and one of the chips with two axes."""
DATA_32 = (1 << 24) - 1

Spoil = Callable[[bytes, Callable[[bytes], bytes]], bytes]
"""What happens on the wire: the frame, and who answers it."""


class TappedWire:
    """The emulator's wire, with a hand on it. Raises what `spoil` raises."""

    def __init__(self, emulator: Wire) -> None:
        self.emulator = emulator
        self.spoil: Spoil | None = None
        self.frames = 0

    @property
    def model(self) -> str:
        return self.emulator.model

    @property
    def clock(self) -> ScaledClock:
        return self.emulator.clock

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        self.frames += 1
        if self.spoil is None:
            return self.emulator.exchange(frame, at_s)
        return self.spoil(frame, lambda sent: self.emulator.exchange(sent, at_s))


@dataclass
class Bench:
    """One device, connected and set up, and everything around it."""

    clock: VirtualClock
    manager: DeviceManager
    device: Device

    @property
    def wire(self) -> TappedWire:
        return cast("TappedWire", cast("EmulatorPort", self.device.session.port).wire)

    def stepped(self, hz: float) -> None:
        """Steps come in at a driver from now on."""
        port = cast("EmulatorPort", self.device.session.port)
        change = TmcDriverPatch.model_validate({"pins": {"step_hz": hz}})
        cast("EmulatedDriver | EmulatedTagged", self.wire.emulator).patch(change, port.take_turn())

    def truth(self) -> dict[Key, int]:
        """What the emulator holds of its configuration, past wire and driver."""
        return {item.key: self._held(item) & item.mask for item in items_of(self.device.model)}

    def _held(self, item: Item) -> int:
        emulator = self.wire.emulator
        if isinstance(emulator, EmulatedTmc5xxx | EmulatedDriver):
            return emulator._chip.held(item.row.address)
        if isinstance(emulator, EmulatedTagged):
            return emulator._chip.words[item.row.address & 7]
        if isinstance(emulator, EmulatedTmc4361):
            return int(emulator._chip.r[item.row.address])
        at_s = self.clock.now()
        if self.device.model in MODULES:
            read = {Space.AXIS: 6, Space.GLOBAL_0: 10, Space.GLOBAL_2: 10, Space.GLOBAL_3: 10, Space.COORDINATE: 31}
            motor = {Space.GLOBAL_2: 2, Space.GLOBAL_3: 3}.get(item.row.space, 0)
            frame = tmcl.Request(1, read[item.row.space], item.row.address, motor).encode()
            return to_raw(tmcl.Reply.decode(emulator.exchange(frame, at_s)).value, 32)
        return int.from_bytes(emulator.exchange(datagram32.read(item.row.address), at_s)[1:], "big")


def _tapped(model: str, link: Link, clock: Clock) -> FramePort:
    options = options_of(model).model_validate({name: value for name, value in link.items() if name != "kind"})
    return EmulatorPort(cast("Wire", TappedWire(build_emulator(model, clock, options))))


@asynccontextmanager
async def bench(model: str, *, started: bool = True, **options: object) -> AsyncIterator[Bench]:
    """A connected device; `started` sets it up for motion."""
    clock = VirtualClock()
    manager = DeviceManager({"emulator": _tapped}, clock)
    device = await manager.add(DeviceConfig("Bench", model, {"kind": "emulator", **options}))
    assert device.state == "connected", device.problem
    if started:
        await set_up(device)
    try:
        yield Bench(clock, manager, device)
    finally:
        await manager.close()


async def set_up(device: Device) -> None:
    """Ready for moves, with numbers of its own in most registers."""
    if MODELS[device.model].family == "tmc428":
        start = start_ramps.AxisStart(v_max=1500, a_max=200, pulse_div=4, ramp_div=6)
        await start_ramps.start_up(device, [start] * len(device.axes))
    elif device.model == "tmc4361":
        await start_4361.start_up(
            device, start_4361.Start(vmax=50_000, amax=200_000, bow=2_000_000, counts_per_rev=40_000)
        )
    elif MODELS[device.model].spi is not None:
        values = {"DRVCONF": 0x20, "DRVCTRL": 0x204, "SMARTEN": 0x0202, "SGCSCONF": 0x514, "CHOPCONF": 0x11B5}
        for name, value in values.items():  # all, for none of them can be read
            await device.registers.write(name, None, value)
    elif MODELS[device.model].can("step_input"):
        await device.registers.write("IHOLD_IRUN", None, fields={"IRUN": 20, "IHOLD": 8})
    elif device.model not in MODULES:
        starts = [start_5xxx.Start(vmax=50_000, amax=200_000, vstart=0, irun=20, ihold=8)] * len(device.axes)
        await start_5xxx.start_up(device, starts)


# --- changes ----------------------------------------------------------------------------------------

NOT_BY_CHANCE = frozenset(
    {"sdin_mode", "step_direction_mode", "direct_mode", "stepdir1_enable", "stepdir2_enable", "single_driver"}
)
"""What hands the motor to somebody else."""


def allowed(item: Item, value: Callable[[int, int], int]) -> WriteItem:
    """A legal write of a register, each number as `value(lowest, highest)` chooses it."""
    if not item.fields:
        row = item.row
        word = to_raw(value(row.minimum, row.maximum), row.width)
        return write_of(item, word, item.mask)
    word = 0
    for part in item.fields:
        low, high = part.minimum, part.maximum
        if part.name.casefold() in NOT_BY_CHANCE:
            low = high = 0
        if part.name.casefold() in ("rm", "ramp_mode"):
            high = 1  # ramp or soft: the others are commands
        word |= to_raw(value(low, high), part.width) << part.lsb
    return write_of(item, word, item.mask)


async def change(device: Device, rng: random.Random, share: float = 1.0) -> int:
    """Write `share` of all registers by chance, in an order that a device takes; how many."""
    done = 0
    for item in items_of(device.model):
        if item.row.name in NOT_BY_CHANCE or rng.random() > share:
            continue
        write = allowed(item, rng.randint)
        if item.row.name == "START_CONF" and write.fields is not None:
            write.fields |= {f"start_en[{index}]": 0 for index in range(5)}
        with contextlib.suppress(OutOfRange):  # a module has holes in its ranges, and two ranges by its unit mode
            await device.registers.write(write.name, write.axis, write.value, write.fields)
            done += 1
    return done


def by_place(words: dict[Key, int], model: str) -> dict[str, Any]:
    """Words by readable names, for a test's failure."""
    return {item.place: hex(words[item.key]) for item in items_of(model)}
