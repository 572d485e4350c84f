"""How often the service looks, over a wire that takes its time: 9 bytes there and 9 back at 9600 baud."""

from __future__ import annotations

import asyncio

import pytest

from app.clock import Clock, VirtualClock
from app.conditions.service import WIRE_SHARE, AxisAssessment, ConditionService
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.core.results import AxisState
from app.devices.manager import DeviceManager
from app.emulators.build import build_emulator
from app.emulators.tmcl.options import SwitchesChange, TmclOptions, TmclPatch
from app.links.emulator import EmulatorPort
from app.links.port import FramePort, PortTraits
from app.links.queue import Priority
from app.links.registry import Link

GET_POSITION = bytes((1, 6, 1, 0, 0, 0, 0, 0, 8))
FRAME_S = 18 * 10 / 9600


class SlowPort:
    """An emulator each exchange with which takes as long as at 9600 baud."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._port = EmulatorPort(build_emulator("pd42-1241", clock, TmclOptions()))
        self.name = "slow"
        self.traits = PortTraits()

    @property
    def last_exchange_s(self) -> float:
        return self._port.last_exchange_s

    def device_time_s(self) -> float:
        return self._port.device_time_s()

    async def exchange(self, frame: bytes, timeout_s: float | None = None) -> bytes:
        await self._clock.sleep(FRAME_S)
        return await self._port.exchange(frame, timeout_s)

    async def aclose(self) -> None:
        await self._port.aclose()


def slow(model: str, link: Link, clock: Clock) -> FramePort:
    return SlowPort(clock)


async def pass_time(clock: VirtualClock, seconds: float) -> None:
    for _ in range(round(seconds / 0.01)):
        await clock.advance(0.01)


async def test_looks_keep_to_their_share_of_a_slow_wire_and_commands_overtake_them() -> None:
    clock = VirtualClock()
    manager = DeviceManager({"emulator": slow}, clock)
    adding = asyncio.create_task(manager.add(DeviceConfig("slow", "pd42-1241", {"kind": "emulator"})))
    while not adding.done():
        await clock.advance(0.01)
    device = adding.result()
    conditions = ConditionService(clock, lambda device, axis: "idle")
    before = device.session.queue.counts.frames[2]
    conditions.sync(manager.devices)
    try:
        await pass_time(clock, 30.0)
        looked = device.session.queue.counts.frames[2] - before
        assert conditions.standing(device, 0).condition.kind == "ready"
        assert 30 < looked <= WIRE_SHARE * 30.0 / FRAME_S * 1.05
        # A stop waits for the one frame that is on the wire. A move waits for that, and for the 5 frames with which the
        # connection is looked in on; a look of conditions is 16 frames long.
        for priority, frames in ((Priority.STOP, 2), (Priority.COMMAND, 7)):
            for _ in range(20):
                began_s = clock.now()
                sending = asyncio.create_task(device.session.queue.exchange(GET_POSITION, priority))
                while not sending.done():
                    await clock.advance(0.001)
                assert clock.now() - began_s <= frames * FRAME_S + 0.003, priority
                await pass_time(clock, 0.37)
    finally:
        await conditions.close()
        await manager.close()


class OwnTimePort(EmulatorPort):
    """An emulator's port each exchange of which takes 1 ms."""

    async def exchange(self, frame: bytes, timeout_s: float | None = None) -> bytes:
        await self._server.sleep(0.001)
        return await super().exchange(frame, timeout_s)


def own_time(model: str, link: Link, clock: Clock) -> FramePort:
    return OwnTimePort(build_emulator("pd42-1241", clock, TmclOptions()))


async def test_resting_emulators_are_looked_at_less_often_where_there_are_many_and_moving_ones_as_ever() -> None:
    clock = VirtualClock()
    manager = await eight_at_rest(clock)
    looks: dict[str, int] = {}

    def searched(device: Device, axis: int) -> str:  # asked at each look
        looks[device.id] = looks.get(device.id, 0) + 1
        return "idle"

    conditions = ConditionService(clock, searched)
    conditions.sync(manager.devices)
    mover = manager.devices[0]
    try:
        await pass_time(clock, 5.0)
        looks.clear()
        await pass_time(clock, 10.0)
        assert all(5 <= number <= 20 for number in looks.values()), looks
        rotating = asyncio.create_task(mover.motion.rotate(0, 1000))
        while not rotating.done():
            await clock.advance(0.01)
        looks.clear()
        await pass_time(clock, 10.0)
        assert looks.pop(mover.id) >= 30
        assert all(5 <= number <= 20 for number in looks.values()), looks
    finally:
        await conditions.close()
        await manager.close()


async def eight_at_rest(clock: VirtualClock) -> DeviceManager:
    manager = DeviceManager({"emulator": own_time}, clock)
    for number in range(8):
        adding = asyncio.create_task(manager.add(DeviceConfig(f"d{number}", "pd42-1241", {"kind": "emulator"})))
        while not adding.done():
            await clock.advance(0.01)
    return manager


async def test_whoever_asks_for_a_device_that_is_seldom_looked_at_gets_a_fresh_look_or_the_old_one_soon() -> None:
    clock = VirtualClock()
    manager = await eight_at_rest(clock)
    conditions = ConditionService(clock, lambda device, axis: "idle")
    conditions.sync(manager.devices)
    device = manager.devices[0]
    try:
        await pass_time(clock, 5.0)
        state, _ = await look(clock, conditions, device)
        await pass_time(clock, 0.6)
        asking = asyncio.create_task(conditions.freshen(device))
        await pass_time(clock, 0.05)
        assert asking.done()
        evidence = conditions.standing(device, 0).condition.evidence
        seen_s = next(piece.seen_s for piece in evidence if piece.what == "position")
        assert seen_s is not None
        assert seen_s >= state.time_s + 0.6
        # Time stands still, and with it the answer: nobody waits for ever.
        await pass_time(clock, 0.6)
        await asyncio.wait_for(conditions.freshen(device), 30)
    finally:
        await conditions.close()
        await manager.close()


async def look(clock: VirtualClock, conditions: ConditionService, device: Device) -> tuple[AxisState, AxisAssessment]:
    looking = asyncio.create_task(conditions.poll(device, 0))
    while not looking.done():
        await clock.advance(0.001)
    return looking.result()


async def test_a_change_around_a_device_is_looked_at_at_once() -> None:
    clock = VirtualClock()
    manager = await eight_at_rest(clock)
    conditions = ConditionService(clock, lambda device, axis: "idle")
    conditions.sync(manager.devices)
    device = manager.devices[0]
    port = device.session.port
    assert isinstance(port, EmulatorPort)
    try:
        await pass_time(clock, 5.0)
        for on in (True, False, True, False):
            await pass_time(clock, 2.37)
            change = TmclPatch(switches=SwitchesChange(right=on))
            port.wire.patch(change, port.take_turn())  # type: ignore[attr-defined]
            conditions.stirred(device)
            await pass_time(clock, 0.1)
            assert ("right switch" in conditions.standing(device, 0).condition.cause) is on
    finally:
        await conditions.close()
        await manager.close()


async def test_a_look_that_fails_as_nobody_foresaw_leaves_no_condition_of_before(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = VirtualClock()
    manager = DeviceManager({"emulator": own_time}, clock)
    adding = asyncio.create_task(manager.add(DeviceConfig("d", "pd42-1241", {"kind": "emulator"})))
    while not adding.done():
        await clock.advance(0.01)
    device = adding.result()
    conditions = ConditionService(clock, lambda device, axis: "idle")
    conditions.sync(manager.devices)
    try:
        await pass_time(clock, 1.0)
        assert conditions.standing(device, 0).condition.kind == "ready"
        with monkeypatch.context() as broken:
            broken.setattr(type(device.monitor), "signs", lambda self, axis, state: 1 // 0)
            await pass_time(clock, 1.0)
            found = conditions.standing(device, 0).condition
            assert found.kind == "unknown"
            assert "ZeroDivisionError" in found.cause
        assert len([record for record in caplog.records if record.exc_info]) == 1  # once, not at every look
        await pass_time(clock, 1.0)
        assert conditions.standing(device, 0).condition.kind == "ready"  # and it goes on looking
    finally:
        await conditions.close()
        await manager.close()
