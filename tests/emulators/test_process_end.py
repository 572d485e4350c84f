"""`stepscope emulate CHIP` ends when it is asked to, whoever is connected and however it was started."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator

import pytest

from app.links import datagram32

END_WITHIN_S = 30.0
"""It takes half a second; what does not end at all does not end in a minute either."""


@contextlib.contextmanager
def emulate(*, in_background: bool = False) -> Iterator[subprocess.Popen[bytes]]:
    """A process, not yet ready. `in_background`: as a shell starts what has `&` behind it, with Ctrl-C ignored."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("STEPSCOPE_")}
    command = [sys.executable, "-m", "app.cli", "emulate", "tmc428", "--tcp", "127.0.0.1:0"]
    start = f"import os, signal; signal.signal(signal.SIGINT, signal.SIG_IGN); os.execv({command[0]!r}, {command!r})"
    process = subprocess.Popen(
        [sys.executable, "-c", start] if in_background else command, stdout=subprocess.PIPE, env=environment
    )
    assert process.stdout is not None
    try:
        yield process
    finally:
        process.kill()
        process.wait()
        process.stdout.close()


def port_of(process: subprocess.Popen[bytes]) -> int:
    """Where it listens, as soon as it does."""
    assert process.stdout is not None
    return int(process.stdout.readline().rpartition(b":")[2].split()[0])


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_with_a_client_who_asks_and_never_listens(how: signal.Signals) -> None:
    with emulate() as process, socket.create_connection(("127.0.0.1", port_of(process))) as client:
        client.setblocking(False)
        with contextlib.suppress(BlockingIOError):
            while True:  # until neither end takes any more: the answers lie in all buffers there are
                client.send(datagram32.read(0x39) * 4096)
        process.send_signal(how)
        assert process.wait(END_WITHIN_S) == 0


def test_started_in_the_background_of_a_shell() -> None:
    with emulate(in_background=True) as process:
        port_of(process)
        process.send_signal(signal.SIGINT)
        assert process.wait(END_WITHIN_S) == 0


def test_before_it_is_ready() -> None:
    with emulate() as process:
        process.send_signal(signal.SIGTERM)
        assert process.wait(END_WITHIN_S) == -signal.SIGTERM
