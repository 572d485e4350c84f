"""Another chip answers than the connection says: it is read, and stopped where it can be, and nothing else goes out."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from typing import Any

import pytest

from app.clock import Clock, ScaledClock, VirtualClock
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.core.results import StopMode, WriteItem
from app.devices.families import make_device
from app.devices.manager import DeviceChange, DeviceManager
from app.emulators.build import build_emulator
from app.errors import LinkDown, OtherModel
from app.links import datagram32, datagram40
from app.links.access32 import Spi32Access
from app.links.emulator import EmulatorPort
from app.links.port import FramePort, Wire
from app.links.queue import Priority
from app.links.register_access import Spi40Access
from app.links.registry import Link
from app.links.tmcl import Reply, Request, is_retriable
from app.registers.tmcl.commands import Opcode
from tests.devices.tmcl.harness import state_of

SIXPOINT = ("tmc5031", "tmc5062", "tmc5072", "tmc5130", "tmc5160")
SAME_VERSION = {"tmc5031", "tmc5062"}
PAIRS = [
    *((said, real) for said in SIXPOINT for real in SIXPOINT if said != real and {said, real} != SAME_VERSION),
    *((said, "tmc4361") for said in SIXPOINT),
    *(("tmc4361", real) for real in ("tmc5072", "tmc5130", "tmc5160")),
    ("tmc428", "tmc4210"),
    ("tmc428", "tmc429"),
    ("tmc429", "tmc428"),
]
TURNING: dict[str, dict[str, int]] = {
    **{model: {"AMAX": 500} for model in SIXPOINT},
    "tmc4361": {"AMAX": 4_000_000, "DMAX": 4_000_000},
    **{
        model: {"v_max": 1500, "a_max": 200, "pulse_div": 4, "ramp_div": 6} for model in ("tmc428", "tmc429", "tmc4210")
    },
}
"""What an axis takes to turn, beside the command."""
SPI40, SPI32 = Spi40Access(), Spi32Access()


@dataclass
class Tap:
    """The wire of the chip that is really there; notes the frames that write."""

    wire: Wire
    wrote: list[bytes] = field(default_factory=list)
    unplugged: bool = False

    @property
    def model(self) -> str:
        return self.wire.model

    @property
    def clock(self) -> ScaledClock:
        return self.wire.clock

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        if self.unplugged:
            raise ConnectionError("unplugged")
        reads = {4: SPI32.is_read, 5: SPI40.is_read, 9: is_retriable}[len(frame)]
        if not reads(frame):
            self.wrote.append(frame)
        return self.wire.exchange(frame, at_s)


class OtherModule:
    """A module that calls itself by another number, and does what it is told."""

    model = "pd42-1241"

    def __init__(self, clock: Clock) -> None:
        self.clock = ScaledClock(clock)

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        del at_s
        request = Request.decode(frame)
        value = 1161 << 16 | 0x0122 if request.opcode == Opcode.GET_VERSION else 0
        return Reply(2, request.address, 100, request.opcode, value).encode()


@dataclass
class Swapped:
    clock: VirtualClock
    manager: DeviceManager
    device: Device
    tap: Tap


@asynccontextmanager
async def swapped(said: str, real: str) -> AsyncIterator[Swapped]:
    """A connection of a `said` at whose end a `real` answers."""
    clock = VirtualClock()
    tap = Tap(OtherModule(clock) if real == "module 1161" else build_emulator(real, clock))

    def port(model: str, link: Link, clock: Clock) -> FramePort:
        del model, link, clock
        return EmulatorPort(tap)

    manager = DeviceManager({"spidev": port}, clock)
    device = await manager.add(DeviceConfig("Bench", said, {"kind": "spidev"}))
    try:
        yield Swapped(clock, manager, device, tap)
    finally:
        await manager.close()


def _register(device: Device) -> str:
    return next(
        row.name
        for row in device.family.table
        if row.access.readable and row.access.writable and row.axis == 0 and not row.fields and row.maximum > 100
    )


def _frame(device: Device) -> bytes:
    if device.family.kind == "module":
        return Request(1, Opcode.SAP, 4, 0, 1).encode()
    if device.family.datagram_bits == 40:
        return datagram40.write(0x27, 1)
    return datagram32.write(0x05, 1)


async def _batch(device: Device) -> None:
    done = await device.registers.write_many([WriteItem(_register(device), 0, 1)])
    assert done.done == []
    if done.failed is not None:
        raise done.failed


WRITES: dict[str, Callable[[Device], Coroutine[Any, Any, object]]] = {
    "write": lambda device: device.registers.write(_register(device), 0, 1),
    "batch": _batch,
    "raw": lambda device: device.raw.exchange(_frame(device)),
    "move": lambda device: device.motion.move(0, 1000),
    "rotate": lambda device: device.motion.rotate(0, 1000),
}


@pytest.mark.parametrize(("said", "real"), [*PAIRS, ("pd42-1241", "module 1161")])
async def test_nothing_is_written_to_another_chip(said: str, real: str) -> None:
    async with swapped(said, real) as made:
        device = made.device
        assert state_of(device) == "failed"
        assert isinstance(device.problem, OtherModel)
        assert device.problem.way_out
        assert (real in device.problem.found) is (real != "module 1161")
        for name, write in WRITES.items():
            with pytest.raises(OtherModel):
                await write(device)
            assert made.tap.wrote == [], name
        await made.clock.advance(5.0)
        assert made.tap.wrote == []
        assert state_of(device) == "failed"


@pytest.mark.parametrize(
    ("said", "real", "mode"),
    [
        *((*pair, "ramp") for pair in PAIRS),
        *((*pair, "immediate") for pair in (("tmc5130", "tmc4361"), ("tmc4361", "tmc5160"), ("tmc5130", "tmc5072"))),
    ],
)
async def test_a_stop_stops_every_axis_of_the_chip_that_is_there(said: str, real: str, mode: StopMode) -> None:
    async with swapped(said, real) as made:
        problem = made.device.problem
        assert isinstance(problem, OtherModel)
        assert problem.foreign is ("tmc4361" in (said, real))
        its_own = make_device(
            "own", DeviceConfig("Own", real, {"kind": "spidev"}), made.device.session.port, made.clock
        )
        await its_own.identify()
        its_own.session.set_state("connected")
        await its_own.identity.refresh()
        for axis in its_own.axes:
            for name, value in TURNING[real].items():
                await its_own.registers.write(name, axis.index, value)
            await its_own.motion.rotate(axis.index, 2000)
        await made.clock.advance(0.5)
        assert all([(await its_own.monitor.axis_state(axis.index)).velocity_pps > 0 for axis in its_own.axes])
        outcomes = await made.manager.stop_all(mode)
        assert [(outcome.axis, outcome.ok) for outcome in outcomes] == [(axis.index, True) for axis in made.device.axes]
        await made.clock.advance(2.0)
        assert [(await its_own.monitor.axis_state(axis.index)).velocity_pps for axis in its_own.axes] == [0] * len(
            its_own.axes
        )
        assert isinstance(made.device.problem, OtherModel)


@pytest.mark.parametrize(("said", "real"), [("tmc4361", "tmc5031"), ("tmc4361", "tmc5062")])
async def test_a_chip_that_nobody_knows_is_sent_no_stop_and_that_is_said(said: str, real: str) -> None:
    async with swapped(said, real) as made:
        assert isinstance(made.device.problem, OtherModel)
        assert "cut its power" in made.device.problem.way_out
        outcomes = await made.manager.stop_all()
        assert made.tap.wrote == []
        assert [outcome.problem for outcome in outcomes] == [made.device.problem]


async def test_a_stop_that_the_other_chip_does_not_get_is_no_success() -> None:
    async with swapped("tmc5130", "tmc4361") as made:
        made.tap.unplugged = True
        (outcome,) = await made.manager.stop_all()
        assert not outcome.ok
        assert isinstance(outcome.problem, LinkDown)


@pytest.mark.parametrize(("said", "real"), PAIRS)
async def test_changing_the_model_is_the_way_out(said: str, real: str) -> None:
    async with swapped(said, real) as made:
        device = await made.manager.edit(made.device.id, DeviceChange(model=real))
        assert (device.model, state_of(device)) == (real, "connected"), device.problem
        assert device.id == "bench"
        await device.registers.write(_register(device), 0, 1)


async def test_a_link_that_fails_and_comes_back_does_not_forget_who_is_there() -> None:
    async with swapped("tmc5130", "tmc5160") as made:
        made.tap.unplugged = True
        await made.clock.advance(3.0)
        made.tap.unplugged = False
        await made.device.registers.read("GCONF")
        assert state_of(made.device) == "failed"
        with pytest.raises(OtherModel):
            await made.device.motion.move(0, 1000)
        assert made.tap.wrote == []


async def test_frames_are_judged_at_the_queue() -> None:
    """Whoever has the queue: a procedure, a table, a profile."""
    async with swapped("tmc5130", "tmc5160") as made:
        queue = made.device.session.queue
        with pytest.raises(OtherModel):
            await queue.exchange(datagram40.write(0x27, 0))
        with pytest.raises(OtherModel):
            await queue.exchange_many([datagram40.read(0x27), datagram40.write(0x27, 0)], Priority.SAMPLE)
        assert made.tap.wrote == []
