"""The wheel of this tree as somebody installs and starts it: in an environment of its own, from a registry."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

import httpx
from server_process import free_port

ROOT = Path(__file__).resolve().parents[1]
LOOK_S = 0.02
READ_ONLY = 'mount --bind "$0" "$0" && mount -o remount,ro,bind "$0" && exec "$@"'

T = TypeVar("T")


def wheel(folder: Path, page: bool = True) -> Path:
    """Build it there; without `page` it is the API alone."""
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    environment = os.environ if page else {**os.environ, "STEPSCOPE_NO_WEB": "1"}
    subprocess.run(command, cwd=ROOT, env=environment, check=True, stdout=subprocess.DEVNULL)
    (built,) = folder.glob("*.whl")
    return built


def install(built: Path, venv: Path, python: str = sys.executable, *options: str) -> None:
    """`pip install` of the tested versions, in a new environment. Raises CalledProcessError, with pip's words."""
    subprocess.run([python, "-m", "venv", "--without-pip", str(venv)], check=True, capture_output=True)
    pip = (sys.executable, "-m", "pip", "--python", str(venv / "bin/python"))
    constraints = ("--constraint", str(ROOT / "constraints.txt"))
    command = [*pip, "install", "--quiet", *options, *constraints, str(built)]
    subprocess.run(command, check=True, capture_output=True, text=True)


@contextmanager
def server(venv: Path, home: Path, read_only: bool = False) -> Iterator[tuple[str, float]]:
    """A server that a user with that home starts, its address, and when it was started (perf_counter, [s])."""
    port = free_port()
    command = [str(venv / "bin/stepscope"), "serve", "--port", str(port)]
    if read_only and os.geteuid() == 0:  # whom no permission keeps from writing
        command = ["unshare", "--mount", "sh", "-c", READ_ONLY, str(venv), *command]
    else:
        subprocess.run(["chmod", "-R", "u-w" if read_only else "u+w", str(venv)], check=True)
    with running(command, home) as began_s:
        yield f"http://127.0.0.1:{port}", began_s


@contextmanager
def running(command: Sequence[str], home: Path) -> Iterator[float]:
    """A process of a user with that home, ended by Ctrl-C, and when it was started (perf_counter, [s])."""
    mine = re.compile("STEPSCOPE_|XDG_|NUMBA_|PYTHON")
    environment = {name: value for name, value in os.environ.items() if not mine.match(name)} | {"HOME": str(home)}
    began_s = time.perf_counter()
    process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL)
    try:
        yield began_s
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(30)


def answers(url: str) -> bool:
    """Whether the demo bench is there."""
    try:
        devices = httpx.get(f"{url}/api/v1/devices", timeout=5).raise_for_status().json()
    except httpx.HTTPError:
        return False
    return any(device["name"] == "bench" and device["state"] == "connected" for device in devices)


def move(api: httpx.Client) -> None:
    """Send the first axis of the demo bench somewhere, and look until it is on its way."""
    bench = next(device for device in api.get("devices").raise_for_status().json() if device["name"] == "bench")
    axis = f"devices/{bench['id']}/axes/0"
    api.post(f"{axis}/move", json={"target": 2000}).raise_for_status()
    until(lambda: api.get(axis).raise_for_status().json()["position"])


def until(look: Callable[[], T], within_s: float = 60.0) -> T:
    """What `look` finds as soon as it is something. Raises TimeoutError."""
    end_s = time.perf_counter() + within_s
    while time.perf_counter() < end_s:
        if found := look():
            return found
        time.sleep(LOOK_S)
    raise TimeoutError(f"not within {within_s:g} s")
