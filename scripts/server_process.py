"""A stepscope server as its own process, as a user starts it: for browser tests, the bench and the screenshots."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from pathlib import Path
from types import TracebackType
from typing import Self


class ServerProcess:
    """`with ServerProcess(data_dir) as server:` is a running server at `server.url`, ended when the block ends.

    Raises RuntimeError with the server's own words when it ends early or does not answer within `start_within_s` [s].
    """

    def __init__(self, data_dir: Path, *flags: str, start_within_s: float = 60.0) -> None:
        self.data_dir = data_dir
        self._flags = flags
        self._start_within_s = start_within_s
        self._log = tempfile.TemporaryFile()  # noqa: SIM115 - closed by __exit__
        self._process: subprocess.Popen[bytes] | None = None
        self.url = ""

    @property
    def pid(self) -> int:
        """The process id, for measuring what it costs."""
        if self._process is None:
            raise RuntimeError("the server is not running")
        return self._process.pid

    def log(self) -> str:
        """Return what the server has said so far."""
        # By its number, so that reading never moves the place where the server writes.
        return os.pread(self._log.fileno(), 1 << 20, 0).decode(errors="replace")

    def __enter__(self) -> Self:
        self.start(free_port())
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()
        self._log.close()

    def start(self, port: int) -> None:
        """Start on `port`; also again after `stop`, on the same data."""
        self.url = f"http://127.0.0.1:{port}"
        program = Path(sys.executable).with_name("stepscope")
        command = [str(program), "serve", "--port", str(port), "--data-dir", str(self.data_dir), *self._flags]
        self._process = subprocess.Popen(command, stdout=self._log, stderr=subprocess.STDOUT)
        until_s = time.monotonic() + self._start_within_s
        while not self._answers():
            if self._process.poll() is not None or time.monotonic() > until_s:
                self.stop()
                raise RuntimeError(f"{' '.join(command)} does not answer:\n{self.log()}")
            time.sleep(0.05)

    def stop(self) -> int:
        """End it as Ctrl-C does and return its exit code; a server that lingers for ten seconds is killed."""
        if self._process is None:
            return 0
        process, self._process = self._process, None
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        return process.returncode

    def _answers(self) -> bool:
        try:
            with urllib.request.urlopen(f"{self.url}/api/v1/health", timeout=1) as answer:
                return bool(answer.status == 200)
        except (urllib.error.URLError, OSError):
            return False


def free_port() -> int:
    """Return a TCP port of the loopback address that nothing listens on at this moment."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port
