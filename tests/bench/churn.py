"""Devices, tabs and recordings come and go for minutes: how much memory and how many descriptors stay behind."""

from __future__ import annotations

import asyncio
import os
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import httpx
from server_process import ServerProcess

from tests.api import churn
from tests.bench.table import Row

CHURN_S = 300.0
GROWTH_MAX = 0.05
SETTLE_S = 15.0
"""Until what was closed is closed: the longest wait of a link, and the kernel's own."""


def measure(quick: bool) -> Sequence[Row]:
    seconds = 30.0 if quick else CHURN_S
    with tempfile.TemporaryDirectory(prefix="stepscope-") as folder, ServerProcess(Path(folder), "--demo") as server:
        asyncio.run(_rounds(server.url, seconds / 5))  # tables, pools of threads and of memory, pages of the database
        time.sleep(SETTLE_S)
        memory, open_files = _memory_mb(server.pid), _descriptors(server.pid)
        rounds = asyncio.run(_rounds(server.url, seconds))
        time.sleep(SETTLE_S)
        after, left = _memory_mb(server.pid), _descriptors(server.pid) - open_files
    growth = after / memory - 1
    return [
        Row(
            what=f"{rounds} devices come and go in {seconds:.0f} s, with tabs and recordings",
            measured=f"{memory:.0f} MB before, {after:.0f} MB after, {left} more descriptors",
            peer=f"{GROWTH_MAX:.0%} more memory",
            ratio=growth / GROWTH_MAX,
            required="<= 5 %, no descriptor",
            ok=growth <= GROWTH_MAX and left <= 0,
        )
    ]


async def _rounds(url: str, seconds: float) -> int:
    limits = httpx.Limits(max_keepalive_connections=0)
    count, ends_s = 0, time.monotonic() + seconds
    async with httpx.AsyncClient(base_url=f"{url}/api/v1/", timeout=60, limits=limits) as api:
        while time.monotonic() < ends_s:
            await churn.one_round(url, api, churn.FAMILIES[count % len(churn.FAMILIES)])
            count += 1
    return count


def _memory_mb(pid: int) -> float:
    """What a process has of the machine's memory for itself [MB]."""
    fields = Path(f"/proc/{pid}/statm").read_text().split()
    return (int(fields[1]) - int(fields[2])) * os.sysconf("SC_PAGE_SIZE") / 1e6


def _descriptors(pid: int) -> int:
    return len(os.listdir(f"/proc/{pid}/fd"))
