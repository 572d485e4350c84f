"""A real server on a real disk that fills up, turns read-only or loses its files while the server works on it."""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from server_process import ServerProcess, free_port

from tests.e2e.session import a_client

DISK_BYTES = 16_000_000
SET_UP = {
    name: {"value": value} for name, value in {"AMAX": 2000, "DMAX": 2000, "D1": 2000, "VMAX": 50_000}.items()
} | {
    "CHOPCONF": {"fields": {"toff": 3}},
    "IHOLD_IRUN": {"fields": {"IHOLD": 8, "IRUN": 16}},
}


@pytest.fixture
def disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A small file system of its own; it needs the right to mount one."""
    monkeypatch.setenv("STEPSCOPE_DISK_RESERVE_MB", "0")
    place = tmp_path / "disk"
    place.mkdir()
    made = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", f"size={DISK_BYTES}", "tmpfs", place], capture_output=True, check=False
    )
    if made.returncode != 0:
        pytest.skip("no file system may be mounted here")
    yield place
    while subprocess.run(["umount", "-l", place], capture_output=True, check=False).returncode == 0:
        pass  # one view after the other


def fill(disk: Path) -> None:
    filler = os.open(disk / "filler", os.O_WRONLY | os.O_CREAT)
    with contextlib.suppress(OSError):
        while True:
            os.write(filler, bytes(4096))
    os.close(filler)


def make_room(disk: Path) -> None:
    (disk / "filler").unlink()


def forbid_writing(disk: Path) -> None:
    """A read-only view of it over itself: what is opened from now on cannot be written, whoever asks."""
    subprocess.run(["mount", "--bind", disk, disk], check=True)
    subprocess.run(["mount", "-o", "remount,bind,ro", disk], check=True)


def allow_writing(disk: Path) -> None:
    subprocess.run(["umount", "-l", disk], check=True)


def wait_for(condition: Callable[[], bool], what: str) -> None:
    until_s = time.monotonic() + 30
    while not condition():
        assert time.monotonic() < until_s, what
        time.sleep(0.05)


def begin(api: httpx.Client) -> dict[str, Any]:
    """What is acknowledged while all is well: a device, a profile, a recording."""
    body = {"name": "kept", "model": "tmc5160", "link": {"kind": "emulator"}, "start_up": True}
    device = api.post("/devices", json=body).raise_for_status().json()
    assert device["notes"] == []
    wait_for(lambda: api.get("/devices/kept").json()["state"] == "connected", "it is connected")
    document = api.get("/devices/kept/profile").raise_for_status().json()
    profile = api.post("/profiles", json={"name": "before", "document": document}).raise_for_status().json()
    recording = api.post("/recordings", json={"device": "kept", "channels": ["position.0"], "name": "run"})
    ended = api.post(f"/recordings/{recording.raise_for_status().json()['id']}/stop").raise_for_status().json()
    return {"profile": profile["id"], "recording": ended["id"], "document": document}


def still_works(api: httpx.Client) -> None:
    """What needs no disk: a write, a motion, and the stops."""
    for name, what in SET_UP.items():
        written = api.put(f"/devices/kept/registers/{name}", json=what).raise_for_status().json()
        assert written["verified"] is not False
    moved = api.post("/devices/kept/axes/0/move", json={"target": 1000})
    assert moved.is_success, moved.text
    stopped = api.post("/stop").raise_for_status().json()
    assert all(result["ok"] for result in stopped["results"])


def profile_names(api: httpx.Client) -> list[str]:
    return sorted(profile["name"] for profile in api.get("/profiles").raise_for_status().json()["profiles"])


def is_told(answer: httpx.Response) -> bool:
    """A refusal that says what is the matter, or an acknowledgement that says what is not kept."""
    if answer.is_success:
        return any("tried again" in note for note in answer.json().get("notes", []))
    problem = answer.json()
    assert answer.status_code in (409, 503, 507), problem
    return bool(problem["detail"]) and problem["type"] != "/problems/internal"


@pytest.mark.slow
@pytest.mark.timeout(180)
@pytest.mark.parametrize(
    ("spoil", "mend"),
    [(fill, make_room), (forbid_writing, allow_writing)],
    ids=["full", "read-only"],
)
def test_a_disk_that_takes_nothing_loses_nothing_that_was_acknowledged(
    disk: Path, spoil: Callable[[Path], None], mend: Callable[[Path], None]
) -> None:
    data = disk / "data"
    with ServerProcess(data) as server:
        with a_client(server.url, 30) as api:
            there = begin(api)
            spoil(disk)
            late = api.post("/devices", json={"name": "late", "model": "tmc428", "link": {"kind": "emulator"}})
            assert late.status_code == 201
            assert is_told(late)
            # A database that was open already may still take it; then it has to be there afterwards.
            second = api.post("/profiles", json={"name": "second", "document": there["document"]})
            assert second.is_success or is_told(second)
            names = ["before", "second"] if second.is_success else ["before"]
            begun = api.post("/recordings", json={"device": "kept", "channels": ["position.0"], "name": "not kept"})
            if begun.is_success:
                ended = api.post(f"/recordings/{begun.json()['id']}/stop")
                assert ended.is_success or is_told(ended)
            else:
                assert is_told(begun)
            still_works(api)
            health = api.get("/health/details").raise_for_status().json()
            assert any("connections.json" in note for note in health["storage"]["notes"])
            assert profile_names(api) == names
            mend(disk)
            wait_for(
                lambda: not api.get("/health/details").json()["storage"]["notes"], "it is written when that is possible"
            )
        server.stop()
        server.start(free_port())
        with a_client(server.url, 30) as api:
            assert {device["id"] for device in api.get("/devices").json()} == {"kept", "late"}
            before = api.get(f"/profiles/{there['profile']}").raise_for_status().json()["document"]
            assert before == there["document"] | {"name": before["name"]}
            assert profile_names(api) == names
            assert api.get(f"/recordings/{there['recording']}").raise_for_status().json()["name"] == "run"


@pytest.mark.slow
@pytest.mark.timeout(180)
def test_files_that_vanish_under_the_server_are_written_again(tmp_path: Path) -> None:
    data = tmp_path / "data"
    with ServerProcess(data) as server:
        with a_client(server.url, 30) as api:
            begin(api)
            shutil.rmtree(data)
            late = api.post("/devices", json={"name": "late", "model": "tmc428", "link": {"kind": "emulator"}})
            assert late.status_code == 201
            still_works(api)
            assert api.get("/recordings").is_success
            gone = api.get("/profiles")
            assert gone.is_success or is_told(gone)
        server.stop()
        server.start(free_port())
        with a_client(server.url, 30) as api:
            assert {device["id"] for device in api.get("/devices").json()} == {"kept", "late"}


@pytest.mark.slow
@pytest.mark.timeout(180)
@pytest.mark.parametrize("spoil", [fill, forbid_writing], ids=["full", "read-only"])
def test_a_server_starts_on_a_disk_that_takes_nothing(disk: Path, spoil: Callable[[Path], None]) -> None:
    data = disk / "data"
    with ServerProcess(data) as server, a_client(server.url, 30) as api:
        begin(api)
    spoil(disk)
    with ServerProcess(data) as server, a_client(server.url, 30) as api:
        assert [device["id"] for device in api.get("/devices").raise_for_status().json()] == ["kept"]
        wait_for(lambda: api.get("/devices/kept").json()["state"] == "connected", "it is connected")
        still_works(api)
        assert is_told(api.post("/devices", json={"name": "late", "model": "tmc428", "link": {"kind": "emulator"}}))
