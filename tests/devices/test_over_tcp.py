"""The drivers over a real socket: the same chip, as hardware would answer."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import cast

import numpy as np
import pytest

from app.clock import VirtualClock, WallClock
from app.devices.core.capabilities import PositionSetting
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.core.events import StateChanged
from app.devices.manager import DeviceChange, DeviceManager
from app.devices.tmc428.start_up import AxisStart, start_up
from app.emulators.build import build_emulator
from app.emulators.tmc428.device import EmulatedDevice
from app.errors import LinkDown, LinkError, LinkTimeout
from app.registers.catalog import CHIPS_32
from tests.devices.harness import KINDS, START, state_of
from tests.links.server import Server, serving


@asynccontextmanager
async def remote(model: str, timeout_s: float = 5.0) -> AsyncIterator[tuple[Device, EmulatedDevice, Server]]:
    """A device whose chip is behind a socket. The chip's time is the test's, the wire's is real."""
    chip = cast("EmulatedDevice", build_emulator(model, VirtualClock()))

    async def answer(frame: bytes, writer: asyncio.StreamWriter) -> None:
        writer.write(chip.exchange(frame))

    async with serving(answer) as server:
        manager = DeviceManager(KINDS, WallClock())
        link = {"kind": "tcp", "host": "127.0.0.1", "port": server.port, "timeout_s": timeout_s}
        device = await manager.add(DeviceConfig("Far", model, link))
        try:
            yield device, chip, server
        finally:
            await manager.close()


def chip_clock(chip: EmulatedDevice) -> VirtualClock:
    return cast("VirtualClock", chip.clock.base)


@pytest.mark.parametrize("model", list(CHIPS_32))
async def test_set_up_move_and_stop(model: str) -> None:
    async with remote(model) as (device, chip, server):
        assert device.state == "connected"
        assert not device.session.chip_timed
        start = AxisStart(START.v_max, START.a_max, START.pulse_div, START.ramp_div, stops=False)
        await start_up(device, [start] * len(device.axes))
        started = await device.motion.move(0, 5000)
        assert started.predicted_duration_s is not None
        chip_clock(chip).set(started.predicted_duration_s + 0.1)
        assert (await device.monitor.axis_state(0)).position == 5000
        await device.motion.rotate(0, 5000)
        chip_clock(chip).set(2.0)
        assert (await device.stop(0)).ok
        assert server.connections == 1


async def test_samples_over_the_wire() -> None:
    async with remote("tmc428") as (device, chip, _):
        plan = device.telemetry.sample_plan(["position.0", "position.1"])
        await device.need(PositionSetting).set_position(1, -77)
        before_s = device.device_time_s()
        time_s, replies = await device.session.queue.sample(plan.frames)
        assert before_s <= time_s <= device.device_time_s()
        assert len(replies) == 8
        assert plan.decode(np.array([time_s]), replies).tolist() == [[0, -77]]
        assert chip.state().chip_time_s == 0


async def test_a_server_that_goes_and_comes_back() -> None:
    async with remote("tmc428", timeout_s=0.2) as (device, _, server):
        states: list[str] = []
        device.listen(lambda event: states.append(event.state) if isinstance(event, StateChanged) else None)
        answer = server.behave

        async def hang_up(frame: bytes, writer: asyncio.StreamWriter) -> None:
            writer.close()

        server.behave = hang_up
        with pytest.raises(LinkError):
            await device.registers.read("v_max", 0)
        assert device.state == "failed"
        assert device.problem is not None
        back = asyncio.Event()
        device.listen(
            lambda event: back.set() if isinstance(event, StateChanged) and event.state == "connected" else None
        )
        server.behave = answer
        async with asyncio.timeout(10.0):
            await back.wait()  # nobody asked anything: the watch brought it back
        assert states == ["failed", "connected"]
        assert (await device.registers.read("v_max", 0)).value == 0


async def test_a_late_answer_is_never_taken_for_the_next_one() -> None:
    async with remote("tmc428", timeout_s=0.05) as (device, _, server):
        for axis in range(3):
            await device.registers.write("v_min", axis, value=axis + 10)
        answer, release, slow = server.behave, asyncio.Event(), [1, 1]

        async def late(frame: bytes, writer: asyncio.StreamWriter) -> None:
            if slow:
                slow.pop()
                await release.wait()
            await answer(frame, writer)

        server.behave = late
        with pytest.raises(LinkTimeout):
            await device.registers.read("v_min", 0)
        release.set()
        for _ in range(5):
            for axis in (1, 2):
                assert (await device.registers.read("v_min", axis)).value == axis + 10


async def test_a_trial_finds_the_chip_or_says_what_is_wrong() -> None:
    async with remote("tmc4210") as (_, __, server):
        manager = DeviceManager(KINDS, WallClock())
        link = {"kind": "tcp", "host": "127.0.0.1", "port": server.port}
        good = await manager.test("tmc4210", link)
        assert good.ok
        assert good.round_trip_ms is not None
        assert 0 < good.round_trip_ms < 1000
        other = await manager.test("tmc428", link)
        assert not other.ok
        assert "TMC4210" in other.detail
        assert manager.devices == ()


async def test_a_dead_link_is_edited_into_a_living_one() -> None:
    async with remote("tmc4210") as (_, __, server):
        manager = DeviceManager(KINDS, WallClock())
        device = await manager.add(
            DeviceConfig("Far", "tmc4210", {"kind": "tcp", "host": "host.invalid", "port": 4280})
        )
        assert device.state == "failed"
        edited = await manager.edit(
            device.id, DeviceChange(link={"kind": "tcp", "host": "127.0.0.1", "port": server.port})
        )
        assert state_of(edited) == "connected"
        assert manager.get("far") is edited
        await manager.close()
        assert state_of(edited) == "disconnected"


async def test_a_sample_that_waited_does_not_open_the_link_of_a_device_that_was_disconnected() -> None:
    async with remote("tmc428") as (_, __, server):
        manager = DeviceManager(KINDS, WallClock())
        device = await manager.add(
            DeviceConfig("Near", "tmc428", {"kind": "tcp", "host": "127.0.0.1", "port": server.port})
        )
        plan = device.telemetry.sample_plan(("position.0",))
        async with device.session.queue.turn():
            sample = asyncio.create_task(device.telemetry.take_samples(plan))
            await asyncio.sleep(0)  # it waits for its turn
            await manager.disconnect(device.id)
        with pytest.raises(LinkDown, match="disconnected"):
            await sample
        assert server.connections == 2
        await manager.connect(device.id)
        assert device.state == "connected"
        assert (await device.telemetry.take_samples(plan)).times_s
        await manager.close()
