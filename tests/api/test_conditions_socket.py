"""The socket of conditions on a real server: a snapshot, then every change, and devices that go."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path
from typing import Any

import httpx
from websockets.asyncio.client import ClientConnection, connect

from app.client import AsyncBench, Bench
from tests.api.live import live_server


async def until(connection: ClientConnection, **wanted: Any) -> dict[str, Any]:
    """The next message that has these members, of its condition or its own."""
    async with asyncio.timeout(60):
        while True:
            message: dict[str, Any] = json.loads(await connection.recv())
            if wanted.items() <= {**message.get("condition", {}), **message}.items():
                return message


async def test_a_snapshot_and_then_what_changes(tmp_path: Path) -> None:
    async with live_server(tmp_path) as server, httpx.AsyncClient(base_url=f"{server}/api/v1/") as client:
        await client.post("devices", json={"name": "new", "model": "tmc5130", "link": {"kind": "emulator"}})
        address = f"{server.replace('http', 'ws', 1)}/api/v1/conditions"
        async with connect(address, subprotocols=["stepscope.conditions.v1"]) as connection:  # type: ignore[list-item]
            snapshot = json.loads(await connection.recv())
            assert snapshot["type"] == "snapshot"
            assert {(axis["device"], axis["axis"]) for axis in snapshot["axes"]} >= {("bench", 2), ("new", 0)}
            # The watch finds out by itself: nobody asks for the axis here.
            found = {axis["device"]: axis for axis in snapshot["axes"]}["new"]
            if found["condition"]["kind"] == "unknown":
                found = await until(connection, device="new", kind="cannot_move")
            assert (found["condition"]["kind"], found["ground_truth"]["lost_steps"]) == ("cannot_move", 0)
            await client.post("devices/bench/axes/1/move", json={"target": 20_000})
            await until(connection, device="bench", axis=1, kind="moving")
            arrived = await until(connection, device="bench", axis=1, kind="on_target")
            assert arrived["condition"]["cause"] == "at its target; lost steps would not be seen"
            await client.patch("devices/new", json={"name": "other"})
            assert await until(connection, type="removed", device="new")
            assert (await until(connection, type="condition", device="other"))["condition"]["kind"] == "cannot_move"
            await client.post("devices/other/disconnect")
            assert await until(connection, device="other", kind="not_connected")
            await client.delete("devices/other")
            assert await until(connection, type="removed", device="other")


async def test_a_server_whose_axes_rest_says_every_second_that_it_is_there(tmp_path: Path) -> None:
    async with (
        live_server(tmp_path) as server,
        connect(f"{server.replace('http', 'ws', 1)}/api/v1/conditions") as connection,
    ):
        for _ in range(2):
            await until(connection, type="alive")


async def test_a_page_that_dies_frees_the_bench(tmp_path: Path) -> None:
    anna = {"stepscope-session": "session-of-anna-0001"}
    async with live_server(tmp_path) as server, httpx.AsyncClient(base_url=f"{server}/api/v1/") as client:
        address = f"{server.replace('http', 'ws', 1)}/api/v1/conditions"
        async with connect(address) as connection:
            for said in ("", "{}", '{"session": 1}', '{"session": "session-of-anna-0001"}', "[]"):
                await connection.send(said)
            await connection.recv()
            assert (await client.post("lease", json={"name": "Anna"}, headers=anna)).json()["mine"]
            await connection.ping()
        async with asyncio.timeout(20):
            while (await client.get("lease")).json()["state"] != "free":  # noqa: ASYNC110 - nothing tells
                await asyncio.sleep(0.05)


async def test_clients_read_conditions_and_make_their_remedies(tmp_path: Path) -> None:
    async with live_server(tmp_path) as server:
        async with AsyncBench(server) as bench:
            await bench.add("new", "tmc5130")
            found = (await bench.axis("new", 0)).condition
            assert found.kind == "cannot_move"
            for remedy in found.remedies[1:]:
                await bench.remedy(remedy)
            await asyncio.sleep(0)
            assert (await bench.axis("new", 0)).condition.kind == "ready"
            kinds = {(each.device, each.axis): each.condition.kind for each in await bench.conditions()}
            assert kinds["new", 0] == "ready"

        def blocking() -> str:
            with Bench(server) as other:
                return next(each.condition.kind for each in other.conditions() if each.device == "new")

        assert await asyncio.to_thread(blocking) == "ready"
