"""Stops while strangers use up what they can, and the cost of many devices: `POST /stop` and one axis's stop.

Beside each figure stands the p99 of a server that does nothing, asked in the same run under the same load: what the
machine alone takes.
"""

from __future__ import annotations

import http.client
import json
import resource
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import httpx
from server_process import ServerProcess, free_port

from tests.bench.recording_view import make_long
from tests.bench.serving import cpu_seconds
from tests.bench.table import Row, p99

STOP_LIMIT_MS = 100.0
TOLD_LIMIT_MS = 1000.0
CPU_LIMIT = 0.25
MEMORY_LIMIT_MB = 800.0
"""A server with its demo takes half of that."""
DESCRIPTORS = 1024
LOADS = (
    ("1,100 half-open sockets", "half-open", 1100),
    ("a header of 256 MiB", "header", 1),
    ("8 body floods", "bodies", 8),
    ("8 WebSockets with texts of 1 byte", "messages", 8),
    ("8 WebSockets with texts of 64 KiB", "long messages", 8),
    ("8 WebSockets with texts in parts of 1 byte", "parts", 8),
    ("8 WebSockets with pings", "pings", 8),
    ("500 telemetry readers", "readers", 500),
    ("300 telemetry readers, each of its own rate", "different readers", 300),
    ("12 downloads of a long recording", "downloads", 12),
    ("a peer at 2 MB/s", "talker", 1),
    ("a full disk", "", 0),
)
DEVICES, SILENT = 64, 8
MODELS = ("tmc428", "tmc4210", "tmc4361", "tmc5031", "tmc5062", "tmc5072", "tmc5130", "tmc5160", "pd42-1241")


def measure(quick: bool) -> Sequence[Row]:
    with empty_server() as empty:
        rows = [row for what, load, count in LOADS for row in stops_under(what, load, count, empty, quick)]
        return [*rows, *many_devices(empty, quick)]


@contextmanager
def empty_server() -> Iterator[str]:
    """The address of one that does nothing."""
    port = free_port()
    with ended(subprocess.Popen([sys.executable, "-m", "tests.bench.empty_answer", str(port)])):
        while True:
            try:
                socket.create_connection(("127.0.0.1", port)).close()
            except ConnectionRefusedError:
                time.sleep(0.1)
            else:
                break
        yield f"http://127.0.0.1:{port}"


@contextmanager
def ended(process: subprocess.Popen[bytes]) -> Iterator[None]:
    """Kill it behind the block."""
    try:
        yield
    finally:
        process.kill()
        process.wait()


@contextmanager
def server(
    *arguments: str, prepare: Callable[[Path], object] | None = None
) -> Iterator[tuple[ServerProcess, httpx.Client]]:
    """A server that is given 1,024 descriptors, as by a shell; `prepare` puts into its data directory what is there."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        if prepare is not None:
            prepare(Path(folder))
        resource.setrlimit(resource.RLIMIT_NOFILE, (min(soft, DESCRIPTORS), hard))
        try:
            process = stack.enter_context(ServerProcess(Path(folder), *arguments))
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))
        yield process, stack.enter_context(httpx.Client(base_url=f"{process.url}/api/v1", timeout=60))


@contextmanager
def loaded(load: str, count: int, process: ServerProcess) -> Iterator[None]:
    """Under that load of `stop_loads`; without one, its files take nothing any more, as on a full disk."""
    if not load:
        resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (1, 1))
        yield
        return
    command = [sys.executable, "-m", "tests.bench.stop_loads", load, process.url, str(count)]
    strangers = subprocess.Popen(command, stdout=subprocess.PIPE)
    assert strangers.stdout is not None
    with strangers.stdout, ended(strangers):
        if strangers.stdout.readline() != b"ready\n":
            raise RuntimeError(f"{command} ended")
        yield


def stops_under(what: str, load: str, count: int, empty: str, quick: bool) -> list[Row]:
    times = 50 if quick else 200
    with (
        server("--demo", prepare=make_long if load == "downloads" else None) as (process, api),
        loaded(load, count // 10 if quick and load == "readers" else count, process),
    ):
        empty_ms = timed_ms(empty, "stop", times)
        one_ms = timed_ms(process.url, "devices/bench/axes/0/stop", times)
        if load == "talker":  # whose own stop is waited for
            all_ms, told_ms = _each_told(api, times // 10)
            more = [_row(f"stop-all under {what}: the peer, told", told_ms, empty_ms, TOLD_LIMIT_MS)]
        else:
            all_ms, more = timed_ms(process.url, "stop", times), []
        if load == "downloads":
            more = [_memory_row(f"memory under {what}, at most", process.pid)]
    return [
        _row(f"stop-all under {what}", all_ms, empty_ms),
        *more,
        _row(f"one axis's stop under {what}", one_ms, empty_ms),
    ]


def _each_told(api: httpx.Client, times: int) -> tuple[list[float], list[float]]:
    """What stop-all tells of how long each device took that answers; how long those that are silent are waited for."""
    answered_ms, told_ms = [], []
    for _ in range(times):
        began_s = time.perf_counter()
        results = api.post("/stop").raise_for_status().json()["results"]
        told_ms.append((time.perf_counter() - began_s) * 1e3)
        for result in results:
            if not result["device"].startswith("silent"):
                if not result["ok"]:
                    raise RuntimeError(f"not stopped: {result}")
                answered_ms.append(result["took_ms"])
    return answered_ms, told_ms


def timed_ms(
    url: str, path: str, times: int, body: dict[str, Any] | None = None, status: int = 200, timeout_s: float = 60.0
) -> list[float]:
    """Each over a connection of its own, as somebody does who comes anew."""
    took_ms = []
    host, port = url.removeprefix("http://").split(":")
    text = None if body is None else json.dumps(body)
    for _ in range(times):
        began_s = time.perf_counter()
        connection = http.client.HTTPConnection(host, int(port), timeout=timeout_s)
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


def _memory_row(what: str, pid: int) -> Row:
    status = Path(f"/proc/{pid}/status").read_text(encoding="ascii")
    most_mb = int(status.partition("VmHWM:")[2].split()[0]) / 1024
    limit = f"< {MEMORY_LIMIT_MB:g} MB"
    return Row(what, f"{most_mb:.0f} MB", limit, most_mb / MEMORY_LIMIT_MB, limit, most_mb < MEMORY_LIMIT_MB)


def _row(what: str, took_ms: Sequence[float], empty_ms: Sequence[float], limit_ms: float = STOP_LIMIT_MS) -> Row:
    slow_ms = p99(took_ms)
    beside = f"limit {limit_ms:g} ms; an empty answer {p99(empty_ms):.1f} ms"
    return Row(what, f"p99 {slow_ms:.1f} ms", beside, slow_ms / limit_ms, "< 1", slow_ms < limit_ms)


# --- many devices -------------------------------------------------------------------------------


def many_devices(empty: str, quick: bool) -> list[Row]:
    seconds, times = (5.0, 20) if quick else (30.0, 100)
    with server("--no-demo") as (process, api), socket.create_server(("127.0.0.1", 0), backlog=200) as nobody:
        for number in range(DEVICES):
            device = {"name": f"d{number}", "model": MODELS[number % len(MODELS)], "link": {"kind": "emulator"}}
            api.post("/devices", json=device).raise_for_status()
        time.sleep(5.0)  # they come to rest
        began_s, cpu_s = time.perf_counter(), cpu_seconds(process.pid)
        time.sleep(seconds)
        share = (cpu_seconds(process.pid) - cpu_s) / (time.perf_counter() - began_s)
        empty_ms = timed_ms(empty, "stop", times)
        stops_ms = timed_ms(process.url, "stop", times)
        one_ms = timed_ms(process.url, "devices/d0/axes/0/stop", times)
        one_more = {"name": "more", "model": "tmc428", "link": {"kind": "emulator"}}
        refused_ms = timed_ms(process.url, "devices", times, one_more, 409)
        invalid_ms = timed_ms(process.url, "devices/test", times, {"model": "nothing"}, 422)
        silent = {"kind": "tcp", "host": "127.0.0.1", "port": nobody.getsockname()[1]}
        for number in range(SILENT):
            api.delete(f"/devices/d{number}").raise_for_status()
            device = {"name": f"silent {number}", "model": "tmc428", "link": silent}
            api.post("/devices", json=device).raise_for_status()
        answered_ms, told_ms = _each_told(api, 5 if quick else 20)
        beside_ms = timed_ms(process.url, f"devices/d{SILENT}/axes/0/stop", times)
    return [
        Row(
            what=f"{DEVICES} emulated devices at rest",
            measured=f"{share:.1%} of a core",
            peer="one core",
            ratio=share,
            required=f"< {CPU_LIMIT:g}",
            ok=share < CPU_LIMIT,
        ),
        _row(f"stop-all of {DEVICES} devices", stops_ms, empty_ms),
        _row(f"one axis's stop beside {DEVICES - 1} others", one_ms, empty_ms),
        _row(f"a device too many, refused with {DEVICES}", refused_ms, empty_ms),
        _row(f"a body that does not fit, refused with {DEVICES}", invalid_ms, empty_ms),
        _row(f"stop-all, {SILENT} of {DEVICES} silent: who answers", answered_ms, empty_ms),
        _row(f"stop-all, {SILENT} of {DEVICES} silent: the silent told", told_ms, empty_ms, TOLD_LIMIT_MS),
        _row(f"one axis's stop beside {SILENT} silent of {DEVICES}", beside_ms, empty_ms),
    ]
