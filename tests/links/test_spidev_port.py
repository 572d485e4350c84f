"""The SPI bus of this machine: options, and honest words where module, device or rights are missing.

Frames over it: test_chains.py, through a loop that ends in an emulated chip."""

from __future__ import annotations

import asyncio
import errno
import os
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from types import ModuleType
from typing import cast

import pytest

from app.clock import VirtualClock
from app.devices.core.config import DeviceConfig
from app.devices.core.register_file import RegisterFile
from app.devices.manager import DeviceManager
from app.emulators.build import build_emulator
from app.emulators.tmc428.device import EmulatedDevice
from app.emulators.tmc428.options import EmulatorOptions
from app.errors import BadReply, LinkDown, OutOfRange, UnknownThing, UsageError
from app.links import datagram40
from app.links.registry import spidev_factory
from app.links.spidev_port import SpidevPort

MODEL = "tmc4361"


def port(**options: object) -> SpidevPort:
    return cast("SpidevPort", spidev_factory(MODEL, {"kind": "spidev", **options}, VirtualClock()))


class Spi:
    """What spidev offers, with its output bent back to its input."""

    def __init__(self, refuse: int = 0) -> None:
        self.max_speed_hz = 0
        self.mode = 0
        self.bits_per_word = 0
        self.opened: tuple[int, int] | None = None
        self.closed = 0
        self.answer: Callable[[list[int]], bytes] = bytes
        self.refuse = refuse

    def open(self, bus: int, device: int) -> None:
        if self.refuse:
            raise OSError(self.refuse, os.strerror(self.refuse))
        self.opened = bus, device

    def xfer2(self, values: list[int]) -> list[int]:
        if self.refuse:
            raise OSError(self.refuse, os.strerror(self.refuse))
        return list(self.answer(values))

    def close(self) -> None:
        self.closed += 1


def looped(spi: Spi) -> SpidevPort:
    return SpidevPort(1, 2, frame_bytes=5, speed_hz=4_000_000, make=lambda: spi)


def test_options() -> None:
    plain = port(bus=0, device=1)
    assert (plain.name, plain.speed_hz, plain.mode, plain.frame_bytes) == ("spidev 0.1", 1_000_000, 3, 5)
    assert plain.traits.chains is plain
    other = port(bus=1, device=0, speed_hz=4_000_000, mode=0)
    assert (other.speed_hz, other.mode) == (4_000_000, 0)


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({}, OutOfRange),
        ({"bus": 0}, OutOfRange),
        ({"bus": "0", "device": 0}, OutOfRange),
        ({"bus": -1, "device": 0}, OutOfRange),
        ({"bus": 0, "device": 0, "speed_hz": 0}, OutOfRange),
        ({"bus": 0, "device": 0, "speed_hz": 100_000_000}, OutOfRange),
        ({"bus": 0, "device": 0, "mode": 4}, OutOfRange),
        ({"bus": 0, "device": 0, "baud": 9600}, UnknownThing),
    ],
)
def test_options_that_cannot_be(options: dict[str, object], error: type[Exception]) -> None:
    with pytest.raises(error):
        port(**options)


def test_a_module_has_no_such_link() -> None:
    with pytest.raises(UsageError, match="a pd42-1241 has no spidev link"):
        spidev_factory("pd42-1241", {"kind": "spidev", "bus": 0, "device": 0}, VirtualClock())


@pytest.mark.parametrize(
    ("model", "fastest_hz"), [("tmc428", 2_000_000), ("tmc429", 4_000_000), ("tmc4210", 4_000_000)]
)
def test_a_chip_of_32_bit_datagrams_is_asked_no_faster_than_it_answers(model: str, fastest_hz: int) -> None:
    """An eighth of its fastest clock: the answer is valid four clocks after the falling edge."""
    link = {"kind": "spidev", "bus": 0, "device": 0, "speed_hz": fastest_hz}
    made = cast("SpidevPort", spidev_factory(model, link, VirtualClock()))
    assert (made.frame_bytes, made.speed_hz, made.traits.chains) == (4, fastest_hz, None)
    with pytest.raises(OutOfRange):
        spidev_factory(model, {**link, "speed_hz": fastest_hz + 1}, VirtualClock())


@pytest.mark.sheet("DS-TMC428", "6.2")
@pytest.mark.parametrize("model", ["tmc428", "tmc429", "tmc4210"])
async def test_a_chip_of_32_bit_datagrams_at_the_bus_is_driven_like_any_other(
    model: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The driver over the real port; only `spidev.SpiDev` is not the kernel's: its peer is an emulated chip."""
    clock = VirtualClock()
    chip = cast("EmulatedDevice", build_emulator(model, clock, EmulatorOptions()))
    spi = Spi()
    spi.answer = lambda values: chip.exchange(bytes(values))
    module = ModuleType("spidev")
    vars(module)["SpiDev"] = lambda: spi
    monkeypatch.setitem(sys.modules, "spidev", module)
    manager = DeviceManager({"spidev": spidev_factory}, clock)
    device = await manager.add(DeviceConfig("chip", model, {"kind": "spidev", "bus": 1, "device": 2}))
    try:
        assert device.state == "connected", device.problem
        registers = device.part(RegisterFile)
        assert registers is not None
        written = await registers.write("V_MAX" if model == "tmc4210" else "v_max", 0, 1234)
        assert (written.value, written.verified) == (1234, True)
        assert (spi.mode, spi.max_speed_hz, spi.bits_per_word) == (3, 1_000_000, 8)
    finally:
        await manager.close()


@pytest.mark.sheet("DS-TMC4361", "5.2")
async def test_the_bus_is_set_up_once_and_frames_go_one_by_one() -> None:
    spi = Spi()
    far = looped(spi)
    frames = datagram40.read_chain([0x21, 0x22])
    assert await far.exchange_chain(frames) == list(frames)
    assert await far.exchange(frames[0]) == frames[0]
    assert far.traits.cuts
    assert await far.exchange(datagram40.STATUS_FRAME) == datagram40.STATUS_FRAME
    assert (spi.opened, spi.max_speed_hz, spi.mode, spi.bits_per_word) == ((1, 2), 4_000_000, 3, 8)
    await far.aclose()
    await far.aclose()
    assert spi.closed == 1
    assert await far.exchange(frames[0]) == frames[0], "and opens again"


async def test_without_the_module(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "spidev", None)
    with pytest.raises(LinkDown, match=r"pip install 'stepscope\[spidev\]'"):
        await port(bus=0, device=0).exchange(datagram40.FETCH)


async def test_without_the_device() -> None:
    pytest.importorskip("spidev")  # the real one; on a machine without SPI bus 250
    with pytest.raises(LinkDown, match=r"no /dev/spidev250\.0: is SPI switched on"):
        await port(bus=250, device=0).exchange(datagram40.FETCH)


@pytest.mark.parametrize(
    ("number", "words"), [(errno.EACCES, "permission denied for /dev/spidev1.2"), (errno.EBUSY, "busy")]
)
async def test_a_device_that_cannot_be_opened(number: int, words: str) -> None:
    spi = Spi(number)
    with pytest.raises(LinkDown, match=words):
        await looped(spi).exchange(datagram40.FETCH)
    assert spi.closed == 1


async def test_a_device_that_goes_away() -> None:
    spi = Spi()
    far = looped(spi)
    await far.exchange(datagram40.FETCH)
    spi.refuse = errno.ENODEV
    with pytest.raises(LinkDown):
        await far.exchange(datagram40.FETCH)
    assert spi.closed == 1
    spi.refuse = 0
    assert await far.exchange(datagram40.FETCH) == datagram40.FETCH


async def test_a_reply_of_another_length() -> None:
    spi = Spi()
    spi.answer = lambda values: bytes(values[:-1])
    with pytest.raises(BadReply, match="4 bytes instead of 5"):
        await looped(spi).exchange(datagram40.FETCH)


async def test_whoever_comes_after_a_cancelled_one_waits_for_its_frames() -> None:
    spi, entered, release = Spi(), threading.Event(), threading.Event()
    log: list[bytes] = []

    def slow(values: list[int]) -> bytes:
        log.append(bytes(values))
        entered.set()
        release.wait(20)
        return bytes(values)

    spi.answer = slow
    far = looped(spi)
    first = asyncio.create_task(far.exchange_chain(datagram40.read_chain([1, 2])))
    await asyncio.to_thread(entered.wait, 20)
    first.cancel()
    second = asyncio.create_task(far.exchange(datagram40.read(3)))
    await asyncio.sleep(0.01)
    assert len(log) == 1
    release.set()
    with pytest.raises(asyncio.CancelledError):
        await first
    assert await second == datagram40.read(3)
    assert [frame[0] for frame in log] == [1, 2, 0x7F, 3]


async def test_it_waits_for_nobody_who_keeps_the_threads_that_all_share() -> None:
    shared, release = ThreadPoolExecutor(1), threading.Event()
    asyncio.get_running_loop().set_default_executor(shared)
    other = asyncio.create_task(asyncio.to_thread(release.wait, 20))
    far = looped(Spi())
    try:
        assert await asyncio.wait_for(far.exchange(datagram40.FETCH), 10) == datagram40.FETCH
    finally:
        release.set()
        await other
    await far.aclose()
