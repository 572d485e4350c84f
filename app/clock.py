"""Time as an argument: what the program asks for `now()`, and what a test may own instead.

Emulators never sleep and never look at a wall clock. They catch up to `Clock.now()` in whole chip
ticks when they are talked to, so the same emulator serves a live bench, a test that runs ten
minutes of motion in a second, and a search that tries ten thousand settings.
"""

from __future__ import annotations

import asyncio
import contextlib
import heapq
import itertools
import time
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Protocol, Self


class Clock(Protocol):
    """Seconds since an arbitrary origin, never backwards."""

    def now(self) -> float:
        """Return the time [s]."""
        ...

    async def sleep(self, seconds: float) -> None:
        """Return when `seconds` [s] of this clock have passed; zero or less only yields."""
        ...


class WallClock:
    """The machine's monotonic clock."""

    def now(self) -> float:
        return time.monotonic()

    async def sleep(self, seconds: float) -> None:
        await asyncio.sleep(max(0.0, seconds))


class FineSleep:
    """Sleeps that end within tenths of a millisecond: the event loop alone wakes up to one late, as epoll counts whole
    ones. The last milliseconds are slept by a thread of its own. On a clock that is not the machine's it is a sleep
    like any other. Use it as a context."""

    COARSE_S = 0.003
    """What is left to the thread [s]."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._thread = ThreadPoolExecutor(1, "fine sleep") if isinstance(clock, WallClock) else None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._thread is not None:
            self._thread.shutdown(wait=False)  # it sleeps for a moment at the most

    async def until(self, at_s: float) -> None:
        """Return when the clock shows `at_s` [s]; at once where it does already."""
        left_s = at_s - self._clock.now()
        if self._thread is None:
            if left_s > 0:
                await self._clock.sleep(left_s)
            return
        if left_s > self.COARSE_S:
            await self._clock.sleep(left_s - self.COARSE_S)
            left_s = at_s - self._clock.now()
        if left_s > 0:
            await asyncio.get_running_loop().run_in_executor(self._thread, time.sleep, left_s)


class VirtualClock:
    """A clock that stands still until its owner advances it; sleepers wake in order of their time."""

    def __init__(self, start_s: float = 0.0) -> None:
        self._now_s = start_s
        self._order = itertools.count()
        self._sleepers: list[tuple[float, int, asyncio.Future[None]]] = []

    def now(self) -> float:
        return self._now_s

    async def sleep(self, seconds: float) -> None:
        if seconds <= 0:
            await asyncio.sleep(0)
            return
        woken = asyncio.get_running_loop().create_future()
        heapq.heappush(self._sleepers, (self._now_s + seconds, next(self._order), woken))
        await woken

    def set(self, now_s: float) -> None:
        """Jump to `now_s` [s] without waking anybody: for code that has no tasks."""
        if now_s < self._now_s:
            raise ValueError(f"time does not go back: now {self._now_s} s, asked {now_s} s")
        self._now_s = now_s

    async def advance(self, seconds: float) -> None:
        """Let `seconds` [s] pass, waking every sleeper at its own time and letting it run."""
        if seconds < 0:
            raise ValueError(f"time does not go back: advance by {seconds} s")
        end_s = self._now_s + seconds
        await self._settle()
        while self._sleepers and self._sleepers[0][0] <= end_s:
            wake_s, _, woken = heapq.heappop(self._sleepers)
            self._now_s = max(self._now_s, wake_s)
            if not woken.done():
                woken.set_result(None)
            await self._settle()
        self._now_s = end_s
        await self._settle()

    @staticmethod
    async def _settle() -> None:
        # A woken task may need several turns of the loop before it sleeps again (locks, queues,
        # gathered children). Twenty covers every chain in this program; more only costs time.
        for _ in range(20):
            await asyncio.sleep(0)


class ScaledClock:
    """Another clock, faster or slower: what an emulator's time scale turns.

    `scale` 1 is real time, 10 runs ten times as fast, 0 stands still. Changing it never makes the
    time jump.
    """

    def __init__(self, base: Clock, scale: float = 1.0, start_s: float = 0.0) -> None:
        """It shows `start_s` [s] at first."""
        self._base = base
        self._scale = scale
        self._scale_before = scale
        self._anchor_base_s = base.now()
        self._anchor_s = start_s
        self.skipped_s = 0.0
        """How much of its time was left out, `skip_to` having stood still [s]."""

    @property
    def base(self) -> Clock:
        """The clock that this one scales."""
        return self._base

    @property
    def scale(self) -> float:
        return self._scale

    @scale.setter
    def scale(self, scale: float) -> None:
        if not 0 <= scale <= 1000:
            raise ValueError(f"time scale {scale} is outside 0..1000")
        base_s = self._base.now()
        self._anchor_s = self.at(base_s)
        self._anchor_base_s = base_s
        self._scale_before, self._scale = self._scale, scale

    def now(self) -> float:
        return self.at(self._base.now())

    def at(self, base_s: float) -> float:
        """Return this clock's time [s] when the base clock shows `base_s` [s].

        A pure function of its argument: two clock reads, with whatever the system did between
        them, never stand for one moment. Before the latest change of scale the scale before holds.
        """
        since_s = base_s - self._anchor_base_s
        return self._anchor_s + since_s * (self._scale if since_s >= 0 else self._scale_before)

    def base_s(self, at_s: float) -> float:
        """What the base clock shows [s] when this one shows `at_s` [s]; infinite for a time that does not come."""
        ahead_s = at_s - self._anchor_s
        scale = self._scale if ahead_s >= 0 else self._scale_before
        if scale == 0:
            return self._anchor_base_s if ahead_s <= 0 else float("inf")
        return self._anchor_base_s + ahead_s / scale

    def skip_to(self, at_s: float) -> None:
        """Show `at_s` [s] now, as if it had stood still since then. Raises ValueError for a time to come."""
        base_s = self._base.now()
        skipped_s = self.at(base_s) - at_s
        if skipped_s < 0:
            raise ValueError(f"a clock that shows {self.at(base_s)} s cannot have stood still since {at_s} s")
        self._anchor_s, self._anchor_base_s = at_s, base_s
        self._scale_before = 0.0
        self.skipped_s += skipped_s

    async def sleep(self, seconds: float) -> None:
        if self._scale == 0 and seconds > 0:
            raise ValueError("a clock with time scale 0 never wakes anybody")
        await self._base.sleep(seconds / self._scale if seconds > 0 else 0.0)


class OffsetClock(ScaledClock):
    """A clock that shows `offset_s` [s] more than another one, whose scale and stops it has: of emulators on one time.

    `skipped_s` goes on from what its owner had skipped before.
    """

    def __init__(self, shared: ScaledClock, offset_s: float, skipped_s: float = 0.0) -> None:
        super().__init__(shared.base, shared.scale)
        self._shared = shared
        self._offset_s = offset_s
        self._skipped_before_s = skipped_s - shared.skipped_s

    @property
    def scale(self) -> float:
        return self._shared.scale

    @scale.setter
    def scale(self, scale: float) -> None:
        self._shared.scale = scale

    @property
    def skipped_s(self) -> float:  # of a clock of its own it is a number that it keeps
        return self._skipped_before_s + self._shared.skipped_s

    @skipped_s.setter
    def skipped_s(self, value: float) -> None:
        del value  # as it is made: nothing is skipped yet

    def at(self, base_s: float) -> float:
        return self._shared.at(base_s) + self._offset_s

    def base_s(self, at_s: float) -> float:
        return self._shared.base_s(at_s - self._offset_s)

    def skip_to(self, at_s: float) -> None:
        self._shared.skip_to(at_s - self._offset_s)


HELD_MAX_S = 0.1
"""What is done in the background waits no longer than that for what is urgent [s]."""
TURN_S = 2e-3
"""How much of it is begun in one turn of the event loop [s]."""


class BackgroundClock:
    """Another clock, for work in the background: its sleepers come a few at a time, and after what is urgent.

    A turn of the event loop runs everything that is due, and a request takes several turns: with many devices each
    would wait for all their looks. Nobody waits who sleeps no time.
    """

    def __init__(self, base: Clock) -> None:
        self.now: Callable[[], float] = base.now  # not a method of our own: emulators ask it for every frame
        self._base = base
        self._urgent = 0
        self._turn_began_s: float | None = None
        """When the first client came in this turn of the loop; None where none has."""
        self._waiting: deque[asyncio.Future[None]] = deque()
        self._overdue = 0
        """How many of those have waited so long that they come, whatever is urgent."""
        self._limit: asyncio.Task[None] | None = None

    @contextlib.contextmanager
    def urgent(self) -> Iterator[None]:
        """Nobody comes meanwhile, for `HELD_MAX_S` [s]."""
        self._urgent += 1
        self._limit_waits()
        try:
            yield
        finally:
            self._urgent -= 1
            if self._turn_began_s is None:
                self._next_turn()

    async def sleep(self, seconds: float) -> None:
        await self._base.sleep(seconds)
        if seconds > 0:
            await self.turn()

    async def turn(self) -> None:
        """Return when what is next may be done: for work in the background that does not sleep first."""
        if self._comes_now():
            return
        waiting = asyncio.get_running_loop().create_future()
        self._waiting.append(waiting)
        self._limit_waits()
        await waiting

    def _comes_now(self) -> bool:
        if self._urgent or self._waiting:
            return False
        if self._turn_began_s is None:
            self._begin_turn()
            return True
        return self.now() - self._turn_began_s < TURN_S

    def _begin_turn(self) -> None:
        self._turn_began_s = self.now()
        asyncio.get_running_loop().call_soon(self._next_turn)

    def _next_turn(self) -> None:
        """Wake the one that has waited longest, if anybody may come."""
        self._turn_began_s = None
        while self._waiting and (self._overdue or not self._urgent):
            waiting = self._waiting.popleft()
            self._overdue = max(0, self._overdue - 1)
            if not waiting.done():  # else it was cancelled
                waiting.set_result(None)
                self._begin_turn()
                return

    def _limit_waits(self) -> None:
        if self._urgent and self._waiting and self._limit is None:
            self._limit = asyncio.create_task(self._wait_no_longer(), name="background work that waits")

    async def _wait_no_longer(self) -> None:
        while self._urgent and self._waiting:
            await self._base.sleep(HELD_MAX_S)
            self._overdue = len(self._waiting)
            if self._turn_began_s is None:
                self._next_turn()
        self._limit = None
