"""The socket of a program: what is told, to whom, and that the wire is left alone while nobody listens."""

from __future__ import annotations

import asyncio
import json
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from tests.api.live import live_server

PROTOCOL: Any = "stepscope.program.v1"
COUNTS = """\
Loop:
    CALC ADD, 1
    AGP 7, 2
    CSUB Rest
    JA Loop
Rest:
    WAIT TICKS, 0, 2
    RSUB
"""


@pytest.fixture
async def server(tmp_path: Path) -> AsyncIterator[str]:
    async with live_server(tmp_path) as url:
        yield url


@pytest.fixture
async def api(server: str) -> AsyncIterator[httpx.AsyncClient]:
    async with httpx.AsyncClient(base_url=f"{server}/api/v1/") as client:
        made = await client.post("devices", json={"name": "Motor", "model": "pd42-1241", "link": {"kind": "emulator"}})
        assert made.status_code == 201, made.text
        yield client


def watch(server: str, device: str = "motor") -> connect:
    address = f"{server.replace('http', 'ws', 1)}/api/v1/devices/{device}/program/watch"
    return connect(address, subprotocols=[PROTOCOL], compression=None)


async def said(connection: ClientConnection, *, until: str = "") -> dict[str, Any]:
    """The next message, or the next of type `until`."""
    async with asyncio.timeout(10):
        while True:
            message: dict[str, Any] = json.loads(await connection.recv())
            if not until or message["type"] == until:
                return message


async def test_a_program_is_followed(server: str, api: httpx.AsyncClient) -> None:
    assert (await api.put("devices/motor/program", json={"text": COUNTS})).status_code == 200
    async with watch(server) as connection:
        start = await said(connection)
        assert (start["type"], start["device"], start["rate_hz"]) == ("start", "motor", 20)
        first = await said(connection)
        assert (first["type"], first["status"], first["counter"], first["stack"]) == ("state", "stopped", 0, [])
        assert (await said(connection))["type"] == "alive"  # nothing has changed: nothing else is told
        await connection.send(json.dumps({"variables": [7]}))
        await api.post("devices/motor/program/run", json={"address": 0})
        seen = [await said(connection, until="state") for _ in range(40)]
        running = [each for each in seen if each["status"] == "running" and each["variables"]]
        values = [each["variables"]["7"] for each in running]
        assert values == sorted(values)
        assert values[-1] > values[0]
        waiting = [each["stack"] for each in running if each["counter"] == 4]
        assert len(waiting) > len(running) / 2  # where the program is for most of its time
        assert [3] in waiting
        times = [each["time_s"] for each in running]
        rate_hz = (len(times) - 1) / (times[-1] - times[0])
        assert rate_hz <= 21  # how fast at least is measured in `make bench`
        await api.post("devices/motor/axes/0/stop", json={"mode": "ramp"})
        while (await said(connection, until="state"))["status"] != "stopped":
            pass


async def test_single_steps_are_told_one_by_one(server: str, api: httpx.AsyncClient) -> None:
    await api.put("devices/motor/program", json={"text": COUNTS})
    async with watch(server) as connection:
        await said(connection, until="state")
        await api.post("devices/motor/program/debug", json={"from_start": True, "breakpoints": [3]})
        trace: list[int] = []
        halted = False
        while not halted:  # one message may tell all of it
            message = await said(connection, until="state")
            trace += message["trace"]
            halted = message["debug"]["halted_at"] is not None
        assert trace == [0, 1, 2, 4, 5]
        assert message["debug"]["halted_at"] == 3
        assert message["counter"] == 3


async def test_runs_and_halts_are_marks_of_scope_and_recordings(server: str, api: httpx.AsyncClient) -> None:
    assert (await api.put("devices/motor/program", json={"text": COUNTS})).status_code == 200
    body = {"device": "motor", "channels": ["position.0"], "rate_hz": 50}
    recording = (await api.post("recordings", json=body)).json()["id"]
    await api.post("devices/motor/program/debug", json={"breakpoints": [5], "from_start": True})
    async with watch(server) as connection:
        while (await said(connection, until="state"))["debug"]["halted_at"] is None:
            pass
    await api.post("devices/motor/program/run", json={"address": 0})
    await api.post("devices/motor/program/stop")
    wanted = [
        "program reset",
        "program by single steps from 0",
        "program halted at 5, a breakpoint",
        "program begins at 0",
        "program stopped",
    ]
    await api.post(f"recordings/{recording}/stop")
    marks = (await api.get(f"recordings/{recording}")).json()["marks"]
    assert [mark["text"] for mark in marks if mark["kind"] == "program"] == wanted
    # a scope that is opened later has them with its past
    address = f"{server.replace('http', 'ws', 1)}/api/v1/devices/motor/telemetry?channels=position.0&history_s=60"
    told: list[str] = []
    async with connect(address, subprotocols=["stepscope.telemetry.v1"]) as scope, asyncio.timeout(10):  # type: ignore[list-item]
        while len(told) < len(wanted):
            text = await scope.recv()
            if isinstance(text, str) and (message := json.loads(text))["type"] == "program":
                told.append(message["text"])
    assert told == wanted


async def test_nothing_is_asked_in_download_mode(server: str, api: httpx.AsyncClient) -> None:
    async with watch(server) as connection:
        await said(connection, until="state")
        await api.post("devices/motor/tmcl", json={"command": 132, "value": 5})
        lost = await said(connection, until="lost")
        assert lost["problem"]["type"] == "/problems/download-mode"
        await asyncio.sleep(0.2)
        pointer = (await api.get("devices/motor/emulator")).json()["application"]
        assert (pointer["downloading"], pointer["commands"]) == (True, 0)
        await api.post("devices/motor/tmcl", json={"command": 133})
        assert (await said(connection, until="state"))["downloading"] is False


async def test_what_is_refused(server: str, api: httpx.AsyncClient) -> None:
    for device, status in (("bench", 4409), ("nobody", 4404)):
        async with watch(server, device) as connection:
            assert (await said(connection))["type"] == "refused"
            with pytest.raises(ConnectionClosed):
                await connection.recv()
            assert connection.close_code == status
    async with watch(server) as connection:
        for words in ("{}", '{"variables": [256]}', json.dumps({"variables": list(range(65))})):
            await connection.send(words)
            assert "variables" in (await said(connection, until="refused"))["problem"]["detail"]
        async with watch(server) as other:
            await connection.send(json.dumps({"variables": list(range(40))}))
            await other.send(json.dumps({"variables": list(range(30, 80))}))
            assert "80 variables" in (await said(other, until="refused"))["problem"]["detail"]


async def test_clients_without_end(server: str, api: httpx.AsyncClient) -> None:
    connections = [await watch(server) for _ in range(16)]
    async with watch(server) as one_more:
        assert "16 clients" in (await said(one_more, until="refused"))["problem"]["detail"]
    for connection in connections:
        await connection.close()
