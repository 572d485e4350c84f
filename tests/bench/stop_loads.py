"""Strangers who use up what a server has, as a process of their own: `KIND URL COUNT`. Says "ready" once at it."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import socket
import sys
import threading
import time
from collections.abc import Callable
from functools import partial

import httpx
from websockets.asyncio.client import connect
from websockets.exceptions import WebSocketException

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


TELEMETRY = "/api/v1/devices/bench/telemetry?channels=position.0"
FRAMES = {
    "messages": b"\x81\x81\0\0\0\0x",
    "long messages": b"\x81\xfe\xff\xff\0\0\0\0" + b"x" * 65_535,
    "parts": b"\x01\x81\0\0\0\0x" + b"\x00\x81\0\0\0\0x" * 4000 + b"\x80\x80\0\0\0\0",
    "pings": b"\x89\x80\0\0\0\0",
}
"""What is said over a WebSocket, masked by nothing: texts of 1 byte, long ones, one in thousands of parts, pings."""


def talkative(url: str, count: int, kind: str) -> None:
    """WebSockets of conditions and telemetry whose clients say that without pause, and take what they get."""
    frames = FRAMES[kind] * max(1, PIECE_BYTES // len(FRAMES[kind]))
    numbers = iter(range(count))

    def flood() -> None:
        path = ("/api/v1/conditions", TELEMETRY)[next(numbers) % 2]
        head = (
            f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
            "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
        )
        while True:
            with contextlib.suppress(OSError), socket.create_connection(address(url), timeout=5) as connection:
                connection.sendall(head.encode())
                if not connection.recv(PIECE_BYTES).startswith(b"HTTP/1.1 101 "):
                    raise RuntimeError(f"no WebSocket at {path}")
                connection.settimeout(None)  # with a time limit Python waits, whatever the flags say
                while True:
                    connection.sendall(frames)
                    with contextlib.suppress(BlockingIOError):
                        while connection.recv(PIECE_BYTES, socket.MSG_DONTWAIT):
                            pass

    _together(count, flood)


def readers(url: str, count: int, rate_step_hz: float = 0.0, batch_hz: float = 5.0) -> None:
    """Telemetry sockets that take what they get, of the same rate or each of its own; who is refused comes again."""
    asyncio.run(_read(url.replace("http", "ws", 1), count, rate_step_hz, batch_hz))


async def _read(url: str, count: int, rate_step_hz: float, batch_hz: float) -> None:
    begun = asyncio.Semaphore(0)

    async def one(number: int) -> None:
        rate_hz = 100 + number * rate_step_hz
        target = f"{url}/api/v1/devices/bench/telemetry?channels=position.0&rate_hz={rate_hz}&batch_hz={batch_hz}"
        told = False
        while True:
            with contextlib.suppress(OSError, WebSocketException):
                async with connect(target, compression=None, open_timeout=60) as each:
                    async for _ in each:
                        if not told:
                            told = True
                            begun.release()
            await asyncio.sleep(30.0)

    async with asyncio.TaskGroup() as group:
        for number in range(count):
            group.create_task(one(number))
            await begun.acquire()
        ready()


def talk(url: str, count: int) -> None:
    """Modules that talk without pause, at 2 MB/s each."""
    with contextlib.ExitStack() as stack:
        for number in range(count):
            link = {"kind": "tcp", "host": "127.0.0.1", "port": stack.enter_context(talker())}
            device = {"name": f"silent {number}", "model": "pd42-1241", "link": link}
            httpx.post(f"{url}/api/v1/devices", json=device, timeout=60).raise_for_status()
        ready()
        threading.Event().wait()


def downloads(url: str, count: int) -> None:
    """Recordings that are fetched as files and worked out in whole, again and again."""
    api = f"{url}/api/v1/recordings"
    recording = httpx.get(api, timeout=60).raise_for_status().json()["recordings"][0]["id"]
    wishes = itertools.cycle((f"{recording}?format=csv", f"{recording}?format=parquet", f"{recording}/figures"))

    def fetch() -> None:
        wish = next(wishes)
        while True:
            with contextlib.suppress(httpx.HTTPError), httpx.stream("GET", f"{api}/{wish}", timeout=60) as answer:
                for _ in answer.iter_raw():
                    pass

    _together(count, fetch)


LOADS: dict[str, Callable[[str, int], None]] = {
    "half-open": half_open,
    "header": header,
    "bodies": bodies,
    **{kind: partial(talkative, kind=kind) for kind in FRAMES},
    "readers": readers,
    "different readers": partial(readers, rate_step_hz=1.0, batch_hz=60.0),
    "talker": talk,
    "downloads": downloads,
}

if __name__ == "__main__":
    LOADS[sys.argv[1]](sys.argv[2], int(sys.argv[3]))
