"""One physical line, many who want it: who is next.

STOP overtakes COMMAND overtakes SAMPLE. Whoever holds the line gives it back after each turn, or
between two frames when `most_urgent` is more urgent. Several queues share one arbiter where several
modules share one line. On an idle line nobody waits and no task switches.
"""

from __future__ import annotations

import asyncio
from collections import deque
from enum import IntEnum


class Priority(IntEnum):
    """Smaller goes first."""

    STOP = 0
    COMMAND = 1
    SAMPLE = 2


NOBODY = len(Priority)


class Arbiter:
    """Hands the line from one asker to the next. For one event loop; only `most_urgent` may be read elsewhere."""

    def __init__(self) -> None:
        self.most_urgent: int = NOBODY
        """Priority of the most urgent who waits, `NOBODY` if none does: one plain number, so that the thread of a port
        can look at it between two frames."""
        self._busy = False
        self._waiting: tuple[deque[asyncio.Future[None]], ...] = tuple(deque() for _ in Priority)

    @property
    def busy(self) -> bool:
        return self._busy

    def waiting(self, priority: Priority) -> int:
        """How many of that priority wait."""
        return sum(not waiter.done() for waiter in self._waiting[priority])

    def take_if_idle(self) -> bool:
        """Take the line if nobody has it."""
        if self._busy:
            return False
        self._busy = True
        return True

    async def wait(self, priority: Priority) -> None:
        """Wait in line. The line is ours on return, and not after an error."""
        waiter: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting[priority].append(waiter)
        self.most_urgent = min(self.most_urgent, priority)
        await self._granted(waiter)

    async def give_way(self, priority: Priority) -> None:
        """Let the more urgent go first, then go on before one's equals. As after `wait` the line is ours on return."""
        waiter: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting[priority].appendleft(waiter)
        self.release()  # hands it back to us where whoever was more urgent has gone meanwhile
        await self._granted(waiter)

    async def _granted(self, waiter: asyncio.Future[None]) -> None:
        try:
            await waiter
        except asyncio.CancelledError:
            if waiter.done() and not waiter.cancelled():
                self.release()  # the line was handed to us just before we were cancelled
            else:
                self._recheck()
            raise

    def release(self) -> None:
        """Hand the line to the next, if there is one."""
        for line in self._waiting:
            while line:
                waiter = line.popleft()
                if not waiter.done():
                    waiter.set_result(None)  # handed over: the line stays busy
                    self._recheck()
                    return
        self._busy = False
        self.most_urgent = NOBODY

    def _recheck(self) -> None:
        for priority, line in enumerate(self._waiting):
            if any(not waiter.done() for waiter in line):
                self.most_urgent = priority
                return
        self.most_urgent = NOBODY
