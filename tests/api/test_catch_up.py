"""Emulators that have a night of motion to catch up with hold up no stop: neither theirs nor one of others."""

from __future__ import annotations

import time
from collections.abc import AsyncIterator

import httpx
import pytest
from fastapi import FastAPI

from app.clock import WallClock
from app.main import create_app
from app.settings import Settings

NIGHT_S = 8 * 3600.0
STOPPED_WITHIN_S = 1.0
"""Of the event loop's processor time: the night takes minutes of it, what may be caught up with a few hundredths."""
STIFF = {"kind": "emulator", "motor": {"rotor_inertia_kgm2": 1e-7}}


class Suspended(WallClock):
    """The machine's clock, which may have gone on while the machine slept."""

    slept_s = 0.0

    def now(self) -> float:
        return super().now() + self.slept_s


@pytest.fixture
def suspended() -> Suspended:
    return Suspended()


@pytest.fixture
async def client(settings: Settings, suspended: Suspended) -> AsyncIterator[httpx.AsyncClient]:
    app: FastAPI = create_app(settings, suspended, list)
    transport = httpx.ASGITransport(app)
    async with (
        app.router.lifespan_context(app),
        httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000/api/v1/") as client,
    ):
        yield client


async def turning(client: httpx.AsyncClient, name: str, model: str, time_scale: float) -> None:
    body = {"name": name, "model": model, "link": STIFF}
    (await client.post("devices", json=body)).raise_for_status()
    (await client.post(f"devices/{name}/start-up")).raise_for_status()
    (await client.post(f"devices/{name}/axes/0/rotate", json={"velocity": 20_000})).raise_for_status()
    (await client.patch(f"devices/{name}/emulator", json={"time_scale": time_scale})).raise_for_status()


@pytest.mark.parametrize("time_scale", [1, 20])
@pytest.mark.parametrize("stopped", ["first", "bench"])
async def test_a_stop_is_answered_after_a_night_of_motion(
    client: httpx.AsyncClient, suspended: Suspended, time_scale: float, stopped: str
) -> None:
    for name, model in (("first", "tmc5160"), ("second", "tmc5072")):
        await turning(client, name, model, time_scale)
    (await client.post("devices/bench/axes/0/rotate", json={"velocity": 1000})).raise_for_status()
    suspended.slept_s += NIGHT_S
    began_s = time.thread_time()
    answer = await client.post(f"devices/{stopped}/axes/0/stop")
    worked_s = time.thread_time() - began_s
    assert answer.status_code == 200, answer.text
    assert worked_s < STOPPED_WITHIN_S
    for name in ("first", "second"):
        state = (await client.get(f"devices/{name}/emulator")).json()
        assert state["time_skipped_s"] > 0.9 * time_scale * NIGHT_S
    assert (await client.post("stop")).status_code == 200
