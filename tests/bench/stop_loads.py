"""Strangers who use up what a server has, as a process of their own: `KIND URL COUNT`. Says "ready" once at it."""

from __future__ import annotations

import asyncio
import contextlib
import socket
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import httpx
from websockets.asyncio.client import connect

from tests.peers.talker import talker

HEADER_BYTES = 256 << 20
PIECE_BYTES = 65_536


def ready() -> None:
    print("ready", flush=True)


def address(url: str) -> tuple[str, int]:
    host, _, port = url.removeprefix("http://").partition(":")
    return host, int(port)


def half_open(url: str, count: int) -> None:
    """Connections that begin a request and never end it; one that is closed is opened again."""
    held: list[socket.socket] = []
    said = False
    while True:
        while len(held) < count:
            held.append(socket.create_connection(address(url)))
            with contextlib.suppress(OSError):
                held[-1].sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n")
        if not said:
            ready()
            said = True
        time.sleep(0.5)
        held = [each for each in held if not _closed(each)]


def _closed(connection: socket.socket) -> bool:
    connection.setblocking(False)
    try:
        closed = connection.recv(1) == b""
    except BlockingIOError:
        return False
    except OSError:
        closed = True
    if closed:
        connection.close()
    return closed


def _flood(url: str, head: bytes, piece: bytes, most_bytes: int) -> None:
    while True:
        sent = 0
        with contextlib.suppress(OSError), socket.create_connection(address(url), timeout=5) as connection:
            connection.sendall(head)
            while sent < most_bytes:
                connection.sendall(piece)
                sent += len(piece)


def header(url: str, count: int) -> None:
    """A header of `HEADER_BYTES`, again and again."""
    head = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX: "
    _together(count, lambda: _flood(url, head, b"x" * PIECE_BYTES, HEADER_BYTES))


def bodies(url: str, count: int) -> None:
    """Bodies without an end."""
    head = b"POST /api/v1/devices HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\n\r\n"
    piece = b"%x\r\n%s\r\n" % (PIECE_BYTES, b"x" * PIECE_BYTES)
    _together(count, lambda: _flood(url, head, piece, 1 << 40))


def _together(count: int, work: Callable[[], None]) -> None:
    threads = [threading.Thread(target=work, daemon=True) for _ in range(count)]
    for thread in threads:
        thread.start()
    ready()
    for thread in threads:
        thread.join()


def readers(url: str, count: int) -> None:
    """Telemetry sockets that take what they get."""

    async def read() -> None:
        path = "/api/v1/devices/bench/telemetry?channels=position.0&rate_hz=100&batch_hz=5"
        async with contextlib.AsyncExitStack() as stack:
            target = url.replace("http", "ws", 1) + path
            sockets = [await stack.enter_async_context(connect(target, compression=None)) for _ in range(count)]
            ready()

            async def one(each: Any) -> None:
                async for _ in each:
                    pass

            await asyncio.gather(*(one(each) for each in sockets))

    asyncio.run(read())


def talk(url: str, count: int) -> None:
    """Modules that talk without end, at 2 MB/s each."""
    with contextlib.ExitStack() as stack:
        for number in range(count):
            link = {"kind": "tcp", "host": "127.0.0.1", "port": stack.enter_context(talker())}
            device = {"name": f"silent {number}", "model": "pd42-1241", "link": link}
            httpx.post(f"{url}/api/v1/devices", json=device, timeout=60).raise_for_status()
        ready()
        threading.Event().wait()


LOADS: dict[str, Callable[[str, int], None]] = {
    "half-open": half_open,
    "header": header,
    "bodies": bodies,
    "readers": readers,
    "talker": talk,
}

if __name__ == "__main__":
    LOADS[sys.argv[1]](sys.argv[2], int(sys.argv[3]))
