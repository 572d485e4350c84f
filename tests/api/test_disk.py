"""A disk that takes nothing: what is acknowledged is told not to be kept, and is kept as soon as that can be."""

from __future__ import annotations

import asyncio
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI

from app.api.health.details import health_of
from app.clock import VirtualClock
from app.main import bench_of, create_app
from app.settings import Settings
from app.store.connections import FILE_NAME, ConnectionStore
from app.store.saver import RETRY_S

NEW = {"name": "New", "model": "tmc428", "link": {"kind": "emulator"}}


def blocked(settings: Settings) -> Path:
    """Nobody may write the connections any more, not even root: a directory stands where their lock goes."""
    lock = settings.data_dir / f"{FILE_NAME}.lock"
    lock.parent.mkdir(parents=True, exist_ok=True)
    lock.unlink(missing_ok=True)
    lock.mkdir()
    return lock


async def test_a_connection_that_is_not_on_disk_is_told_in_the_answer_and_kept_later(
    client: httpx.AsyncClient, app: FastAPI, settings: Settings, clock: VirtualClock
) -> None:
    lock = blocked(settings)
    added = await client.post("devices", json=NEW)
    assert added.status_code == 201
    assert any(FILE_NAME in note and "tried again" in note for note in added.json()["notes"])
    edited = await client.patch("devices/new", json={"name": "Newer"})
    assert any("tried again" in note for note in edited.json()["notes"])
    listed = {device["id"]: device["notes"] for device in (await client.get("devices")).json()}
    assert any("tried again" in note for note in listed["newer"])
    assert not any("tried again" in note for note in listed["bench"])  # the demo is never kept
    lock.rmdir()
    saver = bench_of(app).saver
    while saver.problem is not None:
        await clock.advance(RETRY_S)
        await asyncio.sleep(0.001)  # the disk's own time
    assert (await client.get("devices/newer")).json()["notes"] == []
    assert [one.name for one in ConnectionStore(settings.data_dir).load().configs] == ["Newer"]


async def test_what_is_acknowledged_is_on_disk(client: httpx.AsyncClient, settings: Settings) -> None:
    for name in ("a", "b"):
        assert (await client.post("devices", json={**NEW, "name": name})).json()["notes"] == []
        assert name in [one.name for one in ConnectionStore(settings.data_dir).load().configs]
    await client.delete("devices/a")
    assert [one.name for one in ConnectionStore(settings.data_dir).load().configs] == ["b"]


async def test_a_recording_that_cannot_be_renamed_is_told(
    client: httpx.AsyncClient, settings: Settings, clock: VirtualClock
) -> None:
    begun = await client.post("recordings", json={"device": "bench", "channels": ["position.0"], "name": "first"})
    recording = begun.json()["id"]
    await clock.advance(0.2)
    await client.post(f"recordings/{recording}/stop")
    lock = settings.data_dir / "recordings" / f"{recording}.json.lock"
    lock.unlink()
    lock.mkdir()
    refused = await client.patch(f"recordings/{recording}", json={"name": "second"})
    assert refused.status_code == 503
    assert refused.json()["type"] == "/problems/store-unavailable"
    assert (await client.get(f"recordings/{recording}")).json()["name"] == "first"
    gone = await client.delete(f"recordings/{recording}")  # its lock is a directory: not deleted as a whole
    assert gone.status_code == 503


@pytest.mark.parametrize("name", ["connections.json", "positions.json"])
async def test_a_broken_file_where_nothing_can_be_written_does_not_keep_the_server_from_starting(
    settings: Settings, clock: VirtualClock, name: str
) -> None:
    broken, lock = settings.data_dir / name, settings.data_dir / f"{name}.lock"
    lock.mkdir(parents=True)
    broken.write_text("no JSON")
    app = create_app(settings, clock)
    async with app.router.lifespan_context(app):
        notes = (await health_of(bench_of(app))).storage.notes
        assert any(f"kept as {broken}," in note for note in notes)
    assert broken.read_text() == "no JSON"
