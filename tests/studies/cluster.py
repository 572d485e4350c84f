"""A Dask cluster on this machine: a real scheduler, and workers that a test may kill.

Its commands are those of docker/dask.compose.yaml, on loopback.
"""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path
from typing import Any, Self

import yaml

ROOT = Path(__file__).resolve().parents[2]
SERVICES: dict[str, dict[str, Any]] = yaml.safe_load((ROOT / "docker" / "dask.compose.yaml").read_text())["services"]
START_S = 60.0
LOOK_S = 0.05


class Cluster:
    """`with Cluster(folder) as cluster:`; all its processes end with it."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._file = folder / "scheduler.json"
        self.workers: list[subprocess.Popen[bytes]] = []
        self._scheduler: subprocess.Popen[bytes] | None = None

    def __enter__(self) -> Self:
        self._scheduler = self._dask(
            "scheduler", {"0.0.0.0": "127.0.0.1", "8786": "0"}, "--scheduler-file", str(self._file)
        )
        until_s = time.monotonic() + START_S
        while not self._file.exists() or not self._file.read_text().endswith("}"):
            assert time.monotonic() < until_s, self.log()
            time.sleep(LOOK_S)
        return self

    @property
    def address(self) -> str:
        """Where its scheduler listens: tcp://127.0.0.1:PORT."""
        return next(part for part in self._file.read_text().split('"') if part.startswith("tcp://"))

    def add_worker(self) -> None:
        """Another process with one thread; nothing starts it again when it dies."""
        here = {"tcp://scheduler:8786": self.address, "/tmp": str(self._folder)}
        self.workers.append(self._dask("worker", here, "--no-nanny"))

    def _dask(self, service: str, here: dict[str, str], *more: str) -> subprocess.Popen[bytes]:
        told = SERVICES[service]
        assert told["entrypoint"] == ["dask"]
        arguments = [here.get(part, part) for part in told["command"]] + list(more)
        with (self._folder / "dask.log").open("ab") as log:
            return subprocess.Popen(
                [sys.executable, "-m", "dask", *arguments], cwd=ROOT, stdout=log, stderr=subprocess.STDOUT
            )

    def log(self) -> str:
        """What its processes wrote."""
        return (self._folder / "dask.log").read_text(errors="replace")

    def __exit__(self, *_: object) -> None:
        for process in (*self.workers, self._scheduler):
            if process is not None:
                process.kill()
                process.wait()
