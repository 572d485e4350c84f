"""The telemetry socket of a real server: what comes first, what comes then, and what is refused."""

from __future__ import annotations

import asyncio
import contextlib
import json
import socket as sockets
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidStatus

from app.telemetry.frames import Frame, decode
from app.telemetry.history import HISTORY_RATE_HZ, REST_RATE_HZ
from tests.api.live import live_server

BENCH = "devices/bench/telemetry"


@pytest.fixture
async def server(tmp_path: Path) -> AsyncIterator[str]:
    async with live_server(tmp_path) as url:
        yield url


@pytest.fixture
async def api(server: str) -> AsyncIterator[httpx.AsyncClient]:
    async with httpx.AsyncClient(base_url=f"{server}/api/v1/") as client:
        yield client


def socket(server: str, address: str, **options: Any) -> connect:
    return connect(f"{server.replace('http', 'ws', 1)}/api/v1/{address}", max_size=None, compression=None, **options)


class Stream:
    """A client: the first message, then rows and messages as they come."""

    def __init__(self, connection: ClientConnection) -> None:
        self.connection = connection
        self.frames: list[Frame] = []
        self.messages: list[dict[str, Any]] = []

    async def message(self) -> dict[str, Any]:
        message: dict[str, Any] = json.loads(await self.connection.recv(decode=True))
        return message

    async def read(self, rows: int) -> tuple[Any, Any]:
        """At least so many more rows: time [rows], columns [columns, rows]."""
        first, found = len(self.frames), 0
        while found < rows:
            received = await asyncio.wait_for(self.connection.recv(), 10)
            if isinstance(received, str):
                self.messages.append(json.loads(received))
            else:
                self.frames.append(decode(received))
                found += len(self.frames[-1].time_s)
        return self._rows(first)

    async def read_until(self, time_s: float) -> tuple[Any, Any]:
        """The same, up to a row of that time [s] at the least."""
        first = len(self.frames)
        while len(self.frames) == first or self.frames[-1].time_s[-1] < time_s:
            await self.read(1)
        return self._rows(first)

    def _rows(self, first: int) -> tuple[Any, Any]:
        frames = self.frames[first:]
        return np.concatenate([f.time_s for f in frames]), np.hstack([f.columns for f in frames])


async def test_the_first_message_says_what_comes(server: str) -> None:
    address = f"{BENCH}?channels=position.0,velocity.2&rate_hz=250"
    async with socket(server, address, subprotocols=["stepscope.telemetry.v1"]) as connection:
        assert connection.subprotocol == "stepscope.telemetry.v1"
        stream = Stream(connection)
        start = await stream.message()
        assert start["type"] == "start"
        assert start["device"] == "bench"
        assert start["channels"] == [
            {"name": "position.0", "unit": "microsteps"},
            {"name": "velocity.2", "unit": "pps"},
        ]
        assert (start["rate_hz"], start["requested_rate_hz"], start["chip_timed"]) == (250, 250, True)
        assert start["history_rows"] == 0
        time_s, columns = await stream.read(100)
        assert columns.shape[0] == 2
        np.testing.assert_allclose(np.diff(time_s), 1 / 250, atol=1e-9)
        assert [frame.sequence for frame in stream.frames] == list(range(len(stream.frames)))
        assert {frame.dropped for frame in stream.frames} == {0}


async def test_a_move_is_announced_and_seen(server: str, api: httpx.AsyncClient) -> None:
    async with socket(server, f"{BENCH}?channels=position.0,residual.0&rate_hz=1000") as connection:
        stream = Stream(connection)
        await stream.message()
        started = (await api.post("devices/bench/axes/0/move", json={"target": 2000})).json()
        time_s, columns = await stream.read_until(started["started_at_s"] + started["predicted_duration_s"] + 0.1)
        moves = [message for message in stream.messages if message["type"] == "move"]
        assert moves == [{"type": "move", "axis": 0, "started_at_s": started["started_at_s"]}]
        position, residual = columns
        assert position[0] == 0
        assert position[-1] == 2000
        assert time_s[np.flatnonzero(position)[0]] >= started["started_at_s"]
        # The phase of the chip's ramp ticks (256 us here) cannot be known: at 28 kpps that is 7 microsteps.
        assert np.nanmax(np.abs(residual)) <= 8


async def test_a_reloaded_page_has_its_past_before_the_present(server: str) -> None:
    async with socket(server, f"{BENCH}?channels=position.0&rate_hz=1000") as connection:
        reader = Stream(connection)
        await reader.message()
        before_s, _ = await reader.read(500)
    async with socket(server, f"{BENCH}?channels=position.0&rate_hz=1000&history_s=60") as connection:
        stream = Stream(connection)
        start = await stream.message()
        past_s, _ = await stream.read(start["history_rows"])
        assert len(past_s) == start["history_rows"]
        # A machine with more to do than it can lets the history rest.
        assert past_s[0] <= before_s[0] + 1 / REST_RATE_HZ
        assert past_s[-1] >= before_s[-1] - 1 / REST_RATE_HZ
        assert len(past_s) <= (past_s[-1] - past_s[0]) * HISTORY_RATE_HZ + 2
        live_s, _ = await stream.read(50)
        assert live_s[0] >= past_s[-1]


async def test_a_status_comes_every_second(server: str) -> None:
    async with socket(server, f"{BENCH}?channels=position.0&rate_hz=200&batch_hz=20") as connection:
        stream = Stream(connection)
        await stream.message()
        await stream.read(260)
        (status, *_) = [message for message in stream.messages if message["type"] == "status"]
        assert status["achieved_rate_hz"] == pytest.approx(200, rel=0.1)
        assert status["dropped"] == 0
        assert status["jitter_ms"] < 0.001
        assert 0 <= status["latency_ms"] < 500
        assert len(stream.frames) == pytest.approx(1.3 * 20, abs=8)


@pytest.mark.parametrize(
    ("limit", "words"), [("SUBSCRIPTIONS_MAX", "different ways"), ("HISTORY_BYTES_MAX", "on their way")]
)
async def test_what_readers_may_use_up_is_told(
    server: str, monkeypatch: pytest.MonkeyPatch, limit: str, words: str
) -> None:
    monkeypatch.setattr(f"app.telemetry.hub.{limit}", -1)
    async with socket(server, f"{BENCH}?channels=position.0&history_s=5") as connection:
        problem = (await Stream(connection).message())["problem"]
        assert (problem["status"], problem["type"]) == (409, "/problems/wrong-state")
        assert words in problem["detail"]


@pytest.mark.parametrize(
    ("address", "status", "words"),
    [
        (f"{BENCH}?channels=position.9", 404, "position.9"),
        (f"{BENCH}?channels=", 422, "channels"),
        (BENCH, 422, "channels"),
        ("devices/nothing/telemetry?channels=position.0", 404, "nothing"),
        (f"{BENCH}?channels=position.0&rate_hz=0.5", 422, "1..1000"),
        (f"{BENCH}?channels=position.0&rate_hz=1001", 422, "1..1000"),
        (f"{BENCH}?channels=position.0&rate_hz=nan", 422, "1..1000"),
        (f"{BENCH}?channels=position.0&rate_hz=fast", 422, "rate_hz"),
        (f"{BENCH}?channels=position.0&batch_hz=0", 422, "batch_hz"),
        (f"{BENCH}?channels=position.0&history_s=-1", 422, "history_s"),
        (f"{BENCH}?channels={','.join(f'x.{n}' for n in range(129))}", 422, "channels"),
    ],
)
async def test_what_cannot_be_streamed_is_told_and_closed(server: str, address: str, status: int, words: str) -> None:
    async with socket(server, address) as connection:
        problem = (await Stream(connection).message())["problem"]
        assert problem["status"] == status
        assert words in problem["detail"]
        with pytest.raises(ConnectionClosed) as closed:
            await connection.recv()
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == 4000 + status


async def test_another_subprotocol_is_refused(server: str) -> None:
    with pytest.raises(InvalidStatus) as refused:
        async with socket(server, f"{BENCH}?channels=position.0", subprotocols=["bench.v9"]):
            pass
    assert refused.value.response.status_code == 403


@pytest.mark.parametrize("origin", ["http://evil.com", "null", "http://127.0.0.1:1"])
async def test_a_foreign_page_gets_no_socket(server: str, origin: str) -> None:
    with pytest.raises(InvalidStatus) as refused:
        async with socket(server, f"{BENCH}?channels=position.0", origin=origin):
            pass
    assert refused.value.response.status_code == 403
    assert json.loads(refused.value.response.body or b"")["type"] == "/problems/foreign-origin"


async def test_our_own_page_gets_one(server: str) -> None:
    async with socket(server, f"{BENCH}?channels=position.0", origin=server) as connection:
        assert (await Stream(connection).message())["type"] == "start"


async def test_no_such_socket(server: str) -> None:
    with pytest.raises(InvalidStatus):
        async with socket(server, "devices/bench/telemetri"):
            pass


async def test_a_removed_device_closes_the_socket(server: str, api: httpx.AsyncClient) -> None:
    async with socket(server, f"{BENCH}?channels=position.0") as connection:
        stream = Stream(connection)
        await stream.message()
        await api.delete("devices/bench")
        with pytest.raises(ConnectionClosed) as closed:
            await stream.read(10_000)
        assert stream.messages[-1]["type"] == "gap"
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == 4410


async def test_a_reader_that_does_not_read_loses_rows_and_nobody_else_does(tmp_path: Path) -> None:
    """The kernel's buffers are made small, so that the server's bounded queue is what holds, not the network."""
    address = f"{BENCH}?channels=" + ",".join(
        f"{name}.{axis}" for axis in range(3) for name in ("position", "velocity")
    )
    async with (
        live_server(tmp_path, send_buffer_bytes=8192) as server,
        socket(server, f"{address}&rate_hz=1000") as good,
        _deaf(server, f"{address}&rate_hz=1000") as deaf,
    ):
        reader = Stream(good)
        await reader.message()
        await reader.read(4500)
        assert reader.frames[-1].dropped == 0
        received, drops = b"", [0]
        async with asyncio.timeout(10):
            while max(drops) < 300:
                more = await deaf.read(1 << 16)
                assert more, received
                received += more
                drops = [int.from_bytes(received[at + 16 : at + 24], "little") for at in _frames(received)] or [0]
        assert max(drops) < 4500


def _frames(received: bytes) -> list[int]:
    places, at = [], received.find(b"SSC1")
    while 0 <= at <= len(received) - 24:
        places.append(at)
        at = received.find(b"SSC1", at + 1)
    return places


@contextlib.asynccontextmanager
async def _deaf(server: str, address: str) -> AsyncIterator[asyncio.StreamReader]:
    """A socket with a small window that upgrades and then does not read."""
    host, _, port = server.removeprefix("http://").partition(":")
    raw = sockets.socket()
    raw.setsockopt(sockets.SOL_SOCKET, sockets.SO_RCVBUF, 4096)
    raw.setblocking(False)
    await asyncio.get_running_loop().sock_connect(raw, (host, int(port)))
    reader, writer = await asyncio.open_connection(sock=raw, limit=1024)
    writer.write(
        f"GET /api/v1/{address} HTTP/1.1\r\nHost: {host}:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        "Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
    )
    await writer.drain()
    try:
        yield reader
    finally:
        writer.close()
        with contextlib.suppress(ConnectionError):
            await writer.wait_closed()


async def test_ten_readers_at_once_lose_nothing(server: str) -> None:
    address = f"{BENCH}?channels=position.0,velocity.0,position.1,velocity.1&rate_hz=1000"

    async def one() -> Stream:
        async with socket(server, address) as connection:
            stream = Stream(connection)
            await stream.message()
            await stream.read(1500)
            return stream

    for stream in await asyncio.gather(*(one() for _ in range(10))):
        steps_s = np.diff(np.concatenate([frame.time_s for frame in stream.frames]))
        np.testing.assert_allclose(steps_s, 1e-3, atol=1e-9)
        assert stream.frames[-1].dropped == 0


async def until(stream: Stream, kind: str, **wanted: object) -> dict[str, Any]:
    """Read on until a message of that kind, with these fields, has come."""
    while True:
        await stream.read(20)
        for message in stream.messages:
            if message["type"] == kind and wanted.items() <= message.items():
                return message


async def test_the_end_of_a_motion_is_told_with_its_reason(server: str, api: httpx.AsyncClient) -> None:
    await api.post("devices", json={"name": "motor", "model": "pd42-1241", "link": {"kind": "emulator"}})
    address = "devices/motor/telemetry?channels=position.0,velocity.0,deviation.0&rate_hz=200"
    async with socket(server, address) as connection:
        stream = Stream(connection)
        await stream.message()
        await api.post("devices/motor/axes/0/move", json={"target": 5000})
        stopped = await until(stream, "stopped")
        assert {"type": "stopped", "axis": 0, "reason": "target_reached", "position": 5000}.items() <= stopped.items()
        first = (await api.get("devices/motor/axes/0/stops")).json()[0]
        assert {
            key: first[key] for key in ("axis", "reason", "time_s", "position", "detail")
        }.items() <= stopped.items()
        assert any(message["type"] == "move" for message in stream.messages)
        status = await until(stream, "status", calls_per_s_possible=None)
        assert status["row_spread_ms"] == 0  # an emulator answers all questions at one moment


async def test_over_a_wire_the_status_tells_what_it_carries(server: str, api: httpx.AsyncClient, far_line: str) -> None:
    link = {"kind": "serial", "port": far_line, "baud": 115_200}
    made = (await api.post("devices", json={"name": "far", "model": "pd42-1241", "link": link})).json()
    assert made["state"] == "connected", made["problem"]
    address = "devices/far/telemetry?channels=position.0,velocity.0&rate_hz=100"
    async with socket(server, address) as connection:
        stream = Stream(connection)
        assert not (await stream.message())["chip_timed"]
        await until(stream, "status")
        stream.messages.clear()
        status = await until(stream, "status")
        assert status["calls_per_s"] > 2 * 0.5 * status["achieved_rate_hz"]
        assert status["row_spread_ms"] > 0
        assert status["calls_per_s_possible"] in (None, pytest.approx(115_200 / 180))
