"""One device's way to its line, for many who want it.

A turn is a transaction of one or more frames. STOP overtakes COMMAND overtakes SAMPLE, at the latest
between two frames of a turn: whoever is overtaken goes on afterwards, before its equals, so a
read-modify-write stays whole against other writers. Samples never hold up a command by more than
one frame, and only a few may wait; more are refused and counted.

Where replies belong to the frame before (`ChainPort`), what one call of `exchange_many` sends is a
chain that nobody cuts: then a stop may have to wait for one chain.

Devices that share a line share its arbiter. On an idle line nobody waits and no task switches.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import TracebackType
from typing import Protocol, Self

from ..errors import LinkDown, LinkError, WrongState
from .arbiter import Arbiter, Priority
from .exchanges import Exchanges, QueueCounts
from .port import Answer, BatchPort, ChainPort, FramePort
from .waits import Waits

__all__ = ["FrameGate", "FrameHold", "LinkQueue", "Priority", "QueueCounts", "SampleDropped", "Turn"]

SAMPLES_WAITING_MAX = 8


class FrameGate(Protocol):
    """A check of what is about to go out, which may refuse it."""

    def writes(self, frames: Sequence[bytes]) -> bool:
        """Whether the other three want to hear of these frames."""
        ...

    def check(self, frames: Sequence[bytes]) -> None:
        """Raises where one of them must not go out; then none does. Frames of a stop are not asked about."""
        ...

    def sent(self, frames: Sequence[bytes], replies: Sequence[bytes]) -> None:
        """They went out and were answered."""
        ...

    def mark_unknown(self, frames: Sequence[bytes]) -> None:
        """They may have gone out, or some of them."""
        ...


class FrameHold(Protocol):
    """A check that knows what the device must not be sent at present, stops included."""

    def refuse(self, frames: Sequence[bytes], priority: Priority, by_hand: bool) -> None:
        """Raises where one of `frames`, about to go out, must not: then none does. `by_hand`: spelled out by a user."""
        ...

    def saw(self, frames: Sequence[bytes], replies: Sequence[bytes]) -> None:
        """The first of `frames` were answered by `replies`."""
        ...


class SampleDropped(WrongState):
    """The link is too busy for one more sample; the next may find it free."""


class LinkQueue:
    """The only way to a port. `on_result` hears of each change between working and failing."""

    def __init__(
        self,
        port: FramePort,
        on_result: Callable[[LinkError | None], None] | None = None,
        samples_waiting_max: int = SAMPLES_WAITING_MAX,
        main: LinkQueue | None = None,
    ) -> None:
        self.port = port
        self.exchanges: Exchanges = Exchanges(port, on_result, None if main is None else main.exchanges)
        self.counts = self.exchanges.counts
        self.log = self.exchanges.log
        self.waits: Waits = Waits() if main is None else main.waits
        self.gate: FrameGate | None = None
        """Asked about every frame that goes out; None where everything may."""
        self.holds: tuple[FrameHold, ...] = ()
        """Asked about every frame right before it goes out, after all waiting, and told of every answer."""
        self.sample_span_s = (0.0, 0.0)
        """When the first and the last frame of the latest sample were answered, device time [s]."""
        self.arbiter: Arbiter = _arbiter_of(port) if main is None else main.arbiter
        """Who is next on the line."""
        self._samples_waiting_max = samples_waiting_max
        self._main = main
        """Where this is a second way to a port: the first one."""
        self._closed = False

    @property
    def error(self) -> LinkError | None:
        """Why the latest exchange failed; None after a good one."""
        return self.exchanges.error

    @property
    def closed(self) -> bool:
        """Whether nothing goes out any more: a frame that waited for its turn would open the port anew."""
        return self._closed if self._main is None else self._main.closed

    @closed.setter
    def closed(self, closed: bool) -> None:
        if self._main is None:
            self._closed = closed
        else:
            self._main.closed = closed

    @property
    def busy(self) -> bool:
        """Whether the line is taken, by this device or another one on it."""
        return self.arbiter.busy

    @property
    def calls_per_s(self) -> float:
        """Frames that this device exchanged, over the last two seconds [1/s]."""
        return self.exchanges.meter.rate()

    def waiting(self, priority: Priority) -> int:
        """How many turns of that priority wait for the line."""
        return self.arbiter.waiting(priority)

    def beside(self) -> LinkQueue:
        """A second way to the same port: it waits for the same line, and counts and logs with this one, and nobody
        holds back what goes over it."""
        return LinkQueue(self.port, None, self._samples_waiting_max, self if self._main is None else self._main)

    async def exchange(
        self,
        frame: bytes,
        priority: Priority = Priority.COMMAND,
        timeout_s: float | None = None,
        answer: Answer = Answer.ALWAYS,
    ) -> bytes:
        """A turn of one frame. Raises what `FramePort.exchange` raises, and SampleDropped."""
        async with Turn(self, priority, None) as turn:
            return await turn.exchange(frame, timeout_s, answer)

    async def exchange_many(
        self, frames: Sequence[bytes], priority: Priority = Priority.COMMAND, timeout_s: float | None = None
    ) -> list[bytes]:
        """A turn of many frames: `Turn.exchange_many`."""
        async with Turn(self, priority, None) as turn:
            return await turn.exchange_many(frames, timeout_s)

    async def sample(self, frames: Sequence[bytes], timeout_s: float | None = None) -> tuple[float, bytes]:
        """One sample over the wire: time in the middle between first and last answer [s], joined replies."""
        async with Turn(self, Priority.SAMPLE, None) as turn:
            replies = await turn.exchange_many(frames, timeout_s)
            first_s, last_s = self.sample_span_s = turn.span_s
            return (first_s + last_s) / 2, b"".join(replies)

    def turn(
        self,
        priority: Priority = Priority.COMMAND,
        guard: Callable[[], None] | None = None,
        *,
        by_hand: bool = False,
    ) -> Turn:
        """`async with queue.turn() as turn: await turn.exchange(frame)`.

        `guard` is called right before each frame (or batch) goes out and may raise: how a command
        learns that a stop overtook it. `by_hand`: a user spelled out the very frames.
        """
        return Turn(self, priority, guard, by_hand=by_hand)

    async def acquire(self, priority: Priority) -> None:
        """Have the line, after all that is more urgent. Raises SampleDropped where too many samples wait already."""
        arbiter = self.arbiter
        if arbiter.take_if_idle():
            return
        if priority is Priority.SAMPLE and arbiter.waiting(Priority.SAMPLE) >= self._samples_waiting_max:
            self.counts.samples_dropped += 1
            raise SampleDropped(f"{self.port.name}: {self._samples_waiting_max} samples wait already")
        self.counts.waited += 1
        with self.waits.one():
            await arbiter.wait(priority)


class Turn:
    """A transaction: frames of one asker in a row, only more urgent ones may come between."""

    __slots__ = ("_by_hand", "_guard", "_held", "_passed", "_priority", "_queue", "span_s")

    def __init__(
        self, queue: LinkQueue, priority: Priority, guard: Callable[[], None] | None, *, by_hand: bool = False
    ) -> None:
        self.span_s = (0.0, 0.0)
        """When the first and the last frame of the latest `exchange_many` were answered, device time [s]."""
        self._queue = queue
        self._priority = priority
        self._guard = guard
        self._by_hand = by_hand
        self._held = False
        self._passed = False
        """Whether the gate has let pass what is being sent."""

    async def __aenter__(self) -> Self:
        await self._queue.acquire(self._priority)
        self._held = True
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._held:
            self._held = False
            self._queue.arbiter.release()

    async def exchange(self, frame: bytes, timeout_s: float | None = None, answer: Answer = Answer.ALWAYS) -> bytes:
        """Send one frame of this turn; b"" where it was not answered and need not be."""
        queue = self._queue
        if queue.gate is not None and not self._passed and queue.gate.writes((frame,)):
            return (await self._gated(queue.gate, (frame,), timeout_s, answer))[0]
        if (batches := queue.port.traits.batches) is not None:
            return (await self._pieces(batches, (frame,), timeout_s, answer))[0]
        await self._prepare((frame,))
        return self._saw((frame,), [await queue.exchanges.send(frame, self._priority, timeout_s, answer)])[0]

    async def exchange_many(self, frames: Sequence[bytes], timeout_s: float | None = None) -> list[bytes]:
        """Send frames one after another and return the replies; only more urgent ones come between, and nobody at all
        over a `ChainPort`.

        `timeout_s` [s] is for each frame, or for the chain. The first failure ends it and is raised.
        """
        queue = self._queue
        if queue.gate is not None and not self._passed and queue.gate.writes(frames):
            return await self._gated(queue.gate, frames, timeout_s)
        traits = queue.port.traits
        if traits.batches is not None:
            return await self._pieces(traits.batches, frames, timeout_s, Answer.ALWAYS)
        if traits.chains is not None:
            return await self._chain(traits.chains, frames, timeout_s)
        replies = []
        first_s: float | None = None
        for frame in frames:
            await self._prepare((frame,))
            replies += self._saw(
                (frame,), [await queue.exchanges.send(frame, self._priority, timeout_s, Answer.ALWAYS)]
            )
            first_s = queue.port.last_exchange_s if first_s is None else first_s
        self.span_s = (first_s or 0.0, queue.port.last_exchange_s)
        return replies

    async def _gated(
        self, gate: FrameGate, frames: Sequence[bytes], timeout_s: float | None, answer: Answer | None = None
    ) -> list[bytes]:
        """`exchange_many` (with `answer`: `exchange`) of frames that the gate wants to hear of.

        What stops a motor passes, whatever it is.
        """
        if self._priority is not Priority.STOP:
            gate.check(frames)
        self._passed = True
        try:
            if answer is None:
                replies = await self.exchange_many(frames, timeout_s)
            else:
                replies = [await self.exchange(frames[0], timeout_s, answer)]
        except BaseException:
            gate.mark_unknown(frames)
            raise
        finally:
            self._passed = False
        gate.sent(frames, replies)
        return replies

    @property
    def last_exchange_s(self) -> float:
        """When the latest frame of this turn was exchanged, device time [s]."""
        return self._queue.port.last_exchange_s

    def device_time_s(self) -> float:
        """The device's time now [s]."""
        return self._queue.port.device_time_s()

    async def _chain(self, port: ChainPort, frames: Sequence[bytes], timeout_s: float | None) -> list[bytes]:
        if not frames:
            return []
        await self._prepare(frames)
        replies = self._saw(frames, await self._queue.exchanges.send_chain(port, frames, self._priority, timeout_s))
        self.span_s = (port.last_exchange_s, port.last_exchange_s)
        return replies

    async def _pieces(
        self, port: BatchPort, frames: Sequence[bytes], timeout_s: float | None, answer: Answer
    ) -> list[bytes]:
        exchanges = self._queue.exchanges
        replies: list[bytes] = []
        first_s: float | None = None
        while len(replies) < len(frames):
            rest = frames[len(replies) :] if replies else frames
            await self._prepare(rest)
            sent = exchanges.send_batch(port, rest, self._priority, timeout_s, answer, self._preempted)
            got = self._saw(rest, await sent)
            if got and first_s is None:
                first_s = port.batch.started_s + port.batch.answered_s[0]
            replies = replies + got if replies else got
        self.span_s = (first_s or 0.0, port.last_exchange_s)
        return replies

    def _preempted(self) -> bool:
        """Whether a more urgent caller waits for the line. The thread of a `BatchPort` asks too."""
        return self._queue.arbiter.most_urgent < self._priority

    def _saw(self, frames: Sequence[bytes], replies: list[bytes]) -> list[bytes]:
        for hold in self._queue.holds:
            hold.saw(frames, replies)
        return replies

    async def _prepare(self, frames: Sequence[bytes]) -> None:
        """Right before `frames` go out: let the more urgent go first, see whether the link is still in use, and ask the
        guard and the holds."""
        queue = self._queue
        if self._preempted():
            queue.counts.overtaken += 1
            self._held = False  # should the wait be cancelled, the line is not ours to release
            await queue.arbiter.give_way(self._priority)
            self._held = True
        if queue.closed:
            raise LinkDown(queue.port.name, "disconnected before this was sent")
        if self._guard is not None:
            self._guard()
        for hold in queue.holds:
            hold.refuse(frames, self._priority, self._by_hand)


def _arbiter_of(port: FramePort) -> Arbiter:
    batches = port.traits.batches
    return Arbiter() if batches is None else batches.arbiter
