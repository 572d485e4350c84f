"""Every module that the package lists, emulated: connected, all of its parameters written, and moved."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from app.clock import WallClock
from app.devices.core.capabilities import TmclCommands
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.manager import DeviceManager
from app.registers.listed.modules import role_of
from app.registers.model import Space
from app.registers.tmcl.commands import Status
from tests.devices.listed.harness import KINDS, NAMES, Bench, bench, far_line, on_can, row_of, writable

COMMANDS = ("target_position", "target_speed")
"""What the next command writes over: each was read back as it was written."""


async def write_all(device: Device) -> int:
    """Write every parameter of all axes, every global one and every output, each another number, and read them back
    when all are written; how many there were."""
    rows, wanted = writable(device), {}
    for number, row in enumerate(rows):
        value = number % 2 if row.range else 1000 + number
        written = await device.registers.write(row.name, row.axis, value)
        assert written.verified or row.read_clears or row.volatile, row.name
        if not row.volatile and role_of(row) not in COMMANDS:
            wanted[row.space, row.axis, row.address] = value  # of several names of one number the last one written
    held = {
        (reading.space, reading.axis, reading.address): reading.value for reading in await device.registers.read_all()
    }
    for row in rows:
        if row.read_clears:
            held[row.space, row.axis, row.address] = (await device.registers.read(row.name, row.axis)).value
    assert {key: held[key] for key in wanted} == wanted
    return len(rows)


@pytest.mark.parametrize("name", NAMES)
async def test_every_parameter_is_written_and_read_back(name: str) -> None:
    async with bench(name) as made:
        assert await write_all(made.device) == len(writable(made.device))
        held = {(reading.name, reading.axis) for reading in await made.device.registers.read_all()}
        assert held == {(row.name, row.axis) for row in made.device.family.table if not row.read_clears}


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["serial", "tcp", "can"])
@pytest.mark.parametrize("name", NAMES)
async def test_over_every_wire(name: str, kind: str, tmp_path: Path) -> None:
    manager = DeviceManager(KINDS, WallClock())
    try:
        if kind == "can":
            link = {"kind": "can", "interface": "virtual", "channel": name, "timeout_s": 10.0}
            with on_can(name, name):
                await works(await manager.add(DeviceConfig("Far", name, link)))
                await manager.close()
        else:
            with far_line(name, tmp_path / "port") as (_, (host, port)):
                link = {"kind": "tcp", "host": host, "port": port}
                if kind == "serial":
                    link = {"kind": "serial", "port": str(tmp_path / "port"), "baud": 115_200}
                await works(await manager.add(DeviceConfig("Far", name, {**link, "timeout_s": 10.0})))
                await manager.close()
    finally:
        await manager.close()


async def works(device: Device) -> None:
    assert device.state == "connected", device.problem
    await write_all(device)
    for axis in device.axes:
        await device.registers.write(row_of(device, "position", axis.index).name, axis.index, 1000)
        await device.stop(axis.index)


async def passed(made: Bench, axis: int, within_s: float = 30.0) -> int:
    """Let time pass until the axis rests; where."""
    for _ in range(int(within_s / 0.1)):
        await made.clock.advance(0.1)
        state = await made.device.monitor.axis_state(axis)
        if not state.moving:
            return state.position
    raise AssertionError("it moves on and on")


@pytest.mark.parametrize("name", NAMES)
async def test_every_axis_moves_and_stops(name: str) -> None:
    async with bench(name) as made:
        device = made.device
        for axis in (axis.index for axis in device.axes):
            started = await device.motion.move(axis, 5000)
            assert (started.from_position, started.target_position) == (0, 5000)
            assert (await device.monitor.axis_state(axis)).moving
            assert await passed(made, axis) == 5000
            await device.motion.move(axis, -2000, relative=True)
            assert await passed(made, axis) == 3000
            assert [end.reason for end in device.monitor.motion_ends(axis)] == ["target_reached"] * 2
            turning = await device.motion.rotate(axis, -500, "chip")
            assert (turning.velocity_chip, turning.warnings) == (-500, [])
            await made.clock.advance(2.0)
            state = await device.monitor.axis_state(axis)
            assert (state.velocity_pps, state.moving, state.mode) == (-500, True, "velocity")
            assert (await device.stop(axis)).ok
            await passed(made, axis)
            state = await device.monitor.axis_state(axis)
            assert (state.velocity_pps, state.mode) == (0, "hold")
            others = [other.index for other in device.axes if other.index > axis]
            assert all([(await device.monitor.axis_state(other)).position == 0 for other in others])


@pytest.mark.parametrize("name", NAMES)
async def test_every_parameter_and_port_is_a_channel(name: str) -> None:
    async with bench(name) as made:
        device = made.device
        channels = [channel.name for channel in device.telemetry.channels()]
        rows = [row for row in device.family.table if not row.read_clears and not row.when]
        assert len(channels) == len(set(channels)) == len(rows)
        for first in range(0, len(channels), 16):
            plan = device.telemetry.sample_plan(channels[first : first + 16])
            taken = await device.telemetry.take_samples(plan)
            assert plan.decode(np.array(taken.times_s), taken.replies[0]).shape == (
                1,
                len(plan.channels),
            )


@pytest.mark.parametrize("name", NAMES)
async def test_commands_by_hand(name: str) -> None:
    async with bench(name) as made:
        console = made.device.need(TmclCommands)
        row = made.row("max_speed")
        assert (await console.tmcl("SAP", row.address, 0, 321)).status == 100
        assert (await console.tmcl("GAP", row.address)).value == 321
        unknown = next(number for number in range(256) if made.device.family.table.at(number, Space.AXIS) is None)
        assert (await console.tmcl("GAP", unknown)).status == Status.WRONG_TYPE
