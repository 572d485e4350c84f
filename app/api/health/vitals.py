"""What the server measures of itself: how late its event loop is, and what its process uses."""

from __future__ import annotations

import asyncio
import contextlib
import os
import shutil
import sys
from collections import deque
from dataclasses import dataclass
from pathlib import Path

from ...clock import Clock, WallClock
from ...connections import Door
from ...devices.core.background_tasks import BackgroundTasks
from ..http.sockets import Sockets

BEAT_S = 0.1
"""How often the event loop's lateness is measured [s]."""
WINDOW_S = 60.0
DISK_WITHIN_S = 1.0
"""How long an answer waits for the disk [s]."""


class LoopLag:
    """How much later than wanted the event loop wakes a sleeper, over the last minute."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._seen: deque[tuple[float, float]] = deque()
        """When, and how late [s]."""
        self._due_s: float | None = None

    async def measure(self) -> None:
        """Sleep and look, for ever."""
        while True:
            self._due_s = self._clock.now() + BEAT_S
            await self._clock.sleep(BEAT_S)
            now_s = self._clock.now()
            self._seen.append((now_s, max(0.0, now_s - self._due_s)))
            self._forget(now_s)

    @property
    def now_s(self) -> float | None:
        """The latest [s]; None before the first."""
        return self._seen[-1][1] if self._seen else None

    @property
    def p99_s(self) -> float | None:
        """99 of 100 were not later than this [s]; None before the first."""
        self._forget(self._clock.now())
        late = sorted(lag_s for _, lag_s in self._seen)
        return late[min(len(late) - 1, int(len(late) * 0.99))] if late else None

    def by_second(self) -> list[float | None]:
        """The latest moment of each of the last 60 seconds, oldest first [s]; None where nothing was measured."""
        now_s = self._clock.now()
        self._forget(now_s)
        seconds: list[float | None] = [None] * round(WINDOW_S)
        for at_s, lag_s in self._seen:
            place = len(seconds) - 1 - int(now_s - at_s)
            if place >= 0:
                seconds[place] = max(seconds[place] or 0.0, lag_s)
        return seconds

    def _forget(self, now_s: float) -> None:
        while self._seen and self._seen[0][0] <= now_s - WINDOW_S:
            self._seen.popleft()


@dataclass(frozen=True, slots=True)
class Disk:
    """The disk under a directory; None where it did not tell."""

    free_bytes: int | None = None
    total_bytes: int | None = None
    writable: bool | None = None


class Vitals:
    """Measures from `start` to `close`. What others only know at their start they put here."""

    def __init__(self, clock: Clock, data_dir: Path) -> None:
        self._clock = clock
        self._data_dir = data_dir
        self.lag = LoopLag(WallClock())  # of the real loop on the real machine, whatever time a test owns
        self.sockets = Sockets()
        self.notes: list[str] = []
        """What was set aside or left out at the start, for people."""
        self.door: Door | None = None
        """The connections of the server; None where another program serves this application."""
        self._started_s = clock.now()
        self._disk_look: asyncio.Task[Disk] | None = None
        self._tasks = BackgroundTasks()

    def start(self) -> None:
        """Begin to measure. Needs a running event loop."""
        self._started_s = self._clock.now()
        self._tasks.begin(self.lag.measure(), "event loop lag")

    async def close(self) -> None:
        """End it."""
        await self._tasks.end()

    @property
    def uptime_s(self) -> float:
        """Since the start [s]."""
        return self._clock.now() - self._started_s

    async def disk(self) -> Disk:
        """The disk of the data directory. One that is elsewhere may not answer: one thread at most waits for it."""
        if self._disk_look is None or self._disk_look.done():
            self._disk_look = asyncio.create_task(asyncio.to_thread(_disk_of, self._data_dir), name="disk")
        done, _ = await asyncio.wait({self._disk_look}, timeout=DISK_WITHIN_S)
        return next(iter(done)).result() if done else Disk()


def _disk_of(directory: Path) -> Disk:
    try:
        there = next(each for each in (directory, *directory.absolute().parents) if each.is_dir())
        usage = shutil.disk_usage(there)
        return Disk(usage.free, usage.total, os.access(there, os.W_OK | os.X_OK))
    except OSError:
        return Disk()


def descriptors_used() -> int | None:
    """Open files and sockets of this process; None where the system does not tell."""
    with contextlib.suppress(OSError):
        return len(os.listdir("/dev/fd")) - 1  # one was open for looking
    return None


def resident_bytes() -> int | None:
    """Memory of this process that is in RAM [bytes]; None where the system does not tell."""
    if sys.platform == "linux":
        with contextlib.suppress(OSError, ValueError):
            return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    return None
