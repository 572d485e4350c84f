"""Every chip that the package lists, emulated: connected over each of its wires, all of its registers written."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import cast

import numpy as np
import pytest

from app.clock import VirtualClock, WallClock
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.manager import DeviceManager
from app.emulators.build import build_emulator
from app.emulators.line.line import Line
from app.emulators.line.uart import uart_line
from app.emulators.listed.board import PlainBoard
from app.emulators.listed.chip import PlainChip
from app.emulators.server import serve_tcp
from app.errors import UnreadableModel
from app.links.port import FramePort
from app.links.registry import Link, board_factory, tcp_factory, uart_factory
from app.links.spi_datagram import frame_bytes_of
from app.links.spidev_port import SpidevPort
from app.registers import catalog
from app.registers.model import Access, Register
from app.registers.spi_format import TaggedFormat
from tests.devices.listed.chip_harness import Bench, bench
from tests.peers.served_line import served

LISTED = [model.name for model in catalog.listings() if model.kind == "chip"]


def readable(name: str) -> bool:
    try:
        catalog.find_model(name)
    except UnreadableModel:
        return False
    return True


NAMES = [name for name in LISTED if readable(name)]
WIRES = [
    (name, wire)
    for name in NAMES
    for wire in ("tcp", "spidev", "uart", "landungsbruecke")
    if wire in catalog.find_model(name).wires
]


def writable(device: Device) -> list[Register]:
    return [row for row in device.family.table if row.access.writable and not row.when]


def value_for(row: Register) -> int:
    """Something that the register takes: with every field in its range, no flag that a written 1 would clear."""
    parts = [part for part in row.fields if part.access.writable and not part.when] if row.fields else []
    if not parts:
        return min(row.maximum, 37 + row.address)
    word = 0
    for part in parts:
        if part.access is not Access.R_W1C:
            word = part.pack(min(part.maximum, 1 + row.address % 3), word)
    return row.decode(word)


async def write_all(device: Device, rows: list[Register], chip: PlainChip) -> None:
    """Write and read back, or where nothing can be read ask the emulated chip; what moves an axis counts itself on."""
    for row in rows:
        value = value_for(row)
        if row.access is Access.R_W1C:
            value = 0
        done = await device.registers.write(row.name, row.axis, value)
        if not row.access.readable:
            assert row.decode(chip.held(row.address)) == value, row.name
            continue
        if row.read_clears:  # which a write does not read
            assert (await device.registers.read(row.name, row.axis)).value == value, row.name
            continue
        assert done.verified or row.volatile, (row.name, done.note)
        held = (await device.registers.read(row.name, row.axis)).value
        assert held == value or row.volatile, row.name


@pytest.mark.parametrize("name", NAMES)
async def test_every_register_is_written_and_read_back(name: str) -> None:
    async with bench(name) as made:
        rows = writable(made.device)
        assert rows
        await write_all(made.device, rows, made.chip)
        held = {(reading.name, reading.axis) for reading in await made.device.registers.read_all()}
        assert held == {
            (row.name, row.axis)
            for row in made.device.family.table
            if row.access.readable and not row.read_clears and not row.when
        }


@pytest.mark.parametrize("name", NAMES)
async def test_every_register_and_field_is_a_channel(name: str) -> None:
    async with bench(name) as made:
        channels = [channel.name for channel in made.device.telemetry.channels()]
        if isinstance(made.device.family.spi, TaggedFormat):
            assert not channels  # reading a status of it writes
            return
        plan = made.device.telemetry.sample_plan(channels)
        taken = await made.device.telemetry.take_samples(plan)
        columns = plan.decode(np.asarray(taken.times_s), taken.replies[0])
        assert columns.shape == (1, len(channels))
        assert np.isfinite(columns).all()


@pytest.mark.parametrize("name", [name for name in NAMES if catalog.find_model(name).can("motion")])
async def test_every_ramp_generator_moves_rotates_and_stops(name: str) -> None:
    async with bench(name) as made:
        for axis in range(len(made.device.axes)):
            await moves(made, axis)


async def moves(made: Bench, axis: int) -> None:
    device = made.device
    await device.motion.move(axis, 1000)
    await made.clock.advance(10.0)
    state = await device.monitor.axis_state(axis)
    assert (state.position, state.position_reached) == (1000, True)
    await device.motion.rotate(axis, -300, "chip")
    await made.clock.advance(5.0)
    assert (await device.monitor.axis_state(axis)).velocity_pps == -300
    (stopped,) = await device.motion.stop_axes([axis], "ramp")
    assert stopped.problem is None
    await made.clock.advance(5.0)
    assert not (await device.monitor.axis_state(axis)).moving


@pytest.mark.parametrize(("name", "wire"), WIRES)
async def test_over_every_wire(name: str, wire: str, tmp_path: Path) -> None:
    """Every register of every chip."""
    async with peer(name, wire, tmp_path) as (device, chip):
        assert device.state == "connected", device.problem
        await write_all(device, writable(device), chip)


@asynccontextmanager
async def peer(name: str, wire: str, folder: Path) -> AsyncIterator[tuple[Device, PlainChip]]:
    """A chip on that wire, and the device that speaks to it."""
    clock = WallClock()
    chip = cast("PlainChip", build_emulator(name, clock))
    manager = DeviceManager({"spidev": lambda *_: wired(chip), "tcp": tcp_factory, "uart": uart_factory,
                             "landungsbruecke": board_factory}, clock)  # fmt: skip
    try:
        if wire == "spidev":
            yield await manager.add(DeviceConfig("Far", name, {"kind": "spidev", "bus": 0, "device": 0})), chip
            await manager.close()
        elif wire == "tcp":
            server = await serve_tcp(chip, "127.0.0.1", 0)
            async with server:
                port = server.sockets[0].getsockname()[1]
                over: Link = {"kind": "tcp", "host": "127.0.0.1", "port": port}
                yield await manager.add(DeviceConfig("Far", name, over)), chip
                await manager.close()
        else:
            on_line = uart_line([chip], clock, echo=True) if wire == "uart" else board_line(chip, clock)
            with served(on_line, folder / "port"):
                link: Link = {"kind": wire, "port": str(folder / "port"), "timeout_s": 10.0}
                yield await manager.add(DeviceConfig("Far", name, link)), chip
                await manager.close()
    finally:
        await manager.close()


def board_line(chip: PlainChip, clock: WallClock) -> Line:
    return Line([PlainBoard(chip)], clock, addresses=(catalog.find_model(chip.model).slot.module,))


def wired(chip: PlainChip) -> FramePort:
    """The port of an SPI bus whose device is the emulated chip: its bytes, where the kernel would send them."""

    class Bus:
        max_speed_hz = mode = bits_per_word = 0

        def open(self, bus: int, device: int) -> None: ...

        def xfer2(self, values: list[int]) -> list[int]:
            return list(chip.exchange(bytes(values)))

        def close(self) -> None: ...

    return SpidevPort(0, 0, frame_bytes=frame_bytes_of(chip.model), make=Bus)


async def test_a_power_cycle_forgets_and_an_address_without_a_register_reads_zero() -> None:
    chip = cast("PlainChip", build_emulator(NAMES[0], VirtualClock()))
    row = next(row for row in catalog.find_model(NAMES[0]).table if row.access.writable)
    chip.write(row.address, 1)
    assert chip.read(row.address) == 1
    assert chip.read(0x7E0) == 0
    chip.write(0x7E0, 5)
    assert chip.read(0x7E0) == 0
