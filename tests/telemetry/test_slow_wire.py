"""Telemetry over a wire that is the limit: none of it lies idle, and nobody's rows are asked twice."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pytest

from app.clock import Clock, VirtualClock
from app.devices.core.config import DeviceConfig
from app.devices.core.device import Device
from app.devices.manager import DeviceManager
from app.emulators.tmcl.family import FAMILY
from app.emulators.tmcl.module import EmulatedModule
from app.emulators.tmcl.options import TmclOptions
from app.errors import LinkDown
from app.links.arbiter import Arbiter
from app.links.incidents import Incidents
from app.links.port import Answer, Batch, FramePort, PortTraits
from app.links.registry import Link
from app.links.wire_budget import WireBudget
from app.registers.tmcl.commands import Opcode
from app.telemetry.frames import decode
from app.telemetry.hub import TelemetryHub
from app.telemetry.reader import Reader, Status

BAUD = 115_200
CALL_S = 18 * 10 / BAUD
DETOUR_S = 100e-6
"""What the way to the wire's thread and back costs each go."""


class TimedPort:
    """An emulated module behind a line of 115,200 baud, whose time is that of the test."""

    def __init__(self, clock: Clock, module: EmulatedModule) -> None:
        self.name = "timed line"
        self.traits = PortTraits(batches=self)
        self.module = module
        self.arbiter = Arbiter()
        self.wire = WireBudget(BAUD, 18, now=clock.now)
        self.incidents = Incidents()
        self.batch = Batch()
        self.last_exchange_s = 0.0
        self.first_bytes_s: list[tuple[float, int]] = []
        self.stalled_s = 0.0
        self._clock = clock

    def device_time_s(self) -> float:
        return self._clock.now()

    async def exchange(self, frame: bytes, timeout_s: float | None = None, answer: Answer = Answer.ALWAYS) -> bytes:
        return (await self.exchange_many([frame], lambda: False, timeout_s, answer))[0]

    async def exchange_many(
        self,
        frames: Sequence[bytes],
        preempted: Callable[[], bool],
        timeout_s: float | None = None,
        answer: Answer = Answer.ALWAYS,
    ) -> list[bytes]:
        del timeout_s, answer
        stalled_s, self.stalled_s = self.stalled_s, 0.0
        await self._clock.sleep(DETOUR_S + stalled_s)
        batch = self.batch = Batch(started_s=self._clock.now())
        for index, frame in enumerate(frames):
            if index and preempted():
                break
            self.first_bytes_s.append((self._clock.now(), frame[1]))
            await self._clock.sleep(CALL_S)
            batch.replies.append(self.module.exchange(frame))
            batch.answered_s.append(self._clock.now() - batch.started_s)
        self.last_exchange_s = self._clock.now()
        self.wire.count(len(batch.replies), self.last_exchange_s - batch.started_s)
        return batch.replies

    def on_down(self, listener: Callable[[LinkDown], None]) -> Callable[[], None]:
        del listener
        return lambda: None

    def on_event(self, listener: Callable[[bytes], None]) -> Callable[[], None]:
        del listener
        return lambda: None

    async def aclose(self) -> None:
        """Nothing is open."""


@dataclass
class Rig:
    clock: VirtualClock
    hub: TelemetryHub
    device: Device
    port: TimedPort

    async def turning(self) -> None:
        """Send the motor on its way, which takes time on this wire."""
        rotating = asyncio.create_task(self.device.motion.rotate(0, 50_000))
        await self.clock.advance(0.2)
        await rotating

    def status(self, reader: Reader) -> Status:
        return next(event for event in reversed(reader.take_events()) if isinstance(event, Status))


@pytest.fixture
async def rig() -> AsyncIterator[Rig]:
    clock = VirtualClock()
    ports: list[TimedPort] = []

    def timed(model: str, link: Link, clock: Clock) -> FramePort:
        ports.append(TimedPort(clock, FAMILY.make("pd42-1241", clock, TmclOptions())))
        return ports[-1]

    hub = TelemetryHub(clock, 1.0)
    manager = DeviceManager({"timed": timed}, clock, on_change=lambda: hub.sync(manager.devices))
    device = await manager.add(DeviceConfig("module", "pd42-1241", {"kind": "timed"}), wait=False)
    await clock.advance(1.0)
    assert device.state == "connected"
    yield Rig(clock, hub, device, ports[0])
    await hub.close()
    await manager.close()


@pytest.mark.parametrize("channels", [("position.0",), ("position.0", "velocity.0", "deviation.0")])
async def test_the_wire_is_used_to_nine_tenths(rig: Rig, channels: tuple[str, ...]) -> None:
    joined = rig.hub.join("module", channels, 1000.0)
    questions = len(rig.device.telemetry.sample_plan(channels).frames)
    assert joined.rate_hz == pytest.approx(640 / questions)
    await rig.clock.advance(1.0)
    calls = len(rig.port.first_bytes_s)
    await rig.clock.advance(2.0)
    achieved = (len(rig.port.first_bytes_s) - calls) / 2.0
    assert 0.9 * 640 <= achieved <= 640
    status = rig.status(joined.reader)
    assert status.calls_per_s_possible == 640
    assert status.calls_per_s == pytest.approx(achieved, rel=0.05)
    assert status.row_spread_ms == pytest.approx((questions - 1) * CALL_S * 1e3, rel=0.05, abs=0.01)


async def test_each_row_bears_its_own_time(rig: Rig) -> None:
    joined = rig.hub.join("module", ("position.0",), 1000.0)
    await rig.clock.advance(1.0)
    while joined.reader.take(rig.clock.now()) is not None:
        pass
    await rig.turning()
    await rig.clock.advance(2.0)
    times, positions = [], []
    while (frame := joined.reader.take(rig.clock.now())) is not None:
        rows = decode(frame)
        times.append(rows.time_s)
        positions.append(rows.columns[0])
    time_s, position = np.concatenate(times)[-400:], np.concatenate(positions)[-400:]
    speed = np.diff(position) / np.diff(time_s)
    assert np.abs(speed / 50_000 - 1).max() < 0.05
    assert np.diff(time_s).min() > 0.9 * CALL_S


async def test_a_stop_waits_for_no_more_than_one_question(rig: Rig) -> None:
    rig.hub.join("module", ("position.0", "velocity.0"), 1000.0)
    await rig.turning()
    for _ in range(20):
        await rig.clock.advance(0.0137)
        asked_s = rig.clock.now()
        task = asyncio.create_task(rig.device.stop_axes([0]))
        await rig.clock.advance(0.1)
        assert (await task)[0].ok
        sent_s = next(at_s for at_s, opcode in rig.port.first_bytes_s if opcode == Opcode.MST and at_s >= asked_s)
        assert sent_s - asked_s <= CALL_S + 2 * DETOUR_S + 1e-9


async def test_readers_and_history_share_rows(rig: Rig) -> None:
    await rig.clock.advance(2.0)
    idle = len(rig.port.first_bytes_s)
    await rig.clock.advance(2.0)
    assert (len(rig.port.first_bytes_s) - idle) / 2.0 < 0.3 * 640, "nobody reads: the history takes a small share"
    rig.hub.join("module", ("position.0",), 100.0)
    await rig.clock.advance(0.5)
    alone = len(rig.port.first_bytes_s)
    await rig.clock.advance(2.0)
    assert (len(rig.port.first_bytes_s) - alone) / 2.0 == pytest.approx(100, abs=15), "rows for the reader, no others"
    past = rig.hub.join("module", ("position.0", "load_value.0"), 100.0, history_s=1.5)
    assert len(past.history_time_s) == pytest.approx(1.5 * 50, abs=5)
    assert np.isfinite(past.history[:, 0]).all()
    assert np.isnan(past.history[:, 1]).all(), "what nobody asked for is not known"


async def test_a_stall_of_the_wire_leaves_a_hole_and_no_burst(rig: Rig) -> None:
    rig.hub.join("module", ("position.0",), 50.0)
    await rig.clock.advance(1.0)
    rig.port.stalled_s = 1.0
    await rig.clock.advance(1.0)
    asked = len(rig.port.first_bytes_s)
    await rig.clock.advance(1.0)
    assert len(rig.port.first_bytes_s) - asked <= 50 + 12, "the beat, one late row, and a look of the watch"
