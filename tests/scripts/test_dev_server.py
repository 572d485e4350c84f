"""The server that `make dev` starts: with reload, and behind the same limits as the one that is installed."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import httpx
import pytest

from app.connections import HEAD_BYTES_MAX
from app.listening import listen

START_WITHIN_S = 240.0
"""Of a first start, which compiles the emulators, on a machine that is busy [s]."""
END_WITHIN_S = 15.0


def free_port() -> int:
    with listen("127.0.0.1", 0) as listener:
        return int(listener.getsockname()[1])


def wait_for(url: str, process: subprocess.Popen[bytes]) -> None:
    until_s = time.monotonic() + START_WITHIN_S
    while process.poll() is None and time.monotonic() < until_s:
        try:
            if httpx.get(url).status_code == 200:
                return
        except httpx.TransportError:
            time.sleep(0.2)
    raise AssertionError(f"no answer at {url}; ended with {process.poll()}")


def answer_to(port: int, head: bytes) -> bytes:
    with socket.create_connection(("127.0.0.1", port), timeout=10) as connection:
        connection.sendall(head)
        return connection.recv(4096)


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_it_has_the_limits_of_the_installed_server(tmp_path: Path) -> None:
    port = free_port()
    command = [sys.executable, "-m", "app.cli", "serve", "--reload", "--port", str(port)]
    process = subprocess.Popen([*command, "--data-dir", str(tmp_path / "data")], env=os.environ, start_new_session=True)
    try:
        wait_for(f"http://127.0.0.1:{port}/api/v1/health", process)
        too_long = b"GET / HTTP/1.1\r\nhost: localhost\r\nx-filler: " + b"a" * (HEAD_BYTES_MAX + 1)
        assert answer_to(port, too_long).startswith(b"HTTP/1.1 431 ")
        assert httpx.post(f"http://127.0.0.1:{port}/api/v1/stop").status_code == 200
        os.killpg(process.pid, signal.SIGINT)
        assert process.wait(END_WITHIN_S) == 0
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
