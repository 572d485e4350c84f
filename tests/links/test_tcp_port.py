"""The raw TCP link against a real loopback server: no old answer ever answers a new question."""

from __future__ import annotations

import asyncio
import socket
import time

import pytest

from app.clock import VirtualClock
from app.errors import BadReply, LinkDown, LinkTimeout, OutOfRange, UnknownThing, UsageError
from app.links.registry import open_port, tcp_factory
from app.links.tcp import TcpPort
from tests.links.pty_module import until
from tests.links.server import echo, serving

SHORT_S = 0.05
"""Time-out of exchanges that are meant to run into it: the server of these tests is silent on purpose."""


async def test_frames_go_there_and_back_without_delay() -> None:
    async with serving() as server:
        port = TcpPort("127.0.0.1", server.port)
        started = time.perf_counter()
        for number in range(200):
            frame = number.to_bytes(4, "big")
            assert await port.exchange(frame) == frame
        # Nagle's algorithm would cost 40 ms each.
        assert time.perf_counter() - started < 2.0
        assert server.connections == port.connections == 1
        await port.aclose()
        await port.aclose()


async def test_a_connection_that_is_made_after_the_port_was_closed_is_closed_too() -> None:
    async with serving() as server:
        port = TcpPort("127.0.0.1", server.port)
        asked = asyncio.create_task(port.exchange(b"late"))
        await asyncio.sleep(0)  # the connection is under way
        await port.aclose()
        with pytest.raises(LinkDown, match="closed while it was opened"):
            await asked
        await until(lambda: server.connections == server.ended == 1)
        assert port.connections == 0


async def test_a_late_answer_never_answers_the_next_question() -> None:
    first_asked = asyncio.Event()
    release = asyncio.Event()

    async def late_once(frame: bytes, writer: asyncio.StreamWriter) -> None:
        if not first_asked.is_set():
            first_asked.set()
            await release.wait()
        writer.write(frame)

    async with serving(late_once) as server:
        port = TcpPort("127.0.0.1", server.port, timeout_s=SHORT_S)
        with pytest.raises(LinkTimeout) as caught:
            await port.exchange(b"old!")
        assert caught.value.waited_s == SHORT_S
        release.set()
        for _ in range(20):
            assert await port.exchange(b"new?", timeout_s=5.0) == b"new?"
        assert server.connections == 2
        await port.aclose()


async def test_half_an_answer_is_a_bad_reply_and_ends_the_connection() -> None:
    async def half(frame: bytes, writer: asyncio.StreamWriter) -> None:
        writer.write(frame[:2])

    async with serving(half) as server:
        port = TcpPort("127.0.0.1", server.port, timeout_s=SHORT_S)
        with pytest.raises(BadReply) as caught:
            await port.exchange(b"abcd")
        assert caught.value.reply == b"ab"
        server.behave = echo
        assert await port.exchange(b"efgh", timeout_s=5.0) == b"efgh"
        assert server.connections == 2
        await port.aclose()


async def test_an_answer_in_pieces_is_one_answer() -> None:
    async def pieces(frame: bytes, writer: asyncio.StreamWriter) -> None:
        for byte in frame:
            writer.write(bytes([byte]))
            await writer.drain()
            await asyncio.sleep(0.002)

    async with serving(pieces) as server:
        port = TcpPort("127.0.0.1", server.port, timeout_s=5.0)
        assert await port.exchange(b"abcd") == b"abcd"
        await port.aclose()


async def test_too_long_an_answer_is_a_bad_reply() -> None:
    async def twice(frame: bytes, writer: asyncio.StreamWriter) -> None:
        writer.write(frame + b"!")

    async with serving(twice) as server:
        port = TcpPort("127.0.0.1", server.port, timeout_s=5.0)
        with pytest.raises(BadReply):
            await port.exchange(b"abcd")
        await port.aclose()


async def test_bytes_that_nobody_asked_for_make_a_new_connection() -> None:
    async with serving() as server:
        port = TcpPort("127.0.0.1", server.port, timeout_s=5.0)
        assert await port.exchange(b"abcd") == b"abcd"
        server.writers[0].write(b"junk")
        await server.writers[0].drain()
        await asyncio.sleep(0.05)  # the bytes have to cross the loopback before they can be noticed
        assert await port.exchange(b"efgh") == b"efgh"
        assert server.connections == 2
        await port.aclose()


async def test_the_other_side_hangs_up() -> None:
    async def hang_up(frame: bytes, writer: asyncio.StreamWriter) -> None:
        writer.close()

    async with serving(hang_up) as server:
        port = TcpPort("127.0.0.1", server.port, timeout_s=5.0)
        with pytest.raises(LinkDown, match="closed by the other side"):
            await port.exchange(b"abcd")
        server.behave = echo
        assert await port.exchange(b"efgh") == b"efgh"
        await port.aclose()


async def test_nobody_listens() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))  # bound and not listening: connections are refused
        port = TcpPort("127.0.0.1", taken.getsockname()[1])
        with pytest.raises(LinkDown):
            await port.exchange(b"abcd")


async def test_an_unknown_host_is_a_link_that_is_down() -> None:
    with pytest.raises(LinkDown):
        await TcpPort("host.invalid", 4280).exchange(b"abcd")


async def test_a_cancelled_exchange_leaves_no_answer_behind() -> None:
    asked, release = asyncio.Event(), asyncio.Event()

    async def wait(frame: bytes, writer: asyncio.StreamWriter) -> None:
        asked.set()
        await release.wait()
        writer.write(frame)

    async with serving(wait) as server:
        port = TcpPort("127.0.0.1", server.port, timeout_s=5.0)
        asking = asyncio.create_task(port.exchange(b"old!"))
        await asked.wait()
        asking.cancel()
        with pytest.raises(asyncio.CancelledError):
            await asking
        release.set()
        assert await port.exchange(b"new?") == b"new?"
        await port.aclose()


async def test_a_wrong_length_never_reaches_the_wire() -> None:
    async with serving() as server:
        port = TcpPort("127.0.0.1", server.port)
        with pytest.raises(ValueError, match="4 bytes"):
            await port.exchange(b"abc")
        assert server.connections == 0


@pytest.mark.parametrize(
    ("link", "error"),
    [
        ({}, UsageError),
        ({"host": " ", "port": 1}, UsageError),
        ({"host": "h", "port": 0}, OutOfRange),
        ({"host": "h", "port": 65536}, OutOfRange),
        ({"host": "h", "port": True}, OutOfRange),
        ({"host": "h", "port": 1, "timeout_s": 0}, OutOfRange),
        ({"host": "h", "port": 1, "timeout_s": float("nan")}, OutOfRange),
        ({"host": "h", "port": 1, "baud": 9600}, UnknownThing),
    ],
)
def test_options_that_cannot_be(link: dict[str, object], error: type[Exception]) -> None:
    with pytest.raises(error):
        tcp_factory("tmc428", {"kind": "tcp", **link}, VirtualClock())


def test_kinds_are_found_by_name() -> None:
    port = open_port({"tcp": tcp_factory}, "tmc428", {"kind": "tcp", "host": "h", "port": 1}, VirtualClock())
    assert port.name == "tcp h:1"
    with pytest.raises(UnknownThing, match="carrier pigeon"):
        open_port({"tcp": tcp_factory}, "tmc428", {"kind": "carrier pigeon"}, VirtualClock())
