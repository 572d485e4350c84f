"""A server that is killed while it records: does every file open, and how much of the end is missing?"""

from __future__ import annotations

import os
import random
import signal
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from server_process import ServerProcess

from app.client import Bench
from app.store.recordings.file import read_head, read_rows
from app.store.recordings.library import Library
from tests.bench.table import Row

KILLS = 50
MISSING_MAX_S = 1.0
CHANNELS = [f"{quantity}.0" for quantity in ("position", "velocity", "target_position", "residual")]
RATE_HZ = 500.0


def measure(quick: bool) -> Sequence[Row]:
    """`kill -9` at a random moment of a recording, again and again on the same data directory."""
    kills = 5 if quick else KILLS
    chance = random.Random(6)
    missing_s: list[float] = []
    unreadable = 0
    with tempfile.TemporaryDirectory(prefix="stepscope-") as folder, ServerProcess(Path(folder), "--demo") as server:
        for kill in range(kills):
            if kill:
                server.start(int(server.url.rpartition(":")[2]))
            with Bench(server.url) as bench:
                recording = bench.record("bench", CHANNELS, RATE_HZ).id
                bench.move("bench", 0, 200_000, wait=False)
                time.sleep(0.3 + chance.random())
                killed_unix_s = time.time()
                os.kill(server.pid, signal.SIGKILL)
            server.stop()
            path = Path(folder) / "recordings" / f"{recording}.arrows"
            try:
                head, rows = read_head(path), read_rows(path)
                missing_s.append(killed_unix_s - head.time_origin_unix_s - float(rows.time_s[-1]))
            except Exception:  # whatever it is, the file did not open
                unreadable += 1
        listed = sum(entry.head is not None for entry in Library(Path(folder)).page().entries)
    worst_s = max(missing_s, default=float("inf"))
    return [
        Row(
            what=f"kill -9 of the server during a recording, {kills} times",
            measured=f"{listed} open, {worst_s:.2f} s missing at worst",
            peer=f"{MISSING_MAX_S:g} s",
            ratio=worst_s / MISSING_MAX_S,
            required="all open, <= 1 s missing",
            ok=unreadable == 0 and listed == kills and worst_s <= MISSING_MAX_S,
            notes=(f"{len(CHANNELS)} channels at {RATE_HZ:g} Hz, the motor moving",),
        )
    ]
