"""How the server is, for people and for Prometheus: the same figures, and each of them measured."""

from __future__ import annotations

import asyncio
import time
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI
from prometheus_client.parser import text_string_to_metric_families
from websockets.asyncio.client import connect

from app import __version__
from app.api.health.vitals import LoopLag, Vitals
from app.clock import VirtualClock, WallClock
from app.links.arbiter import Arbiter, Priority
from app.links.waits import Waits
from app.main import create_app
from app.settings import Settings
from tests.api.live import live_server


async def test_the_short_one_stays_short(client: httpx.AsyncClient) -> None:
    assert (await client.get("health")).json() == {"status": "ok", "version": __version__}


async def test_the_details_tell_of_everything(
    client: httpx.AsyncClient, settings: Settings, clock: VirtualClock
) -> None:
    await clock.advance(2.0)
    await client.get("devices/bench/registers/v_max?axis=0")
    health = (await client.get("health/details")).json()
    assert health["version"] == __version__
    assert health["uptime_s"] == pytest.approx(2.0)
    assert health["storage"]["data_dir"] == str(settings.data_dir)
    assert health["storage"]["writable"] is True
    assert 0 < health["storage"]["free_bytes"] <= health["storage"]["total_bytes"]
    assert health["storage"]["notes"] == []
    assert 0 < health["process"]["descriptors"] < health["process"]["descriptors_max"]
    assert health["process"]["resident_bytes"] > 10e6
    assert health["sockets"]["connections"] is None, "no server of ours serves this test"
    bench = next(device for device in health["devices"] if device["id"] == "bench")
    assert bench["state"] == "connected"
    assert bench["link"]["bytes_sent"] == 4 * bench["link"]["frames"] > 0, "datagrams of four bytes"
    assert bench["link"]["bytes_received"] == bench["link"]["bytes_sent"]
    assert bench["emulator"] == {"time_scale": 1.0, "samples_missed": 0}
    assert (bench["queue"]["stops"], bench["queue"]["commands"], bench["queue"]["longest_wait_ms"]) == (0, 0, 0)


async def test_prometheus_gets_the_same_figures(app: FastAPI, pages: httpx.AsyncClient) -> None:
    health = (await pages.get("/api/v1/health/details")).json()
    answer = await pages.get("/metrics")
    assert answer.headers["content-type"].startswith("text/plain")
    figures = {
        (sample.name, tuple(sample.labels.values())): sample.value
        for family in text_string_to_metric_families(answer.text)
        for sample in family.samples
    }
    assert figures["stepscope_info", (__version__,)] == 1
    assert figures["stepscope_storage_total_bytes", ()] == health["storage"]["total_bytes"]
    assert figures["stepscope_devices", ()] == len(health["devices"]) == figures["stepscope_emulators", ()]
    for device in health["devices"]:
        assert figures["stepscope_device_connected", (device["id"], device["model"])] == 1
        sent = figures["stepscope_link_bytes_sent_total", (device["id"],)]
        assert sent >= device["link"]["bytes_sent"] > 0
    assert ("stepscope_connections", ()) not in figures, "what is not known is left out"


async def test_what_was_set_aside_is_told(settings: Settings, clock: VirtualClock) -> None:
    settings.data_dir.mkdir(parents=True)
    (settings.data_dir / "connections.json").write_text('{"half of')
    (settings.data_dir / "stepscope.sqlite3").write_text("no database")
    app = create_app(settings, clock)
    async with app.router.lifespan_context(app):
        transport = httpx.ASGITransport(app)
        async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1:8000") as client:
            notes = (await client.get("/api/v1/health/details")).json()["storage"]["notes"]
    assert any("connections.json cannot be read" in note and "kept as" in note for note in notes)
    assert any("stepscope.sqlite3 is damaged" in note for note in notes)


async def test_what_is_not_saved_is_told(app: FastAPI, client: httpx.AsyncClient, settings: Settings) -> None:
    (settings.data_dir / "connections.json.lock").mkdir(parents=True)  # nobody opens a directory as a file
    await client.post("devices", json={"name": "Other", "model": "tmc4210", "link": {"kind": "emulator"}})
    notes = (await client.get("health/details")).json()["storage"]["notes"]
    assert any("connections.json cannot be written" in note for note in notes)


async def test_sockets_and_connections_are_counted_while_they_are_open(tmp_path: Path) -> None:
    async with live_server(tmp_path) as url, httpx.AsyncClient(base_url=url) as client:

        async def sockets() -> dict[str, int]:
            found: dict[str, int] = (await client.get("/api/v1/health/details")).json()["sockets"]
            return found

        assert (await sockets())["websockets"] == 0
        async with connect(url.replace("http", "ws") + "/api/v1/conditions") as socket:
            await socket.recv()
            open_ones = await sockets()
            assert open_ones["websockets"] == 1
            assert open_ones["connections_max"] >= open_ones["connections"] >= 2
        async with asyncio.timeout(20):
            while (await sockets())["websockets"]:
                pass  # asking is waiting enough


async def test_a_blocked_event_loop_is_seen() -> None:
    lag = LoopLag(WallClock())
    measuring = asyncio.create_task(lag.measure())
    try:
        await asyncio.sleep(0)
        time.sleep(0.3)  # noqa: ASYNC251 - the fault that is to be seen
        await asyncio.wait({measuring}, timeout=0.05)
    finally:
        measuring.cancel()
    assert lag.now_s is not None
    assert lag.now_s >= 0.15
    assert max(second or 0.0 for second in lag.by_second()) >= 0.15


async def test_lag_is_of_the_last_minute(clock: VirtualClock) -> None:
    lag = LoopLag(clock)
    assert (lag.now_s, lag.p99_s) == (None, None)
    measuring = asyncio.create_task(lag.measure())
    await clock.advance(1.0)
    assert lag.p99_s == pytest.approx(0.0)
    measuring.cancel()
    await clock.advance(30.0)
    assert lag.by_second()[-5:] == [None] * 5, "nothing was measured then"
    assert any(second is not None for second in lag.by_second())
    await clock.advance(31.0)
    assert lag.p99_s is None


async def test_the_longest_wait_is_of_the_last_minute_and_of_those_who_wait_still() -> None:
    now_s = 100.0
    waits = Waits(lambda: now_s)
    assert waits.longest_s == 0
    with waits.one():
        now_s += 5
        assert waits.longest_s == 5
        with waits.one():
            now_s += 2
    assert waits.longest_s == 7
    now_s += 31
    assert waits.longest_s == 7
    now_s += 31
    assert waits.longest_s == 0


async def test_a_disk_that_does_not_answer_costs_one_thread(
    clock: VirtualClock, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import threading

    from app.api.health import vitals as module

    answer, looks = threading.Event(), []

    def hangs(directory: Path) -> module.Disk:
        looks.append(directory)
        answer.wait(20)
        return module.Disk(1, 2, True)

    monkeypatch.setattr(module, "_disk_of", hangs)
    monkeypatch.setattr(module, "DISK_WITHIN_S", 0.01)
    vitals = Vitals(clock, tmp_path)
    for _ in range(5):
        assert await vitals.disk() == module.Disk()
    assert len(looks) == 1
    answer.set()
    monkeypatch.setattr(module, "DISK_WITHIN_S", 20.0)
    assert (await vitals.disk()).free_bytes == 1


async def test_a_queue_tells_how_long_it_was_waited_for() -> None:
    from app.links.port import PortTraits
    from app.links.queue import LinkQueue

    class Port:
        name = "port"
        last_exchange_s = 0.0
        traits = PortTraits()

        async def exchange(self, frame: bytes, timeout_s: float | None = None) -> bytes:
            return frame + b"!"

        def device_time_s(self) -> float:
            return 0.0

        async def aclose(self) -> None: ...

    queue = LinkQueue(Port())
    assert isinstance(queue.arbiter, Arbiter)
    async with queue.turn() as turn:
        waiting = asyncio.create_task(queue.exchange(b"abc", Priority.STOP))
        await asyncio.sleep(0.02)
        assert queue.waits.longest_s >= 0.015
        await turn.exchange(b"de")
    await waiting
    assert queue.waits.longest_s >= 0.015
    assert (queue.counts.bytes_sent, queue.counts.bytes_received) == (5, 7)
