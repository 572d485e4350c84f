"""Stops while strangers use up what they can, and the cost of many devices: `POST /stop` and one axis's stop."""

from __future__ import annotations

import asyncio
import contextlib
import http.client
import json
import resource
import socket
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager
from pathlib import Path
from typing import Any

import httpx
from server_process import ServerProcess
from websockets.asyncio.client import connect

from tests.bench.serving import cpu_seconds
from tests.bench.table import Row, p99
from tests.peers.talker import talker

STOP_LIMIT_MS = 100.0
TOLD_LIMIT_MS = 1000.0
CPU_LIMIT = 0.25
DESCRIPTORS = 1024
HALF_OPEN = 1100
HEADER_BYTES = 256 << 20
FLOODS = 8
READERS = 500
DEVICES, SILENT = 64, 8
MODELS = ("tmc428", "tmc4210", "tmc4361", "tmc5031", "tmc5062", "tmc5072", "tmc5130", "tmc5160", "pd42-1241")

Load = Callable[[ServerProcess, httpx.Client, bool], AbstractContextManager[None]]


def measure(quick: bool) -> Sequence[Row]:
    loads: dict[str, Load] = {
        f"{HALF_OPEN} half-open sockets": half_open,
        "a header of 256 MiB": long_header,
        "body floods": body_floods,
        f"{READERS} telemetry readers": readers,
        "a peer at 2 MB/s": talking_peer,
    }
    rows = [row for what, load in loads.items() for row in stops_under(what, load, quick)]
    return [*rows, *many_devices(quick)]


@contextmanager
def server(*arguments: str) -> Iterator[tuple[ServerProcess, httpx.Client]]:
    """A server that is given 1,024 descriptors, as by a shell."""
    own = resource.getrlimit(resource.RLIMIT_NOFILE)
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        resource.setrlimit(resource.RLIMIT_NOFILE, (DESCRIPTORS, own[1]))
        try:
            process = stack.enter_context(ServerProcess(Path(folder), *arguments))
            resource.setrlimit(resource.RLIMIT_NOFILE, (own[1], own[1]))  # we need more than it
            yield process, stack.enter_context(httpx.Client(base_url=f"{process.url}/api/v1", timeout=60))
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, own)


def stops_under(what: str, load: Load, quick: bool) -> list[Row]:
    with server("--demo") as (process, api), load(process, api, quick):
        return [
            _row(f"stop-all under {what}", _timed_ms(process.url, "stop", 50 if quick else 200)),
            _row(
                f"one axis's stop under {what}",
                _timed_ms(process.url, "devices/bench/axes/0/stop", 50 if quick else 200),
            ),
        ]


def _timed_ms(url: str, path: str, times: int, body: dict[str, Any] | None = None, status: int = 200) -> list[float]:
    """Each over a connection of its own, as somebody does who comes anew."""
    took_ms = []
    host, port = url.removeprefix("http://").split(":")
    text = None if body is None else json.dumps(body)
    for _ in range(times):
        began_s = time.perf_counter()
        connection = http.client.HTTPConnection(host, int(port), timeout=60)
        connection.request(
            "POST", f"/api/v1/{path}", text, {} if text is None else {"content-type": "application/json"}
        )
        answer = connection.getresponse()
        said = answer.read()
        connection.close()
        took_ms.append((time.perf_counter() - began_s) * 1e3)
        if answer.status != status:
            raise RuntimeError(f"{path} was answered {answer.status}: {said[:200]!r}")
        time.sleep(0.01)
    return took_ms


def _row(what: str, took_ms: Sequence[float], limit_ms: float = STOP_LIMIT_MS, notes: tuple[str, ...] = ()) -> Row:
    slow_ms = p99(took_ms)
    return Row(
        what, f"p99 {slow_ms:.1f} ms", f"limit {limit_ms:g} ms", slow_ms / limit_ms, "< 1", slow_ms < limit_ms, notes
    )


# --- loads --------------------------------------------------------------------------------------


def _address(process: ServerProcess) -> tuple[str, int]:
    host, _, port = process.url.removeprefix("http://").partition(":")
    return host, int(port)


@contextmanager
def half_open(process: ServerProcess, api: httpx.Client, quick: bool) -> Iterator[None]:
    del api, quick
    with ExitStack() as stack:
        for _ in range(HALF_OPEN):
            connection = stack.enter_context(socket.create_connection(_address(process)))
            with contextlib.suppress(OSError):
                connection.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n")
        yield


@contextmanager
def _threads(count: int, work: Callable[[threading.Event], None]) -> Iterator[None]:
    ended = threading.Event()
    threads = [threading.Thread(target=work, args=(ended,), daemon=True) for _ in range(count)]
    for thread in threads:
        thread.start()
    try:
        yield
    finally:
        ended.set()
        for thread in threads:
            thread.join(10)


def _flood(process: ServerProcess, head: bytes, piece: bytes, most_bytes: int) -> Callable[[threading.Event], None]:
    def work(ended: threading.Event) -> None:
        while not ended.is_set():
            sent = 0
            with contextlib.suppress(OSError), socket.create_connection(_address(process), timeout=5) as connection:
                connection.sendall(head)
                while not ended.is_set() and sent < most_bytes:
                    connection.sendall(piece)
                    sent += len(piece)

    return work


@contextmanager
def long_header(process: ServerProcess, api: httpx.Client, quick: bool) -> Iterator[None]:
    del api, quick
    head = b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX: "
    with _threads(1, _flood(process, head, b"x" * 65_536, HEADER_BYTES)):
        yield


@contextmanager
def body_floods(process: ServerProcess, api: httpx.Client, quick: bool) -> Iterator[None]:
    del api, quick
    head = b"POST /api/v1/devices HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\n\r\n"
    with _threads(FLOODS, _flood(process, head, b"10000\r\n" + b"x" * 65_536 + b"\r\n", 1 << 40)):
        yield


@contextmanager
def readers(process: ServerProcess, api: httpx.Client, quick: bool) -> Iterator[None]:
    del api
    count = READERS // 10 if quick else READERS
    url = (
        process.url.replace("http", "ws", 1)
        + "/api/v1/devices/bench/telemetry?channels=position.0&rate_hz=100&batch_hz=5"
    )
    ready = threading.Event()

    async def read(ended: threading.Event) -> None:
        async with contextlib.AsyncExitStack() as stack:
            sockets = [await stack.enter_async_context(connect(url, compression=None)) for _ in range(count)]
            ready.set()

            async def one(each: Any) -> None:
                while not ended.is_set():
                    await each.recv()

            await asyncio.gather(*(one(each) for each in sockets))

    with _threads(1, lambda ended: asyncio.run(read(ended))):
        if not ready.wait(120):
            raise RuntimeError(f"not all of {count} readers came in")
        yield


@contextmanager
def talking_peer(process: ServerProcess, api: httpx.Client, quick: bool) -> Iterator[None]:
    """Nobody has to answer for the peer: what counts is how long the others wait. So it is not in stop-all's way."""
    del process, quick
    with talker() as port:
        link = {"kind": "tcp", "host": "127.0.0.1", "port": port}
        api.post("/devices", json={"name": "Talker", "model": "pd42-1241", "link": link}).raise_for_status()
        yield


# --- many devices -------------------------------------------------------------------------------


def many_devices(quick: bool) -> list[Row]:
    seconds, times = (5.0, 20) if quick else (30.0, 100)
    with server("--no-demo") as (process, api), socket.create_server(("127.0.0.1", 0), backlog=200) as nobody:
        for number in range(DEVICES):
            device = {"name": f"d{number}", "model": MODELS[number % len(MODELS)], "link": {"kind": "emulator"}}
            api.post("/devices", json=device).raise_for_status()
        time.sleep(5.0)  # they come to rest
        began_s, cpu_s = time.perf_counter(), cpu_seconds(process.pid)
        time.sleep(seconds)
        share = (cpu_seconds(process.pid) - cpu_s) / (time.perf_counter() - began_s)
        stops_ms = _timed_ms(process.url, "stop", times)
        one_ms = _timed_ms(process.url, "devices/d0/axes/0/stop", times)
        one_more = {"name": "more", "model": "tmc428", "link": {"kind": "emulator"}}
        refused_ms = _timed_ms(process.url, "devices", times, one_more, 409)
        invalid_ms = _timed_ms(process.url, "devices/test", times, {"model": "nothing"}, 422)
        silent = {"kind": "tcp", "host": "127.0.0.1", "port": nobody.getsockname()[1]}
        for number in range(SILENT):
            api.delete(f"/devices/d{number}").raise_for_status()
            device = {"name": f"silent {number}", "model": "tmc428", "link": silent}
            api.post("/devices", json=device).raise_for_status()
        answered_ms, told_ms = [], []
        for _ in range(5 if quick else 20):
            for result in api.post("/stop").raise_for_status().json()["results"]:
                (told_ms if result["device"].startswith("silent") else answered_ms).append(result["took_ms"])
    return [
        Row(
            what=f"{DEVICES} emulated devices at rest",
            measured=f"{share:.1%} of a core",
            peer="one core",
            ratio=share,
            required=f"< {CPU_LIMIT:g}",
            ok=share < CPU_LIMIT,
        ),
        _row(f"stop-all of {DEVICES} devices", stops_ms),
        _row(f"one axis's stop beside {DEVICES - 1} others", one_ms),
        _row(f"a device too many, refused with {DEVICES}", refused_ms),
        _row(f"a body that does not fit, refused with {DEVICES}", invalid_ms),
        _row(f"stop-all, {SILENT} of {DEVICES} silent: who answers", answered_ms),
        _row(f"stop-all, {SILENT} of {DEVICES} silent: who is silent, told", told_ms, TOLD_LIMIT_MS),
    ]
