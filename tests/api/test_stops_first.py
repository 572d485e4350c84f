"""What is done in the background waits while a stop is under way."""

from __future__ import annotations

import asyncio
import contextlib
import gc
from collections import deque
from collections.abc import AsyncIterator, Iterator

import httpx
import pytest
from fastapi import FastAPI
from starlette.types import Message

from app.clock import HELD_MAX_S, TURN_S, VirtualClock, WallClock
from app.conditions.service import POLL_PERIOD_S
from app.devices.core import stopping
from app.emulators.server import serve_tcp
from app.emulators.tmc428.device import EmulatedDevice
from app.emulators.tmc428.family import FAMILY
from app.emulators.tmc428.options import EmulatorPatch
from app.links.queue import Priority
from app.main import bench_of
from app.serving import keep_out_of_collections


@pytest.fixture
async def far(client: httpx.AsyncClient) -> AsyncIterator[EmulatedDevice]:
    """A connected chip over TCP that never answers again once it is silent."""
    chip = FAMILY.make("tmc428", WallClock())
    server = await serve_tcp(chip, "127.0.0.1", 0)
    link = {"kind": "tcp", "host": "127.0.0.1", "port": server.sockets[0].getsockname()[1], "timeout_s": 60}
    added = await client.post("devices", json={"name": "far", "model": "tmc428", "link": link})
    assert added.json()["state"] == "connected"
    yield chip
    server.close()
    await server.wait_closed()


async def test_looks_and_samples_wait_while_a_stop_is_under_way_but_not_for_ever(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, far: EmulatedDevice, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stopping, "STOP_WITHIN_S", 60.0)
    (
        await client.put("devices/bench/registers/v_max?axis=0", json={"value": 100})
    ).raise_for_status()  # looked at often
    queue, sending = bench_of(app).manager.get("bench").session.queue, bench_of(app).manager.get("far").session.queue

    def looks() -> int:
        return queue.counts.frames[Priority.SAMPLE]

    before = looks()
    while looks() == before:
        await clock.advance(1e-3)
    await clock.advance(POLL_PERIOD_S - HELD_MAX_S / 2)  # the next look comes while the stop is under way
    far.patch(EmulatorPatch.model_validate({"faults": {"silence": True}}))
    stops = queue.counts.frames[Priority.STOP]
    under_way = asyncio.create_task(client.post("stop"))
    while not sending.busy or queue.counts.frames[Priority.STOP] == stops:
        await clock.advance(0)
    before = looks()
    await clock.advance(HELD_MAX_S - 1e-3)
    assert looks() == before
    await clock.advance(1.0)
    assert before < looks()
    under_way.cancel()
    with contextlib.suppress(asyncio.CancelledError):
        await under_way
    before = looks()
    await clock.advance(0.5)
    assert looks() > before


class Readers:
    """So many who read one socket of the API, by a clock that goes on by `TURN_S` / 2 with each message."""

    def __init__(self, app: FastAPI, clock: VirtualClock, path: str, query: bytes = b"") -> None:
        self.most_in_a_turn = self.heard = 0
        self._in_turn = 0
        self._app, self._clock = app, clock
        self._scope = {"type": "websocket", "path": f"/api/v1/{path}", "raw_path": b"", "query_string": query}

    @contextlib.contextmanager
    def running(self, count: int) -> Iterator[None]:
        tasks = [asyncio.create_task(self._read()) for _ in range(count)]
        try:
            yield
        finally:
            for task in tasks:
                task.cancel()

    async def _read(self) -> None:
        coming = deque[Message]([{"type": "websocket.connect"}])

        async def receive() -> Message:
            return coming.popleft() if coming else await asyncio.Future()

        headers = [(b"host", b"localhost")]
        scope = {**self._scope, "headers": headers, "subprotocols": [], "server": ("127.0.0.1", 80), "scheme": "ws"}
        await self._app(scope, receive, self._hear)

    async def _hear(self, message: Message) -> None:
        if message["type"] != "websocket.send":
            return
        if self._in_turn == 0:
            asyncio.get_running_loop().call_soon(self._end_turn)
        self._in_turn += 1
        self.heard += 1
        self.most_in_a_turn = max(self.most_in_a_turn, self._in_turn)
        self._clock.set(self._clock.now() + TURN_S / 2)

    def _end_turn(self) -> None:
        self._in_turn = 0


@pytest.mark.parametrize(
    ("path", "query"),
    [("devices/bench/telemetry", b"channels=position.0&rate_hz=100&batch_hz=5"), ("conditions", b"")],
    ids=["telemetry", "conditions"],
)
async def test_readers_that_wake_together_leave_turns_of_the_loop_to_others(
    app: FastAPI, client: httpx.AsyncClient, clock: VirtualClock, path: str, query: bytes
) -> None:
    readers = Readers(app, clock, path, query)
    with readers.running(20):
        await clock.advance(0)
        readers.heard = readers.most_in_a_turn = 0
        (await client.post("devices/bench/axes/0/rotate", json={"velocity": 1000})).raise_for_status()
        for _ in range(20):
            await clock.advance(0.05)
        assert readers.heard >= 20
        assert readers.most_in_a_turn <= 3


def test_what_is_there_for_good_is_not_looked_through_for_garbage() -> None:
    before = gc.get_threshold()
    try:
        keep_out_of_collections()
        assert len(gc.get_objects()) < 10_000
    finally:
        gc.unfreeze()
        gc.set_threshold(*before)
