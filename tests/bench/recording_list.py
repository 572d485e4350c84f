"""Ten thousand recordings: how long a page of the list takes, first and later, searched, while another one begins."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import httpx
from server_process import ServerProcess

from app.store.recordings.file import SUFFIX
from app.store.recordings.library import FOLDER
from tests.bench.table import Row

COUNT, LIMIT = 10_000, 100
REQUIRED_S = 0.2
ROUNDS = 5
MEMORY_MB = 100.0
OLDEST = "the first of all"


def measure(quick: bool) -> Sequence[Row]:
    count = 1000 if quick else COUNT
    with tempfile.TemporaryDirectory(prefix="stepscope-") as folder:
        with ServerProcess(Path(folder), "--demo") as server:
            recording = _recorded(server)
        _multiply(Path(folder) / FOLDER, recording, count)
        with a_server(Path(folder)) as (server, api):
            cold_s, asked_s = _cold_search_s(api)
        with a_server(Path(folder)) as (server, api):
            before_mb = _memory_mb(server.pid)
            first_s = _page_s(api)
            pages_s = _all_pages_s(api, count)
            begun_s = [_page_s(api) for _ in range(ROUNDS) if _recorded(server)]
            search_s = _page_s(api, search="run 77")
            again_s = max(_page_s(api, search="run 78", device="bench") for _ in range(ROUNDS))
            grown_mb = _memory_mb(server.pid) - before_mb
    rows = [
        ("the first search after the start, the slowest page", cold_s),
        ("the first page after the start", first_s),
        (f"the slowest of {len(pages_s)} pages", max(pages_s)),
        ("a page after another recording, the slowest", max(begun_s)),
        ("a search", search_s),
        ("a search, the slowest", again_s),
    ]
    return [
        *(
            Row(
                what=f"{count:,} recordings: {what}",
                measured=f"{took_s * 1e3:.0f} ms",
                peer=f"{REQUIRED_S:g} s",
                ratio=took_s / REQUIRED_S,
                required=f"< {REQUIRED_S:g} s",
                ok=took_s < REQUIRED_S,
                notes=(f"complete after {asked_s:.1f} s of asking",) if took_s == cold_s else (),
            )
            for what, took_s in rows
        ),
        Row(
            what=f"{count:,} recordings: memory that the list takes",
            measured=f"{grown_mb:.0f} MB",
            peer=f"{MEMORY_MB:g} MB",
            ratio=grown_mb / MEMORY_MB,
            required=f"< {MEMORY_MB:g} MB",
            ok=grown_mb < MEMORY_MB,
        ),
    ]


@contextmanager
def a_server(folder: Path) -> Iterator[tuple[ServerProcess, httpx.Client]]:
    """One that has just begun, and has worked out its routes."""
    with (
        ServerProcess(folder, "--demo") as server,
        httpx.Client(base_url=f"{server.url}/api/v1", timeout=60) as api,
    ):
        api.get("/health").raise_for_status()
        yield server, api


def _cold_search_s(api: httpx.Client) -> tuple[float, float]:
    """How long the slowest page of a search took that finds the oldest alone, and all of them together [s]."""
    slowest_s, before, found = 0.0, "", 0
    began_s = time.perf_counter()
    while True:
        asked_s = time.perf_counter()
        page = api.get("/recordings", params={"search": OLDEST, "limit": LIMIT, "before": before}).raise_for_status()
        slowest_s = max(slowest_s, time.perf_counter() - asked_s)
        told = page.json()
        found += len(told["recordings"])
        before = told["next"] or ""
        if not before:
            break
    assert found == 1
    return slowest_s, time.perf_counter() - began_s


def _recorded(server: ServerProcess) -> str:
    """The id of a short recording, with the device's whole configuration in its head."""
    with httpx.Client(base_url=f"{server.url}/api/v1", timeout=60) as api:
        wanted = {"device": "bench", "channels": ["position.0", "velocity.0"]}
        recording: str = api.post("/recordings", json=wanted).raise_for_status().json()["id"]
        time.sleep(0.3)
        api.post(f"/recordings/{recording}/stop").raise_for_status()
    return recording


def _multiply(folder: Path, recording: str, count: int) -> None:
    """`count` more of it, each with its own id in its file and its own name."""
    rows = (folder / f"{recording}{SUFFIX}").read_bytes()
    for number in range(count):
        copy = f"2024{number // 2500 + 1:02}{number // 100 % 25 + 1:02}-{number % 100:06}-{number:04x}"
        (folder / f"{copy}{SUFFIX}").write_bytes(rows.replace(recording.encode(), copy.encode()))
        (folder / f"{copy}.json").write_text(
            f'{{"name": "{f"run {number}" if number else OLDEST}", "note": "of {count}"}}'
        )


def _page_s(api: httpx.Client, **wanted: str) -> float:
    begun_s = time.perf_counter()
    found = api.get("/recordings", params={"limit": LIMIT, **wanted}).raise_for_status()
    took_s = time.perf_counter() - begun_s
    assert found.json()["recordings"]
    return took_s


def _all_pages_s(api: httpx.Client, count: int) -> list[float]:
    """How long each page of the whole list took [s]."""
    took_s: list[float] = []
    before, seen = "", 0
    while True:
        begun_s = time.perf_counter()
        page = api.get("/recordings", params={"limit": LIMIT, "before": before}).raise_for_status()
        took_s.append(time.perf_counter() - begun_s)
        told = page.json()
        seen += len(told["recordings"])
        before = told["next"] or ""
        if not before:
            break
    assert seen > count
    return took_s


def _memory_mb(pid: int) -> float:
    fields = Path(f"/proc/{pid}/statm").read_text().split()
    return (int(fields[1]) - int(fields[2])) * os.sysconf("SC_PAGE_SIZE") / 1e6
