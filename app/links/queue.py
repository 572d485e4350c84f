"""One chip, one wire, many who want it: who is next.

A turn is a transaction of one or more frames. STOP overtakes COMMAND overtakes SAMPLE, at the latest
between two frames of a turn: whoever is overtaken goes on afterwards, before its equals, so a
read-modify-write stays whole against other writers. Samples never hold up a command by more than
one frame, and only a few may wait; more are refused and counted.

On an idle link nobody waits and no task switches.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from types import TracebackType
from typing import Self

from app.links.errors import LinkError, LinkTimeout, WrongState
from app.links.port import FramePort

SAMPLES_WAITING_MAX = 8


class Priority(IntEnum):
    """Smaller goes first."""

    STOP = 0
    COMMAND = 1
    SAMPLE = 2


class SampleDropped(WrongState):
    """The link is too busy for one more sample; the next may find it free."""


@dataclass(slots=True)
class QueueCounts:
    """What has happened on a link since it was made."""

    frames: list[int] = field(default_factory=lambda: [0, 0, 0])
    """Frames sent, by priority."""
    waited: int = 0
    """Turns that found the link busy."""
    overtaken: int = 0
    """Times that a turn gave way between two frames."""
    samples_dropped: int = 0
    timeouts: int = 0
    failures: int = 0
    """Failed exchanges of any kind, timeouts included."""


class LinkQueue:
    """The only way to a port. `on_result` hears of each change between working and failing."""

    def __init__(
        self,
        port: FramePort,
        on_result: Callable[[LinkError | None], None] | None = None,
        samples_waiting_max: int = SAMPLES_WAITING_MAX,
    ) -> None:
        self.port = port
        self.counts = QueueCounts()
        self.error: LinkError | None = None
        """Why the latest exchange failed; None after a good one."""
        self._on_result = on_result
        self._samples_waiting_max = samples_waiting_max
        self._busy = False
        self._waiting: tuple[deque[asyncio.Future[None]], ...] = (deque(), deque(), deque())

    @property
    def busy(self) -> bool:
        return self._busy

    def waiting(self, priority: Priority) -> int:
        """How many turns of that priority wait."""
        return sum(not waiter.done() for waiter in self._waiting[priority])

    async def exchange(
        self, frame: bytes, priority: Priority = Priority.COMMAND, timeout_s: float | None = None
    ) -> bytes:
        """A turn of one frame. Raises what `FramePort.exchange` raises, and SampleDropped."""
        await self._acquire(priority)
        try:
            return await self._send(frame, priority, timeout_s)
        finally:
            self._release()

    async def sample(self, frames: Sequence[bytes], timeout_s: float | None = None) -> tuple[float, bytes]:
        """One sample over the wire: time in the middle between first and last answer [s], joined replies."""
        async with self.turn(Priority.SAMPLE) as turn:
            replies = [await turn.exchange(frames[0], timeout_s)]
            first_s = self.port.last_exchange_s
            for frame in frames[1:]:
                replies.append(await turn.exchange(frame, timeout_s))  # noqa: PERF401 (one at a time is the point)
            return (first_s + self.port.last_exchange_s) / 2, b"".join(replies)

    def turn(self, priority: Priority = Priority.COMMAND, guard: Callable[[], None] | None = None) -> Turn:
        """`async with queue.turn() as turn: await turn.exchange(frame)`.

        `guard` is called right before each frame goes out and may raise: how a command learns that
        a stop overtook it.
        """
        return Turn(self, priority, guard)

    async def _send(self, frame: bytes, priority: Priority, timeout_s: float | None) -> bytes:
        self.counts.frames[priority] += 1
        try:
            reply = await self.port.exchange(frame, timeout_s)
        except LinkError as error:
            self.counts.failures += 1
            self.counts.timeouts += isinstance(error, LinkTimeout)
            changed = self.error is None
            self.error = error
            if changed and self._on_result is not None:
                self._on_result(error)
            raise
        if self.error is not None:
            self.error = None
            if self._on_result is not None:
                self._on_result(None)
        return reply

    async def _acquire(self, priority: Priority) -> None:
        if not self._busy:
            self._busy = True
            return
        if priority is Priority.SAMPLE and self.waiting(Priority.SAMPLE) >= self._samples_waiting_max:
            self.counts.samples_dropped += 1
            raise SampleDropped(f"{self.port.name}: {self._samples_waiting_max} samples wait already")
        self.counts.waited += 1
        await self._wait(priority, first=False)

    async def _wait(self, priority: Priority, *, first: bool) -> None:
        waiter: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        line = self._waiting[priority]
        if first:
            line.appendleft(waiter)
        else:
            line.append(waiter)
        try:
            await waiter
        except asyncio.CancelledError:
            if waiter.done() and not waiter.cancelled():
                self._release()  # the link was handed to us just before we were cancelled
            raise

    def _release(self) -> None:
        for line in self._waiting:
            while line:
                waiter = line.popleft()
                if not waiter.done():
                    waiter.set_result(None)  # handed over: the link stays busy
                    return
        self._busy = False

    def _wanted_by_better(self, priority: Priority) -> bool:
        return any(not waiter.done() for line in self._waiting[:priority] for waiter in line)


class Turn:
    """A transaction: frames of one asker in a row, only more urgent ones may come between."""

    __slots__ = ("_guard", "_held", "_priority", "_queue")

    def __init__(self, queue: LinkQueue, priority: Priority, guard: Callable[[], None] | None) -> None:
        self._queue = queue
        self._priority = priority
        self._guard = guard
        self._held = False

    async def __aenter__(self) -> Self:
        await self._queue._acquire(self._priority)
        self._held = True
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._held:
            self._held = False
            self._queue._release()

    async def exchange(self, frame: bytes, timeout_s: float | None = None) -> bytes:
        """Send one frame of this turn."""
        queue = self._queue
        if self._priority and queue._wanted_by_better(self._priority):
            queue.counts.overtaken += 1
            self._held = False  # should the wait be cancelled, the link is not ours to release
            queue._release()
            await queue._wait(self._priority, first=True)
            self._held = True
        if self._guard is not None:
            self._guard()
        return await queue._send(frame, self._priority, timeout_s)

    @property
    def last_exchange_s(self) -> float:
        """When the latest frame of this turn was exchanged, device time [s]."""
        return self._queue.port.last_exchange_s
