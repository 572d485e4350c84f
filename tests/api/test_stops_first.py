"""What is done in the background waits while a stop is under way."""

from __future__ import annotations

import asyncio
import contextlib
import gc
from collections.abc import AsyncIterator

import httpx
import pytest
from fastapi import FastAPI

from app.clock import HELD_MAX_S, VirtualClock, WallClock
from app.conditions.service import LOOK_EVERY_S
from app.devices import stopping
from app.emulators.build import build_emulator
from app.emulators.device import EmulatedDevice
from app.emulators.options import EmulatorPatch
from app.emulators.server import serve_tcp
from app.links.queue import Priority
from app.main import bench_of
from app.serving import keep_out_of_collections


@pytest.fixture
async def far(client: httpx.AsyncClient) -> AsyncIterator[EmulatedDevice]:
    """A connected chip over TCP that never answers again once it is silent."""
    chip = build_emulator("tmc428", WallClock())
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
    queue, sending = bench_of(app).manager.get("bench").queue, bench_of(app).manager.get("far").queue

    def looks() -> int:
        return queue.counts.frames[Priority.SAMPLE]

    before = looks()
    while looks() == before:
        await clock.advance(1e-3)
    await clock.advance(LOOK_EVERY_S - HELD_MAX_S / 2)  # the next look comes while the stop is under way
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


def test_what_is_there_for_good_is_not_looked_through_for_garbage() -> None:
    before = gc.get_threshold()
    try:
        keep_out_of_collections()
        assert len(gc.get_objects()) < 10_000
    finally:
        gc.unfreeze()
        gc.set_threshold(*before)
