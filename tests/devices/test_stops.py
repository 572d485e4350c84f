"""Stops: ahead of everything, verified, and final for whatever was under way."""

from __future__ import annotations

import asyncio

import pytest

from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.manager import DeviceManager
from app.emulators.drive.documents import ChipFaultsChange
from app.emulators.tmc428.options import EmulatorPatch
from app.errors import LinkDown, LinkTimeout, WriteRefused, WrongState
from app.links.port import FramePort
from app.registers.catalog import CHIPS_32
from tests.devices.harness import START, bench, emulator_of
from tests.links.gate import GatedPort, settle

BOTH = pytest.mark.parametrize("model", list(CHIPS_32))


@BOTH
async def test_by_the_ramp(model: str) -> None:
    async with bench(model) as b:
        await b.device.motion.move(0, 1_000_000)
        await b.clock.advance(1.0)
        before = await b.device.monitor.axis_state(0)
        outcome = await b.device.stop(0)
        assert outcome.ok
        await b.clock.advance(0.01)
        assert 0 < (await b.device.monitor.axis_state(0)).velocity_pps < before.velocity_pps
        rest = await b.at_rest()
        # v^2 / 2a of the way, to a microstep or two
        assert rest - before.position == pytest.approx(before.velocity_pps**2 / 2 / 93_132.26, abs=3)
        await b.clock.advance(1.0)
        assert (await b.device.monitor.axis_state(0)).position == rest


@BOTH
@pytest.mark.sheet("DS-TMC428", "8.6")
async def test_immediately(model: str) -> None:
    async with bench(model) as b:
        await b.device.motion.rotate(0, -10_000)
        await b.clock.advance(1.0)
        before = (await b.device.monitor.axis_state(0)).position
        await b.device.stop(0, "immediate")
        await b.clock.advance(1.0)
        state = await b.device.monitor.axis_state(0)
        assert (state.position, state.velocity_pps, state.moving) == (before, 0.0, False)


@pytest.mark.sheet("DS-TMC428", "8.7")
async def test_without_acceleration_there_is_no_ramp_so_it_is_immediate() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 10_000)
        await b.clock.advance(1.0)
        await b.device.registers.write("a_max", 0, value=0)
        assert (await b.device.stop(0)).ok
        state = await b.device.monitor.axis_state(0)
        assert (state.mode, state.velocity_pps) == ("HOLD_MODE", 0.0)


async def test_a_stop_in_the_middle_of_a_move_s_preparation_ends_the_move() -> None:
    port = GatedPort()
    device = await gated_device(port)
    moving = asyncio.create_task(device.motion.move(0, 50_000))
    await settle()
    assert not moving.done()
    stopping = asyncio.create_task(device.stop(0))
    await settle()
    await port.let_through(40)
    assert (await stopping).ok
    with pytest.raises(WrongState, match="overtook"):
        await moving
    x_target = [frame for frame in port.seen if frame[0] == 0x00]
    assert x_target == []


async def test_a_move_that_waits_behind_a_stop_is_not_made_either() -> None:
    port = GatedPort()
    device = await gated_device(port)
    reading = asyncio.create_task(device.registers.read("v_max", 0))
    await settle()
    waiting = asyncio.create_task(device.motion.move(0, 50_000))
    elsewhere = asyncio.create_task(device.registers.write("v_min", 1, value=7))
    await settle()
    stopping = asyncio.create_task(device.stop(0))
    await settle()
    await port.let_through(80)
    assert (await stopping).ok
    await reading
    with pytest.raises(WrongState, match="overtook"):
        await waiting
    assert (await elsewhere).value == 7  # another axis's command is nobody's victim


async def gated_device(port: GatedPort) -> Device:
    """A TMC428 set up, whose further frames are answered one by one."""

    def factory(model: str, link: object, clock: object) -> FramePort:
        return port

    manager = DeviceManager({"gated": factory}, port.wire.clock.base)
    device = await manager.add(DeviceConfig("Gated", "tmc428", {"kind": "gated"}), connect=False)
    device.session.set_state("connected")

    async def start() -> None:
        for name, value in (("v_max", START.v_max), ("v_min", 1), ("a_max", START.a_max)):
            await device.registers.write(name, 0, value=value)
        await device.registers.write("pmul_pdiv", 0, fields={"pmul": 62, "pdiv": 6})

    starting = asyncio.create_task(start())
    while not starting.done():
        await port.let_through()
    await starting
    port.seen.clear()
    return device


async def test_a_stop_that_the_chip_does_not_take_is_reported() -> None:
    async with bench() as b:
        await b.device.motion.rotate(0, 10_000)
        b.fault(errors=0.3)
        outcome = (await b.device.stop_axes([0]))[0]
        assert not outcome.ok
        assert isinstance(outcome.problem, WriteRefused)


async def test_a_stop_is_tried_twice_on_a_silent_link() -> None:
    async with bench() as b:
        b.fault(silence=True)
        with pytest.raises(LinkTimeout):
            await b.device.stop(0)
        b.fault(silence=False)
        assert (await b.device.stop(0)).ok


async def test_everything_stops_though_one_device_is_dead() -> None:
    async with bench() as b:
        second = await b.manager.add(DeviceConfig("Second", "tmc4210", {"kind": "emulator"}))
        third = await b.manager.add(DeviceConfig("Third", "tmc4210", {"kind": "emulator"}), connect=False)
        for axis in range(3):
            await b.device.motion.rotate(axis, 5000)
        await b.clock.advance(0.5)
        emulator_of(second).patch(EmulatorPatch(faults=ChipFaultsChange(unplugged=True)))
        outcomes = await b.manager.stop_all()
        by_axis = {(outcome.device, outcome.axis): outcome for outcome in outcomes}
        assert [by_axis["bench", axis].ok for axis in range(3)] == [True] * 3
        assert isinstance(by_axis["second", 0].problem, LinkDown)
        assert isinstance(by_axis["third", 0].problem, WrongState)
        assert third.state == "disconnected"
        assert all(outcome.took_ms >= 0 for outcome in outcomes)
        assert all([await b.at_rest(axis) for axis in range(3)])
