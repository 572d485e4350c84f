"""The server: what it costs while its emulators move, how fast it answers, and whether telemetry keeps up."""

from __future__ import annotations

import contextlib
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
from server_process import ServerProcess

from tests.bench.http_load import requests_per_second
from tests.bench.table import Row, p99

CPU_LIMIT = 0.25
GET_RATIO = 0.5
LATENCY_LIMIT_MS = 50.0
STOP_LIMIT_MS = 50.0
QUANTITIES = ("position", "velocity", "target_position", "acceleration")
READERS = 10


@contextlib.contextmanager
def demo_server() -> Iterator[tuple[ServerProcess, httpx.Client, list[dict[str, Any]]]]:
    """A fresh server with the demo bench: the process, a client of its API, its devices."""
    with (
        tempfile.TemporaryDirectory() as folder,
        ServerProcess(Path(folder), "--demo") as server,
        httpx.Client(base_url=f"{server.url}/api/v1", timeout=30) as api,
    ):
        yield server, api, api.get("/devices").raise_for_status().json()


def start_all(api: httpx.Client, devices: list[dict[str, Any]], *, distance: int = 20_000) -> int:
    """Send every axis back and forth for ever; returns how many there are."""
    count = 0
    for device in devices:
        for axis in device["axes"]:
            address = f"/devices/{device['id']}/axes/{axis['index']}"
            here = api.get(address).raise_for_status().json()["position"]
            body = {"first": here - distance, "second": here + distance, "dwell_s": 0.05}
            api.post(f"{address}/shuttle", json=body).raise_for_status()
            count += 1
    return count


def positions(api: httpx.Client, devices: list[dict[str, Any]]) -> list[int]:
    return [
        api.get(f"/devices/{device['id']}/axes/{axis['index']}").raise_for_status().json()["position"]
        for device in devices
        for axis in device["axes"]
    ]


def cpu_seconds(pid: int) -> float:
    """CPU time [s] of a process and its threads so far, user and system."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def measure_cpu(*, quick: bool) -> Row:
    seconds = 5.0 if quick else 30.0
    with demo_server() as (server, api, devices):
        axes = start_all(api, devices)
        time.sleep(2.0)
        before = positions(api, devices)
        start_s, start_cpu_s = time.perf_counter(), cpu_seconds(server.pid)
        time.sleep(seconds)
        share = (cpu_seconds(server.pid) - start_cpu_s) / (time.perf_counter() - start_s)
        moved = sum(a != b for a, b in zip(before, positions(api, devices), strict=True))
    return Row(
        what=f"server with {len(devices)} emulators, {axes} axes moving in real time",
        measured=f"{share:.1%} of a core",
        peer="one core",
        ratio=share,
        required=f"< {CPU_LIMIT:g}",
        ok=share < CPU_LIMIT and moved == axes,
        notes=() if moved == axes else (f"only {moved} of {axes} axes moved",),
    )


def measure_get(*, quick: bool) -> Row:
    seconds, rounds = (0.5, 3) if quick else (2.0, 7)
    with demo_server() as (server, api, devices):
        register = f"/api/v1/devices/{devices[0]['id']}/registers/V_MAX?axis=0"
        api.get(register.removeprefix("/api/v1")).raise_for_status()
        requests_per_second(server.url, register, 1.0)  # warm
        # In turns, so that what else the machine does falls on both.
        pairs = [
            (
                requests_per_second(server.url, "/api/v1/health", seconds),
                requests_per_second(server.url, register, seconds),
            )
            for _ in range(rounds)
        ]
    trivial, emulated = (statistics.median(column) for column in zip(*pairs, strict=True))
    ratio = statistics.median(b / a for a, b in pairs)
    return Row(
        what="GET of an emulated register",
        measured=f"{emulated:,.0f}/s",
        peer=f"GET /health {trivial:,.0f}/s",
        ratio=ratio,
        required=f">= {GET_RATIO:g}",
        ok=ratio >= GET_RATIO,
    )


def measure_telemetry(*, quick: bool) -> list[Row]:
    """Ten readers of eight channels, first left alone, then with stop-all again and again beside them."""
    seconds, stops = (8.0, 30) if quick else (60.0, 200)
    with demo_server() as (server, api, devices):
        device = max(devices, key=lambda candidate: len(candidate["axes"]))
        start_all(api, devices)
        channels = ",".join(f"{quantity}.{axis}" for axis in (0, 1) for quantity in QUANTITIES)
        address = server.url.replace("http", "ws", 1)
        url = f"{address}/api/v1/devices/{device['id']}/telemetry?channels={channels}&rate_hz=1000"
        quiet = _Readers(url, seconds).finish()
        load = _Readers(url, max(5.0, seconds / 4))
        time.sleep(1.5)
        took_ms = _stop_again_and_again(api, devices, stops, load)
        busy = load.finish()
    return [_telemetry_row(quiet, seconds), _stop_row(took_ms, busy)]


class _Readers:
    def __init__(self, url: str, seconds: float) -> None:
        command = [sys.executable, "-m", "tests.bench.telemetry_client", url]
        command += ["--readers", str(READERS), "--seconds", str(seconds)]
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE)

    @property
    def running(self) -> bool:
        return self._process.poll() is None

    def finish(self) -> list[dict[str, float]]:
        out, _ = self._process.communicate()
        if self._process.returncode:
            raise RuntimeError("the telemetry readers failed")
        seen: list[dict[str, float]] = json.loads(out)
        return seen


def _stop_again_and_again(api: httpx.Client, devices: list[dict[str, Any]], stops: int, load: _Readers) -> list[float]:
    took_ms: list[float] = []
    while len(took_ms) < stops and load.running:
        results = api.post("/stop", json={"mode": "ramp"}).raise_for_status().json()["results"]
        failed = [result for result in results if not result["ok"]]
        if failed or not results:
            raise RuntimeError(f"stop-all failed: {failed}")
        took_ms.append(max(result["took_ms"] for result in results))
        start_all(api, devices)
    return took_ms


def _telemetry_row(seen: list[dict[str, float]], seconds: float) -> Row:
    latency_ms = max(reader["latency_p99_ms"] for reader in seen)
    lost = int(sum(reader["dropped"] + reader["frames_missed"] + reader["gaps"] for reader in seen))
    rows = min(reader["rows"] for reader in seen)
    slowest_ms = max(reader["latency_max_ms"] for reader in seen)
    whole = rows >= 0.999 * seconds * 1000
    return Row(
        what=f"telemetry, 8 channels x 1 kHz to {READERS} readers for {seconds:g} s",
        measured=f"p99 {latency_ms:.1f} ms, {lost} lost",
        peer=f"limit {LATENCY_LIMIT_MS:g} ms, none lost",
        ratio=latency_ms / LATENCY_LIMIT_MS,
        required="< 1, none lost",
        ok=lost == 0 and whole and latency_ms < LATENCY_LIMIT_MS,
        notes=(f"slowest sample {slowest_ms:.1f} ms, {rows} rows for the reader with the fewest",),
    )


def _stop_row(took_ms: list[float], seen: list[dict[str, float]]) -> Row:
    slow_ms = p99(took_ms)
    lost = int(sum(reader["dropped"] + reader["frames_missed"] + reader["gaps"] for reader in seen))
    return Row(
        what=f"stop-all under that load, {len(took_ms)} times",
        measured=f"p99 {slow_ms:.2f} ms",
        peer=f"limit {STOP_LIMIT_MS:g} ms",
        ratio=slow_ms / STOP_LIMIT_MS,
        required="< 1",
        ok=slow_ms < STOP_LIMIT_MS,
        notes=(f"the {READERS} readers lost {lost} samples meanwhile",) if lost else (),
    )
