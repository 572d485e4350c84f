"""Connections of strangers have limits, and a stop gets past all of them."""

from __future__ import annotations

import asyncio
import contextlib
import re
from collections.abc import AsyncIterator
from pathlib import Path

import pytest
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed

from app.connections import (
    DESCRIPTORS_KEPT,
    HEAD_BYTES_MAX,
    MESSAGE_BYTES_MAX,
    STOPS_KEPT,
    UNREAD_BYTES_MAX,
    Door,
    LimitedWebSocket,
    Limits,
)
from tests.api.live import live_server

TOTAL, OF_ADDRESS = 12, 9
HALF = b"GET /api/v1/devices HTTP/1.1\r\nHost: 127.0.0.1\r\n"
CONDITIONS = "/api/v1/conditions"
UPGRADE = (
    f"GET {CONDITIONS} HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\n\r\n"
).encode()
Streams = tuple[asyncio.StreamReader, asyncio.StreamWriter]
PATIENCE_S = 20.0


class Visitors:
    """Everybody who talks to one server."""

    def __init__(self, url: str) -> None:
        self.url = url
        self.port = int(url.rpartition(":")[2])
        self.all: list[Streams] = []

    async def come(self, said: bytes = b"") -> Streams:
        streams = await asyncio.open_connection("127.0.0.1", self.port)
        self.all.append(streams)
        streams[1].write(said)
        await streams[1].drain()
        return streams

    async def ask(self, method: str, path: str) -> int:
        """The status of one request over a connection of its own."""
        reader, _ = await self.come(f"{method} /api/v1/{path} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode())
        return await status_of(reader)

    async def left(self) -> int:
        """How many connections were not ended by the server."""
        ended = 0
        for reader, _ in self.all:
            with contextlib.suppress(TimeoutError, ConnectionError):
                async with asyncio.timeout(0.01):
                    while await reader.read(65_536):
                        pass
            ended += reader.at_eof() or reader.exception() is not None
        return len(self.all) - ended


async def status_of(reader: asyncio.StreamReader) -> int:
    async with asyncio.timeout(PATIENCE_S):
        line = await reader.readline()
    found = re.match(rb"HTTP/1.1 (\d+)", line)
    assert found, line
    return int(found[1])


async def upgraded(visitors: Visitors) -> Streams:
    """A WebSocket without a client that knows how it should behave."""
    reader, writer = await visitors.come(UPGRADE)
    async with asyncio.timeout(PATIENCE_S):
        await reader.readuntil(b"\r\n\r\n")
    return reader, writer


async def cut_off(visitors: Visitors, begun: bytes, pieces_of: int) -> bool:
    """Whether the server ends a connection whose client goes on with its message, whatever it is told."""
    _, writer = await upgraded(visitors)
    writer.write(begun)
    async with asyncio.timeout(PATIENCE_S):
        with contextlib.suppress(ConnectionError):
            while True:
                writer.write(bytes(pieces_of))
                await writer.drain()
                await asyncio.sleep(0.001)
    return True


async def ended(reader: asyncio.StreamReader) -> bool:
    """Whether the server ends that connection, before this test loses its patience."""
    async with asyncio.timeout(PATIENCE_S):
        with contextlib.suppress(ConnectionError):
            await reader.read()
    return True


@pytest.fixture
async def visitors(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[Visitors]:
    monkeypatch.setattr("app.connections.CONNECTIONS_MAX", TOTAL)
    async with live_server(tmp_path) as url:
        visitors = Visitors(url)
        yield visitors
        for _, writer in visitors.all:
            writer.close()


def test_limits_leave_descriptors_for_links_and_for_stops() -> None:
    limits = Limits.of_descriptors(1024)
    assert limits.total + STOPS_KEPT + DESCRIPTORS_KEPT <= 1024
    assert 500 < limits.of_address < limits.total


async def test_connections_without_a_request_make_room(visitors: Visitors) -> None:
    first = await visitors.come(HALF)
    for _ in range(4 * TOTAL):
        await visitors.come(HALF)
        assert await visitors.ask("POST", "stop") == 200
    assert await ended(first[0])
    assert await visitors.left() <= OF_ADDRESS
    assert await visitors.ask("GET", "devices") == 200


async def test_what_is_in_use_is_not_cut_off_and_a_stop_comes_in_all_the_same(visitors: Visitors) -> None:
    socket = visitors.url.replace("http", "ws") + "/api/v1/devices/bench/telemetry?channels=position.0"
    async with contextlib.AsyncExitStack() as stack:
        readers = [await stack.enter_async_context(connect(socket)) for _ in range(OF_ADDRESS)]
        for _ in range(5):
            assert await visitors.ask("GET", "devices") == 503
            assert await visitors.ask("POST", "stop") == 200
            assert await visitors.ask("POST", "devices/bench/axes/0/stop") == 200
        for reader in readers:
            async with asyncio.timeout(PATIENCE_S):
                await reader.recv()
    async with asyncio.timeout(PATIENCE_S):
        while await visitors.ask("GET", "devices") != 200:
            pass  # the server hears one after the other that they have gone


@pytest.mark.parametrize("said", [b"", b"GET ", HALF, HALF + b"a: b\r\n"])
async def test_a_head_has_a_deadline(visitors: Visitors, monkeypatch: pytest.MonkeyPatch, said: bytes) -> None:
    monkeypatch.setattr("app.connections.HEAD_WITHIN_S", 0.2)
    reader, _ = await visitors.come(said)
    assert await ended(reader)


async def test_dripping_does_not_put_it_off(visitors: Visitors, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.connections.HEAD_WITHIN_S", 0.5)
    reader, writer = await visitors.come(HALF)
    ending = asyncio.create_task(ended(reader))
    while not ending.done():
        writer.write(b"a: b\r\n")
        await asyncio.sleep(0.02)
    assert await ending


async def test_a_body_has_a_deadline(visitors: Visitors, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.connections.BODY_WITHIN_S", 0.2)
    reader, _ = await visitors.come(b"POST /api/v1/stop HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 100\r\n\r\n{")
    assert await ended(reader)


@pytest.mark.parametrize("part", [b"x" * 4096, b"a: " + b"b" * 500 + b"\r\n"])
async def test_a_long_head_is_refused_and_not_kept(visitors: Visitors, part: bytes) -> None:
    reader, writer = await visitors.come(HALF)
    sent = 0
    with contextlib.suppress(ConnectionError):
        while sent < 100 * HEAD_BYTES_MAX and not reader.at_eof():
            writer.write(part)
            await writer.drain()
            sent += len(part)
    assert sent < 100 * HEAD_BYTES_MAX
    with contextlib.suppress(ConnectionError):
        assert await status_of(reader) == 431


async def test_a_body_that_nobody_wanted_is_not_read_for_ever(visitors: Visitors) -> None:
    reader, writer = await visitors.come(
        b"POST /api/v1/nothing HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\n\r\n"
    )
    assert await status_of(reader) == 404
    sent, chunk = 0, b"10000\r\n" + b"x" * 0x10000 + b"\r\n"
    with contextlib.suppress(ConnectionError):
        while sent < 64 << 20:
            writer.write(chunk)
            await writer.drain()
            sent += len(chunk)
    assert sent < 64 << 20


async def test_a_long_body_waits_for_its_turn_and_nobody_else_does(
    visitors: Visitors, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.connections.PIECE_EVERY_S", 3600.0)
    head = b"POST /api/v1/devices HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 1000000\r\n\r\n"
    reader, writer = await visitors.come(head)
    answered = asyncio.create_task(reader.readline())
    sending = asyncio.create_task(_send_in_pieces(writer, 1_000_000))
    for _ in range(OF_ADDRESS - 2):  # one more would take the place of the body
        assert await visitors.ask("POST", "stop") == 200
    assert not answered.done()
    sending.cancel()
    answered.cancel()


async def test_a_long_body_is_read_to_its_end(visitors: Visitors) -> None:
    head = b"POST /api/v1/devices HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 1000000\r\n\r\n"
    reader, writer = await visitors.come(head)
    await _send_in_pieces(writer, 1_000_000)
    assert await status_of(reader) == 422


async def _send_in_pieces(writer: asyncio.StreamWriter, size: int) -> None:
    for _ in range(0, size, 10_000):
        writer.write(b"x" * 10_000)
        await writer.drain()


async def test_what_a_websocket_says_waits_for_its_turn_and_nobody_else_does(
    visitors: Visitors, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.connections.PIECE_EVERY_S", 3600.0)
    async with connect(visitors.url.replace("http", "ws") + CONDITIONS) as socket:
        answered = asyncio.ensure_future(await socket.ping())
        for _ in range(OF_ADDRESS - 2):
            assert await visitors.ask("POST", "stop") == 200
            await socket.recv()  # what it is told does not wait
        assert not answered.done()
        socket.transport.abort()  # else it waits for the answer to its goodbye


async def test_a_long_message_is_read_to_its_end_and_a_longer_one_ends_the_websocket(visitors: Visitors) -> None:
    async with asyncio.timeout(PATIENCE_S), connect(visitors.url.replace("http", "ws") + CONDITIONS) as socket:
        await socket.send(["x" * 10_000] * 6)
        await (await socket.ping())
        await socket.send("x" * (MESSAGE_BYTES_MAX + 1))
        with contextlib.suppress(ConnectionClosed):
            while True:
                await socket.recv()
        assert socket.close_code == 1009


async def test_why_a_long_message_was_refused_is_heard_by_who_still_sends_it(visitors: Visitors) -> None:
    """A socket closed over what it has not read takes back what it said last: the client would hear of no reason."""
    reader, writer = await upgraded(visitors)
    async with asyncio.timeout(PATIENCE_S):
        length = UNREAD_BYTES_MAX - MESSAGE_BYTES_MAX
        writer.write(b"\x82\xff" + length.to_bytes(8, "big") + bytes(4))
        for _ in range(length // 4096):
            writer.write(bytes(4096))
            await writer.drain()
        writer.write_eof()
        said = await reader.read()
    assert b"\x03\xf1" in said, "1009"
    assert len(visitors.all) - await visitors.left() == 1


async def test_what_comes_behind_a_refused_message_has_bounds(
    visitors: Visitors, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.connections.GOODBYE_S", 0.1)
    too_long = b"\x82\xff" + (1 << 40).to_bytes(8, "big") + bytes(4)
    assert await cut_off(visitors, too_long, pieces_of=1)
    monkeypatch.setattr("app.connections.GOODBYE_S", 3600.0)
    assert await cut_off(visitors, too_long, pieces_of=65_536)


async def test_an_end_between_a_goodbye_and_its_last_byte_is_none_of_a_fault(
    visitors: Visitors, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The page is closed while the server ends: what uvicorn does to all connections then may not fail."""
    failures: list[Exception] = []
    received = LimitedWebSocket.data_received

    def and_end(websocket: LimitedWebSocket, data: bytes) -> None:
        received(websocket, data)
        if data[0] == 0x88:  # a goodbye
            try:
                websocket.shutdown()
            except Exception as failure:
                failures.append(failure)

    async with connect(visitors.url.replace("http", "ws") + CONDITIONS) as socket:
        await socket.recv()
        monkeypatch.setattr(LimitedWebSocket, "data_received", and_end)
    assert failures == []
    assert socket.close_code == 1000


async def test_who_takes_no_answers_is_not_read_any_further_and_ended(
    visitors: Visitors, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.connections.PIECE_EVERY_S", 0.0)
    monkeypatch.setattr("app.connections.UNTAKEN_S", 0.1)
    head = (
        f"GET {CONDITIONS} HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
    )
    reader, writer = await visitors.come(head.encode())
    await reader.readuntil(b"\r\n\r\n")
    writer.transport.pause_reading()  # type: ignore[attr-defined]  # of asyncio's own transports
    pings = (b"\x89\xfd\0\0\0\0" + b"x" * 125) * 100
    rounds = 0
    with contextlib.suppress(ConnectionError):
        while rounds < 10_000:
            writer.write(pings)
            await writer.drain()
            rounds += 1
    assert rounds < 10_000


async def test_each_address_has_its_turn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.connections.PIECE_EVERY_S", 0.0)
    door, turns = Door(Limits(1, 1)), list[str]()
    all_done = asyncio.Event()

    def hold(address: str, name: str, *, open_still: bool = True) -> None:
        def release() -> bool:
            turns.append(name)
            if len(turns) == 6:
                all_done.set()
            return open_still

        door.hold(address, release)

    for number in range(4):
        hold("flood", f"flood {number}")
    hold("gone", "gone", open_still=False)
    hold("guest", "guest")
    async with asyncio.timeout(PATIENCE_S):
        await all_done.wait()
    assert turns == ["flood 0", "gone", "guest", "flood 1", "flood 2", "flood 3"]


async def test_a_connection_serves_many_requests_one_after_another(visitors: Visitors) -> None:
    reader, writer = await visitors.come()
    for _ in range(30):
        writer.write(
            b"POST /api/v1/stop HTTP/1.1\r\nHost: 127.0.0.1\r\n"
            b"Content-Type: application/json\r\nContent-Length: 2\r\n\r\n{}"
        )
        assert await status_of(reader) == 200
        head = await reader.readuntil(b"\r\n\r\n")
        length = re.search(rb"content-length: (\d+)", head)
        assert length
        await reader.readexactly(int(length[1]))
