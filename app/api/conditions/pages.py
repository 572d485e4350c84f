"""Which sessions have a page open, by its socket: the one thing that ends with a page however that ends.

A page says that it closes (`POST /lease/leave`), but cannot while its script is busy, and never when its browser dies:
Chromium gives a tab half a second for it. The socket of such a page ends all the same.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager

from ...clock import Clock
from ...devices.core.background_tasks import BackgroundTasks
from ...lease.lease import Lease

RETURN_S = 2.0
"""How long after a session's last socket ended it may be back without a loss: a page loaded anew, a short break of the
network [s]."""
QUIET_S = 1.5
"""A page that is there asks for something every second; what was still on its way when it closed comes before [s]."""


class Pages:
    """The open pages of each session; one that has the bench and closes its last page leaves it."""

    def __init__(self, lease: Lease, clock: Clock, anything_moves: Callable[[], Awaitable[bool]]) -> None:
        self._lease = lease
        self._clock = clock
        self._anything_moves = anything_moves
        self._open: Counter[str] = Counter()
        self._tasks = BackgroundTasks()

    @contextmanager
    def page(self, session: str) -> Iterator[None]:
        """A page of that session is open for as long as the block runs."""
        self._open[session] += 1
        try:
            yield
        finally:
            self._open[session] -= 1
            if not self._open[session]:
                del self._open[session]
                if self._lease.is_holder(session):
                    self._tasks.begin(self._after_the_last(session), "after the last page")

    async def close(self) -> None:
        """Wait for nobody any more."""
        await self._tasks.end()

    async def leave(self, session: str) -> None:
        """That session's last page is gone: the bench is free where nothing moves, else whoever wants it takes it."""
        if self._lease.leave(session) and (self._lease.on_vanish == "nothing" or not await self._anything_moves()):
            self._lease.end_left()

    async def _after_the_last(self, session: str) -> None:
        await self._clock.sleep(RETURN_S)
        quiet_s = self._lease.quiet_s(session)
        if not self._open[session] and quiet_s is not None and quiet_s >= QUIET_S:
            await self.leave(session)
