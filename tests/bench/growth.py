"""The full bench for an hour: does the page or the server grow? `python -m tests.bench --only growth`.

12 panels, 24 channels at 1 kHz of three devices that move (`scope.py`). After each minute the page's garbage is
collected, and its heap with its typed arrays, its nodes and its listeners are counted, and the server's resident set.
What is judged is the slope after the warm-up, by which every history has its size (the page's: a minute, the
server's: ten), with the upper end of its interval at 95 %.
"""

from __future__ import annotations

import math
import re
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from playwright.sync_api import CDPSession, Page
from scipy.stats import theilslopes

from tests.bench.scope import Bench, full_bench
from tests.bench.table import Row

HOUR_S = 3600.0
WARM_S = 720.0
PERIOD_S = 60.0
QUICK_S, QUICK_WARM_S, QUICK_PERIOD_S = 150.0, 50.0, 5.0
LOOKS, LOOK_MS = 4, 300.0
MB = 1e6
BOUNDS = {
    "heap of the page": (5.0, "MB"),
    "nodes of the page": (60.0, ""),
    "listeners of the page": (60.0, ""),
    "resident set of the server": (10.0, "MB"),
}
"""The most that each may grow in an hour: a 20th of a heap; one node or listener a minute is one that is left over."""


def measure(quick: bool) -> Sequence[Row]:
    """One row for each thing that could grow."""
    lasts_s, warm_s, period_s = (QUICK_S, QUICK_WARM_S, QUICK_PERIOD_S) if quick else (HOUR_S, WARM_S, PERIOD_S)
    samples: list[tuple[float, ...]] = []
    with full_bench() as bench:
        tools = bench.page.context.new_cdp_session(bench.page)
        began_s = time.monotonic()
        while (now_s := time.monotonic() - began_s) < warm_s + lasts_s:
            samples.append((now_s, *_of_page(bench.page, tools), _resident_mb(bench)))
            print(", ".join(f"{each:.6g}" for each in samples[-1]), file=sys.stderr, flush=True)
            bench.page.wait_for_timeout(period_s * 1000)
        alive = bench.page.get_by_test_id("link-readout").first.inner_text()
    columns = np.array(samples)
    columns = columns[columns[:, 0] >= warm_s]
    return [
        _row(what, columns[:, 0], columns[:, at + 1], bench=bench, live="live" in alive)
        for at, what in enumerate(BOUNDS)
    ]


def _of_page(page: Page, tools: CDPSession) -> tuple[float, ...]:
    """Heap and typed arrays [MB], nodes, listeners: the least of some looks, for what is being drawn is no growth."""
    looks = []
    for _ in range(LOOKS):
        tools.send("HeapProfiler.collectGarbage")
        heap, counted = tools.send("Runtime.getHeapUsage"), tools.send("Memory.getDOMCounters")
        used_mb = (heap["usedSize"] + heap.get("backingStorageSize", 0)) / MB
        looks.append((used_mb, float(counted["nodes"]), float(counted["jsEventListeners"])))
        page.wait_for_timeout(LOOK_MS)
    return tuple(min(column) for column in zip(*looks, strict=True))


def _resident_mb(bench: Bench) -> float:
    status = Path(f"/proc/{bench.server.pid}/status").read_text()
    (kilobytes,) = re.findall(r"VmRSS:\s+(\d+) kB", status)
    return int(kilobytes) * 1024 / MB


def slope_of(times_s: NDArray[np.float64], values: NDArray[np.float64]) -> tuple[float, float]:
    """The growth in an hour as the median of all pairs has it, and the upper end of its interval at 95 %."""
    slope, _, _, most = theilslopes(values, times_s / HOUR_S, 0.95)
    return float(slope), float(most)


def _row(what: str, times_s: NDArray[np.float64], values: NDArray[np.float64], *, bench: Bench, live: bool) -> Row:
    bound, unit = BOUNDS[what]
    slope, worst = slope_of(times_s, values)
    span = f"{(times_s[-1] - times_s[0]) / 60:.3g} min"
    return Row(
        what=f"{bench.about}: {what}",
        measured=f"{slope:+.3g} {unit}/h, at most {worst:.3g}",
        peer=f"limit {bound:g} {unit}/h",
        ratio=bound / worst if worst > 0 else math.inf,
        required=f"< {bound:g} {unit}/h",
        ok=worst < bound and bench.whole and live,
        notes=(f"{len(values)} times in {span}, {values[0]:.5g} to {values[-1]:.5g} {unit}".rstrip(),),
    )
