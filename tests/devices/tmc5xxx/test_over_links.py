"""The driver over every way to a chip that there is, in real time: what it does over one it does over all."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import cast

import pytest

from app.clock import Clock, WallClock
from app.devices.core.capabilities import EventLog, PositionSetting
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.core.results import AxisMove
from app.devices.manager import DeviceManager
from app.devices.tmc5xxx.start_up import Start, start_up
from app.emulators.board.build import build_board
from app.emulators.drive.documents import ChipFaultsChange
from app.emulators.line.line import Line
from app.emulators.line.pty import PtyEnd
from app.emulators.line.server import LineServer
from app.emulators.line.uart import uart_line
from app.emulators.server import serve_tcp
from app.emulators.tmc5xxx import EmulatedTmc5xxx, Tmc5xxxModel, Tmc5xxxOptions, Tmc5xxxPatch
from app.errors import LinkError
from app.links.emulator import EmulatorPort
from app.links.port import FramePort
from app.links.registry import Link, PortFactory, board_factory, tcp_factory, uart_factory
from app.links.spidev_port import SpidevPort
from app.registers.tmc5xxx.table import AXES
from app.telemetry.sampling import Sampling
from tests.links.test_chains import SpiThatIsAChip

WITHIN_S = 30.0
VACTUAL = 0x22
START = Start(vmax=50_000, amax=400_000)


def chip(model: str, clock: Clock) -> EmulatedTmc5xxx:
    return EmulatedTmc5xxx(cast("Tmc5xxxModel", model), clock, Tmc5xxxOptions(motor="rigid"))


def emulator_port(model: str, link: Link, clock: Clock) -> FramePort:
    del link
    return EmulatorPort(chip(model, clock))


def spi_port(model: str, link: Link, clock: Clock) -> FramePort:
    del link
    far = chip(model, clock)
    return SpidevPort(0, 0, frame_bytes=5, clock=clock, make=lambda: SpiThatIsAChip(far))


KINDS: Mapping[str, PortFactory] = {
    "emulator": emulator_port,
    "spidev": spi_port,
    "tcp": tcp_factory,
    "landungsbruecke": board_factory,
    "uart": uart_factory,
}
WAYS = (
    ("emulator", "tmc5031"),
    ("spidev", "tmc5130"),
    ("tcp", "tmc5160"),
    ("landungsbruecke", "tmc5072"),
    ("landungsbruecke", "tmc5160"),
    ("uart", "tmc5062"),
    ("uart", "tmc5072"),
    ("uart", "tmc5130"),
)


@contextmanager
def served(line: Line, path: Path) -> Iterator[str]:
    """`line` on a pseudo-terminal: its port."""
    with LineServer(line, [PtyEnd(path)]) as server:
        serving = threading.Thread(target=server.run)
        serving.start()
        yield str(path)
        server.stop()
        serving.join()


@contextmanager
def peer(kind: str, model: str, path: Path) -> Iterator[dict[str, object]]:
    """What a link of that kind to an emulated chip is made of, besides TCP, which an event loop serves."""
    link: dict[str, object] = {"kind": kind}
    clock = WallClock()
    if kind == "landungsbruecke":
        with served(Line([build_board(model, clock, {"motor": "rigid"})], clock, addresses=(1,)), path) as port:
            yield link | {"port": port, "timeout_s": WITHIN_S}
    elif kind == "uart":
        with served(uart_line([chip(model, clock)], clock, echo=True), path) as port:
            yield link | {"port": port, "timeout_s": WITHIN_S}
    else:
        yield link


@pytest.fixture(params=WAYS, ids=" ".join)
async def device(request: pytest.FixtureRequest, tmp_path: Path) -> AsyncIterator[Device]:
    kind, model = cast("tuple[str, str]", request.param)
    server: asyncio.Server | None = None
    with peer(kind, model, tmp_path / "tty") as link:
        if kind == "tcp":
            server = await serve_tcp(chip(model, WallClock()), "127.0.0.1", 0)
            link |= {"host": "127.0.0.1", "port": server.sockets[0].getsockname()[1], "timeout_s": WITHIN_S}
        manager = DeviceManager(KINDS, WallClock())
        try:
            yield await manager.add(DeviceConfig("far", model, link))
        finally:
            await manager.close()
            if server is not None:
                server.close()
                await server.wait_closed()


async def reached(device: Device, register: str, axis: int, value: int) -> None:
    until_s = time.monotonic() + WITHIN_S
    while (await device.registers.read(register, axis)).value != value:
        assert time.monotonic() < until_s, f"{register} never is {value}"


async def test_it_starts_up_moves_arrives_and_stops(device: Device) -> None:
    assert device.state == "connected", device.problem
    axes = AXES[device.model]
    await start_up(device, [START] * axes)
    started = await device.motion.move_together([AxisMove(axis, 5_000 * (1 - 2 * axis)) for axis in range(axes)])
    assert [move.warnings for move in started] == [[]] * axes
    for axis in range(axes):
        await reached(device, "XACTUAL", axis, 5_000 * (1 - 2 * axis))
    last = axes - 1
    rotating = await device.motion.rotate(last, -20_000)
    await reached(device, "VACTUAL", last, rotating.velocity_chip)
    assert (await device.stop(last)).ok
    await reached(device, "VACTUAL", last, 0)
    assert (await device.monitor.axis_state(last)).mode == "velocity"
    names = [name for entry in device.need(EventLog).events(last).events for name in entry.names]
    assert names[0] == "reset"
    assert "event_pos_reached" in names


async def test_what_cannot_be_read_is_known_to_have_arrived(device: Device) -> None:
    for value in (0, 1, 65_535):
        written = await device.registers.write("AMAX", 0, value)
        assert (written.value, written.verified) == (value, True)
        assert "arrived" in written.note
    for value in (-(2**31), -1, 0, 2**31 - 1):
        assert (await device.registers.write("XTARGET", 0, value)).value == value


async def test_samples_come_with_numbers(device: Device) -> None:
    await device.need(PositionSetting).set_position(0, 1_234)
    names = ["position.0", "velocity.0", "switch_left.0", "mscnt.0"]
    failures: list[Exception] = []
    sampling = Sampling(device, names, 100.0, WallClock(), failures.append)
    try:
        until_s = time.monotonic() + WITHIN_S
        while True:
            await asyncio.sleep(0.02)
            if device.session.sampling_port is not None:
                device.session.sampling_port.run_due_samples()
            block = sampling.take()
            assert not failures
            if len(block.time_s):
                break
            assert time.monotonic() < until_s
    finally:
        sampling.end()
    assert block.samples[-1][:2].tolist() == [1_234, 0]


async def test_a_stop_goes_out_over_a_uart_that_answers_nothing(tmp_path: Path) -> None:
    clock = WallClock()
    far = chip("tmc5130", clock)
    with served(uart_line([far], clock, echo=True), tmp_path / "tty") as port:
        manager = DeviceManager(KINDS, clock)
        link = {"kind": "uart", "port": port, "timeout_s": 1.0}
        device = await manager.add(DeviceConfig("far", "tmc5130", link))
        try:
            await start_up(device, [START])
            rotating = await device.motion.rotate(0, 20_000)
            await reached(device, "VACTUAL", 0, rotating.velocity_chip)
            far.patch(Tmc5xxxPatch(faults=ChipFaultsChange(silence=True)))
            outcome = (await device.stop_axes([0]))[0]
            assert isinstance(outcome.problem, LinkError)
            until_s = time.monotonic() + WITHIN_S
            while far.read(VACTUAL):  # past the wire
                assert time.monotonic() < until_s, "the motor still turns"
                await asyncio.sleep(0.01)
        finally:
            far.patch(Tmc5xxxPatch(faults=ChipFaultsChange(silence=False)))
            await manager.close()
