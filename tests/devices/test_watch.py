"""A cable pulled and plugged in again, with a real driver over a real terminal to an emulated module."""

from __future__ import annotations

import asyncio
import contextlib
import os
import threading
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from app.clock import VirtualClock, WallClock
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.manager import DeviceManager
from app.emulators.tmcl.module import EmulatedModule
from app.errors import BenchError, LinkDown
from app.links.registry import serial_factory
from tests.links.pty_module import PtyModule, pty_module, until

MODEL = "pd42-1241"
BACK_WITHIN_S = 3.0
SEEN_WITHIN_S = 2.0
BUSY_S = 3.0
"""How much longer a machine may take that does other things as well; the limits above are measured by the bench."""


def resources() -> tuple[int, int]:
    """Descriptors and threads."""
    return len(os.listdir("/proc/self/fd")), threading.active_count()


@asynccontextmanager
async def connected() -> AsyncIterator[tuple[PtyModule, Device, EmulatedModule]]:
    emulated = EmulatedModule("pd42-1241", WallClock())
    with pty_module(lambda _, frame: emulated.receive(frame) or b"") as module:
        manager = DeviceManager({"serial": serial_factory}, WallClock())
        device = await manager.add(DeviceConfig("stage", MODEL, {"kind": "serial", "port": module.path}))
        try:
            assert device.state == "connected", device.problem
            yield module, device, emulated
        finally:
            await manager.close()


async def test_pulled_and_plugged_in_again() -> None:
    async with connected() as (module, device, _):
        before = resources()
        for _ in range(3):
            pulled_s = time.monotonic()
            module.unplug()
            await until(lambda: device.state == "failed")
            assert time.monotonic() - pulled_s < SEEN_WITHIN_S + BUSY_S
            assert isinstance(device.problem, LinkDown)
            plugged_s = time.monotonic()
            module.plug()
            await until(lambda: device.state == "connected", BACK_WITHIN_S + BUSY_S)
            assert time.monotonic() - plugged_s < BACK_WITHIN_S + BUSY_S
            assert resources() == before


async def test_pulled_under_load() -> None:
    """While it is gone nobody gets a value; afterwards everybody does."""
    async with connected() as (module, device, _):
        await device.registers.read("actual_position")
        before = resources()
        plugged = True

        async def ask() -> int:
            """How many answers came; each while the cable was plugged, for an answer takes no time to speak of."""
            answers = 0
            while True:
                gone = not plugged
                with contextlib.suppress(BenchError):
                    await device.registers.read("actual_position")
                    assert not (gone and not plugged)
                    answers += 1
                await asyncio.sleep(0.001)

        asking = [asyncio.create_task(ask()) for _ in range(5)]
        for _ in range(3):
            await asyncio.sleep(0.05)
            plugged = False
            module.unplug()
            await until(lambda: device.state == "failed")
            await asyncio.sleep(0.05)
            plugged = True
            module.plug()
            await until(lambda: device.state == "connected", BACK_WITHIN_S + BUSY_S)
        assert not any(task.done() for task in asking)
        for task in asking:
            task.cancel()
        await asyncio.gather(*asking, return_exceptions=True)
        assert resources() == before


async def test_a_module_that_falls_silent_is_seen_by_looking_in() -> None:
    """No cable tells of it: time goes on until the next look."""
    clock = VirtualClock()
    emulated = EmulatedModule("pd42-1241", WallClock())
    with pty_module(lambda _, frame: emulated.receive(frame) or b"") as module:
        manager = DeviceManager({"serial": serial_factory}, clock)
        link = {"kind": "serial", "port": module.path}
        device = await manager.add(DeviceConfig("stage", MODEL, link))
        assert device.state == "connected", device.problem
        speaks = module.behave
        module.behave = lambda module, frame: b""
        for _ in range(8):  # 2 s
            await clock.advance(SEEN_WITHIN_S / 8)
        await until(lambda: device.state == "failed")
        module.behave = speaks

        async def retried() -> None:
            while device.state != "connected":
                await clock.advance(0.25)
                await asyncio.sleep(0.01)  # for the answers, which are not on that clock

        started_s = clock.now()
        await asyncio.wait_for(retried(), 10)
        assert clock.now() - started_s < BACK_WITHIN_S
        await manager.close()


async def test_disconnected_while_it_is_gone_leaves_nothing_behind() -> None:
    async with connected() as (module, device, _):
        module.unplug()
        await until(lambda: device.state == "failed")
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("line ")]
