"""Models that only an installed package lists: how long a process that has just started takes to list and open them."""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
from collections.abc import Sequence

from tests.bench.table import Row

LIST_MAX_MS, OPEN_MAX_MS = 100.0, 300.0
SCRIPT = """
import json, time
import app.main
from app.registers import catalog
began = time.perf_counter()
found = catalog.listings()
listed_ms = (time.perf_counter() - began) * 1e3
name = max(found, key=lambda model: model.kind == "chip").name
began = time.perf_counter()
catalog.find_model(name)
print(json.dumps([len(found), listed_ms, (time.perf_counter() - began) * 1e3]))
"""


def measure(quick: bool) -> Sequence[Row]:
    runs = []
    for _ in range(3 if quick else 9):
        told = subprocess.run([sys.executable, "-c", SCRIPT], check=True, capture_output=True, text=True, timeout=120)
        runs.append(json.loads(told.stdout))
    count = runs[0][0]
    listed_ms, opened_ms = (statistics.median(run[index] for run in runs) for index in (1, 2))
    return [
        _row(f"listing {count} models of the package, the first time", listed_ms, LIST_MAX_MS),
        _row("opening one of them, the package imported for it", opened_ms, OPEN_MAX_MS),
    ]


def _row(what: str, measured_ms: float, most_ms: float) -> Row:
    return Row(
        what=what,
        measured=f"{measured_ms:.0f} ms",
        peer=f"{most_ms:.0f} ms",
        ratio=measured_ms / most_ms,
        required="below 1",
        ok=measured_ms < most_ms,
    )
