"""The driver over every way to a chip that there is, in real time: what it does over one it does over all."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator, Mapping

import pytest

from app.clock import Clock, WallClock
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.manager import DeviceManager
from app.devices.tmc4361.start_up import start_up
from app.emulators.server import serve_tcp
from app.emulators.tmc4361 import EmulatedTmc4361
from app.links.emulator import EmulatorPort
from app.links.port import FramePort
from app.links.registry import Link, PortFactory, board_factory, tcp_factory
from app.links.spidev_port import SpidevPort
from tests.devices.tmc4361.harness import START
from tests.links.test_chains import SpiThatIsAChip
from tests.peers.board import board, shared_board
from tests.peers.emulator_process import EmulatorProcess

__all__ = ["board", "shared_board"]
WITHIN_S = 30.0


def emulator_port(model: str, link: Link, clock: Clock) -> FramePort:
    del model, link
    return EmulatorPort(EmulatedTmc4361(clock))


def spi_port(model: str, link: Link, clock: Clock) -> FramePort:
    del model, link
    chip = EmulatedTmc4361(clock)
    return SpidevPort(0, 0, frame_bytes=5, clock=clock, make=lambda: SpiThatIsAChip(chip))


KINDS: Mapping[str, PortFactory] = {
    "emulator": emulator_port,
    "spidev": spi_port,
    "tcp": tcp_factory,
    "landungsbruecke": board_factory,
}


@pytest.fixture(params=[*KINDS])
async def device(request: pytest.FixtureRequest) -> AsyncIterator[Device]:
    kind = str(request.param)
    link: dict[str, object] = {"kind": kind}
    server: asyncio.Server | None = None
    if kind == "tcp":
        server = await serve_tcp(EmulatedTmc4361(WallClock()), "127.0.0.1", 0)
        link |= {"host": "127.0.0.1", "port": server.sockets[0].getsockname()[1], "timeout_s": WITHIN_S}
    elif kind == "landungsbruecke":
        process: EmulatorProcess = request.getfixturevalue("board")
        link |= {"port": str(process.pty), "timeout_s": WITHIN_S}
    elif kind == "spidev":
        link |= {"bus": 0, "device": 0}
    manager = DeviceManager(KINDS, WallClock())
    try:
        yield await manager.add(DeviceConfig("far", "tmc4361", link))
    finally:
        await manager.close()
        if server is not None:
            server.close()
            await server.wait_closed()


async def reached(device: Device, register: str, value: int) -> None:
    until_s = time.monotonic() + WITHIN_S
    while (await device.registers.read(register, 0)).value != value:
        assert time.monotonic() < until_s, f"{register} never is {value}"


async def test_it_starts_up_moves_arrives_and_stops(device: Device) -> None:
    assert device.state == "connected", device.problem
    await start_up(device, START)
    await device.motion.move(0, 5000)
    await reached(device, "XACTUAL", 5000)
    assert (await device.registers.read("XTARGET", 0)).value == 5000
    await device.motion.rotate(0, -20_000)
    await reached(device, "VACTUAL", -20_000)
    assert (await device.stop(0)).ok
    await reached(device, "VACTUAL", 0)


async def test_what_is_written_is_compared_with_what_is_held(device: Device) -> None:
    for value in (-(2**31), -1, 0, 2**31 - 1):
        assert (await device.registers.write("POS_COMP", 0, value)).value == value
