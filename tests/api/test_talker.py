"""Peers that talk without pause, or never: calls that reach them end all the same, and so does stop-all."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.api.live import live_server
from tests.peers.talker import talker

ENDS_WITHIN_S = 20.0
"""Far more than any of the bounds: a busy machine is no failure."""


@pytest.fixture
def talks() -> Iterator[int]:
    with talker() as port:
        yield port


@pytest.fixture
def silent() -> Iterator[int]:
    """The port of a peer that takes everything and says nothing."""
    with socket.create_server(("127.0.0.1", 0), backlog=50) as listener:
        yield listener.getsockname()[1]


@pytest.fixture
async def api(tmp_path: Path) -> AsyncIterator[httpx.AsyncClient]:
    async with (
        live_server(tmp_path, demo=True) as url,
        httpx.AsyncClient(base_url=f"{url}/api/v1/", timeout=ENDS_WITHIN_S) as api,
    ):
        yield api


def links(port: int) -> list[tuple[str, dict[str, Any]]]:
    url = f"socket://127.0.0.1:{port}"
    return [
        ("pd42-1241", {"kind": "tcp", "host": "127.0.0.1", "port": port}),
        ("tmc428", {"kind": "tcp", "host": "127.0.0.1", "port": port}),
        ("tmc4361", {"kind": "tcp", "host": "127.0.0.1", "port": port}),
        ("tmc5160", {"kind": "uart", "port": url, "node": 0}),
        ("tmc5160", {"kind": "landungsbruecke", "port": url}),
    ]


@pytest.mark.parametrize("which", range(5))
async def test_a_peer_that_talks_without_end(api: httpx.AsyncClient, talks: int, which: int) -> None:
    model, link = links(talks)[which]
    trial = await api.post("devices/test", json={"model": model, "link": link})
    assert (trial.status_code, trial.json()["ok"]) == (200, False)
    added = await api.post("devices", json={"name": "Talker", "model": model, "link": link})
    assert added.status_code == 201, added.text
    assert added.json()["state"] in ("connecting", "failed")
    for _ in range(3):
        results = (await api.post("stop")).json()["results"]
        assert all(result["took_ms"] <= 1000 for result in results if result["device"] == "talker")
        assert {result["ok"] for result in results if result["device"] == "talker"} == {False}
        assert all(result["ok"] for result in results if result["device"] != "talker")
    assert (await api.delete("devices/talker")).status_code == 204


async def test_a_silent_one_is_told_of_and_holds_up_nobody(api: httpx.AsyncClient, silent: int) -> None:
    link = {"kind": "tcp", "host": "127.0.0.1", "port": silent, "timeout_s": 5}
    devices = [{"name": name, "model": "tmc428", "link": link} for name in ("a", "b")]
    for added in await asyncio.gather(*(api.post("devices", json=device) for device in devices)):
        assert (added.status_code, added.json()["state"]) == (201, "connecting")
    results = (await api.post("stop")).json()["results"]
    assert all(result["ok"] for result in results if result["device"] not in ("a", "b"))
    told = [result for result in results if result["device"] in ("a", "b")]
    assert all(not result["ok"] and result["took_ms"] <= 1000 and result["problem"]["detail"] for result in told)
    assert len(told) == 6
    one = await api.post("devices/a/axes/0/stop")
    assert (one.status_code, one.json()["type"]) == (504, "/problems/no-reply")
