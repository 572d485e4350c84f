"""`stepscope emulate` as its own process, as a user starts it."""

from __future__ import annotations

import contextlib
import os
import re
import select
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

START_WITHIN_S = 110.0
"""The first start on a machine compiles the motor; every other takes a second."""
END_WITHIN_S = 20.0


@dataclass(frozen=True)
class EmulatorProcess:
    """A running emulator: where it is, and where it is controlled."""

    process: subprocess.Popen[bytes]
    pty: Path | None
    tcp: tuple[str, int] | None
    control: str
    said: str

    def end(self, how: signal.Signals = signal.SIGTERM) -> int:
        """Ask it to end and wait for that; its exit code."""
        self.process.send_signal(how)
        return self.process.wait(END_WITHIN_S)


@contextlib.contextmanager
def emulator(*flags: str, pty: Path | None = None, model: str = "pd42-1241") -> Iterator[EmulatorProcess]:
    """A process that has said that it is ready. `flags` may name `--tcp` and `--control` ports; 0 is a free one."""
    where: Sequence[str] = () if pty is None else ("--pty", str(pty))
    command = [sys.executable, "-m", "app.cli", "emulate", model, *where, *flags]
    environment = {name: value for name, value in os.environ.items() if not name.startswith("STEPSCOPE_")}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment)
    try:
        said = _first_line(process)
        tcp = re.search(r"tcp ([\d.]+):(\d+)", said)
        control = re.search(r"control at (\S+?)(?:;|\s|$)", said)
        yield EmulatorProcess(
            process,
            pty,
            (tcp.group(1), int(tcp.group(2))) if tcp else None,
            control.group(1) if control else "",
            said,
        )
    finally:
        if process.poll() is None:
            process.terminate()
            try:
                process.wait(END_WITHIN_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        if process.stdout is not None:
            process.stdout.close()


def _first_line(process: subprocess.Popen[bytes]) -> str:
    """Raises RuntimeError with what it said instead of being ready."""
    assert process.stdout is not None
    said, until_s = b"", time.monotonic() + START_WITHIN_S
    while not said.endswith(b"ends it)\n"):
        ready, _, _ = select.select([process.stdout], [], [], max(0.0, until_s - time.monotonic()))
        more = os.read(process.stdout.fileno(), 4096) if ready else b""
        if not more:
            raise RuntimeError(f"the emulator is not ready: {said.decode(errors='replace')}")
        said += more
    return said.decode()
