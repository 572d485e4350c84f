"""A server that is killed while registers are written: does the audit log have all that was answered a second ago?"""

from __future__ import annotations

import os
import random
import signal
import sqlite3
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from server_process import ServerProcess

from app.client import Bench
from app.store.database import FILE_NAME
from tests.bench.table import Row

KILLS = 20
BEHIND_MAX_S = 1.0


def measure(quick: bool) -> Sequence[Row]:
    """`kill -9` at a random moment of a stream of writes, again and again on one data directory."""
    kills = 3 if quick else KILLS
    chance = random.Random(6)
    behind_s: list[float] = []
    took_s: list[float] = []
    value = 0
    with tempfile.TemporaryDirectory(prefix="stepscope-") as folder, ServerProcess(Path(folder), "--demo") as server:
        for kill in range(kills):
            if kill:
                server.start(int(server.url.rpartition(":")[2]))
            answered: dict[int, float] = {}
            with Bench(server.url) as bench:
                ends_s = time.monotonic() + 1.2 + chance.random()
                while time.monotonic() < ends_s:
                    value += 1
                    asked_s = time.monotonic()
                    bench.write("bench", "x_target", value, axis=2)
                    answered[value] = time.monotonic()
                    took_s.append(answered[value] - asked_s)
                    time.sleep(0.002)
                os.kill(server.pid, signal.SIGKILL)
                killed_s = time.monotonic()
            server.stop()
            kept = _kept(Path(folder) / FILE_NAME)
            missing = [killed_s - at_s for number, at_s in answered.items() if number not in kept]
            behind_s.append(max(missing, default=0.0))
    worst_s = max(behind_s)
    return [
        Row(
            what=f"kill -9 of the server while registers are written, {kills} times",
            measured=f"{worst_s:.2f} s of the audit log missing at worst",
            peer=f"{BEHIND_MAX_S:g} s",
            ratio=worst_s / BEHIND_MAX_S,
            required="<= 1 s missing",
            ok=worst_s <= BEHIND_MAX_S,
            notes=(f"{value} writes, a PUT answered in {sorted(took_s)[len(took_s) // 2] * 1e3:.2f} ms, median",),
        )
    ]


def _kept(path: Path) -> set[int]:
    """Values of x_target that the log has."""
    with sqlite3.connect(path) as file:
        found = {int(new) for (new,) in file.execute("SELECT new FROM audit WHERE subject = 'x_target'")}
    file.close()
    return found
