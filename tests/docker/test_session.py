"""The three processes of docker/compose.yaml, started by hand with its own commands, on free ports of this machine."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.docker.test_files import BENCH, DOCKER, ROOT, SERVICES

WITHIN_S = 240.0
STEPSCOPE = [sys.executable, "-m", "app.cli"]


def free_ports(count: int) -> list[int]:
    """Ports that nobody has at the moment."""
    with ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]


@contextmanager
def running(command: list[str], environment: dict[str, str], log: Path) -> Iterator[subprocess.Popen[bytes]]:
    """A process from the root of the repository; its output is in `log`."""
    with log.open("wb") as out:
        process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=out, stderr=subprocess.STDOUT)
        try:
            yield process
        finally:
            process.terminate()
            try:
                process.wait(30)
            except subprocess.TimeoutExpired:  # it may be compiling, which hears no signal
                process.kill()
                process.wait()


def here(command: list[str], **instead: str) -> list[str]:
    """A command of a service, with this machine's paths and addresses."""
    return [instead.get(part, part.replace("/usr/local/share/stepscope", str(DOCKER))) for part in command]


def healthy(check: list[str], environment: dict[str, str], instead: dict[str, str]) -> None:
    """Wait until a service's health check says so, as compose does before it starts the next. Raises TimeoutError."""
    command = [sys.executable, *check[1:]]
    for old, new in instead.items():
        command = [part.replace(old, new) for part in command]
    end_s = time.monotonic() + WITHIN_S / 2
    while (done := subprocess.run(command, env=environment, capture_output=True, check=False)).returncode:
        if time.monotonic() > end_s:
            raise TimeoutError(done.stderr.decode())
        time.sleep(0.1)


SEARCH = "tuning session"
"""What the page with the report finds them by (`REPORT` of the session)."""


def left_behind(url: str, token: str) -> dict[str, Any]:
    """What somebody finds who opens the dashboard after the session: recordings, profiles, and how many axes move."""
    with httpx.Client(base_url=f"{url}/api/v1/", headers={"Authorization": f"Bearer {token}"}, timeout=30) as api:
        devices = api.get("devices").raise_for_status().json()
        axes = [f"devices/{device['id']}/axes/0" for device in devices]
        shuttles = [api.get(f"{axis}/shuttle").raise_for_status().json() for axis in axes]
        return {
            "recordings": api.get("recordings", params={"search": SEARCH}).raise_for_status().json()["recordings"],
            "profiles": api.get("profiles").raise_for_status().json()["profiles"],
            "shuttles": [shuttle["running"] for shuttle in shuttles],
            "lease": api.get("lease").raise_for_status().json(),
        }


@pytest.mark.slow
@pytest.mark.timeout(WITHIN_S + 60)
def test_a_session_from_nothing_to_its_report(tmp_path: Path) -> None:
    port, *ports = free_ports(1 + len(BENCH))
    bench = tmp_path / "bench.json"
    bench.write_text(json.dumps([{**device, "port": at} for device, at in zip(BENCH, ports, strict=True)]))
    environment = {name: value for name, value in os.environ.items() if not name.startswith("STEPSCOPE_")}
    environment |= {"PYTHONPATH": str(ROOT), "STEPSCOPE_DATA_DIR": str(tmp_path / "data")}
    environment |= {"STEPSCOPE_TOKEN_FILE": str(tmp_path / "data" / "token"), "STEPSCOPE_PORT": str(port)}
    environment |= {"STEPSCOPE_HOST": "0.0.0.0"}
    emulators, dashboard, session = (SERVICES[name] for name in ("emulators", "dashboard", "session"))

    far = [sys.executable, *here(emulators["entrypoint"][1:] + emulators["command"], **{"0.0.0.0": "127.0.0.1"})]
    near = [*STEPSCOPE, *here(dashboard["command"])]
    job = [sys.executable, *here(session["entrypoint"][1:] + session["command"], emulators="127.0.0.1")]
    job = [str(tmp_path) if part == "/reports" else part for part in job]
    with (
        running([*far, "--bench", str(bench)], environment, tmp_path / "emulators.log"),
        running(near, environment, tmp_path / "dashboard.log"),
    ):
        healthy(
            emulators["healthcheck"]["test"][1:], environment, {"/usr/local/share/stepscope/bench.json": str(bench)}
        )
        healthy([sys.executable, str(DOCKER / "healthy.py")], environment, {})
        done = subprocess.run(
            [*job, "--bench", str(bench)],
            cwd=ROOT,
            env={**environment, "STEPSCOPE_URL": f"http://127.0.0.1:{port}"},
            capture_output=True,
            text=True,
            timeout=WITHIN_S,
            check=False,
        )
        left = left_behind(f"http://127.0.0.1:{port}", (tmp_path / "data" / "token").read_text().strip())
    logs = "".join((tmp_path / name).read_text() for name in ("emulators.log", "dashboard.log"))
    assert done.returncode == 0, done.stdout + done.stderr + logs
    token = (tmp_path / "data" / "token").read_text().strip()
    assert f"http://127.0.0.1:{port}/?token={token}" in (tmp_path / "dashboard.log").read_text()
    outcomes = json.loads((tmp_path / "report.json").read_text())
    assert [(outcome["device"], outcome["model"]) for outcome in outcomes] == [
        (device["name"], device["model"]) for device in BENCH
    ]
    for outcome in outcomes:
        durations = [tried["duration_s"] for tried in outcome["tries"]]
        assert durations == sorted(durations, reverse=True), "more acceleration takes no longer"
        assert outcome["kept"] == outcome["tries"][-1]["acceleration"]
        assert all(tried["peak_pps"] > 0 for tried in outcome["tries"])
    assert sorted(one["name"] for one in left["recordings"]) == sorted(
        f"tuning session: {one['name']}" for one in BENCH
    )
    assert all(one["note"].count(" pps") == 3 and ": kept" in one["note"] for one in left["recordings"])
    assert len(left["profiles"]) == len(BENCH)
    assert left["shuttles"] == [True] * len(BENCH), "who comes late sees motion"
    assert left["lease"]["holder"] is None, "and may take the bench"
    assert f"/recordings/report?search={SEARCH.replace(' ', '%20')}" in done.stdout
    assert "**kept**" in (tmp_path / "report.md").read_text()
    assert (tmp_path / "data" / "connections.json").exists(), "connected as hardware is: kept"
