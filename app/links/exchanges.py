"""Frames over a port, one, many or a chain of them, each counted, timed and logged."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from ..errors import BadReply, LinkDown, LinkError, LinkTimeout
from .arbiter import Priority
from .frame_log import FrameLog
from .port import Answer, BatchPort, ChainPort, FramePort
from .wire_budget import Meter


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
    bytes_sent: int = 0
    bytes_received: int = 0


class Exchanges:
    """Sends frames for whoever has the line. `on_result` hears of each change between working and failing.

    beside : those of another way to the same port, which counts and logs with this one
    """

    def __init__(
        self,
        port: FramePort,
        on_result: Callable[[LinkError | None], None] | None = None,
        beside: Exchanges | None = None,
    ) -> None:
        self.port = port
        self.counts: QueueCounts = QueueCounts() if beside is None else beside.counts
        self.log: FrameLog = FrameLog() if beside is None else beside.log
        self.meter: Meter = Meter() if beside is None else beside.meter
        self.error: LinkError | None = None
        """Why the latest exchange failed; None after a good one."""
        self._on_result = on_result

    async def send(self, frame: bytes, priority: Priority, timeout_s: float | None, answer: Answer) -> bytes:
        """One frame over a port that takes one at a time."""
        start_s, start_unix_s = time.perf_counter(), time.time()
        try:
            if answer is Answer.ALWAYS:
                reply = await self.port.exchange(frame, timeout_s)
            else:
                try:
                    reply = await self.port.exchange(frame, timeout_s)
                except LinkTimeout:
                    reply = b""
        except LinkError as error:
            took_s = time.perf_counter() - start_s
            self._enter(priority, start_unix_s, (frame,), (_received(error),), (took_s,), error)
            self._failed(error)
            raise
        self._went_well(priority, start_unix_s, (frame,), (reply,), (time.perf_counter() - start_s,))
        return reply

    async def send_chain(
        self, port: ChainPort, frames: Sequence[bytes], priority: Priority, timeout_s: float | None
    ) -> list[bytes]:
        """All of the frames over a port that keeps them together."""
        start_s, start_unix_s = time.perf_counter(), time.time()
        try:
            replies = await port.exchange_chain(frames, timeout_s)
        except LinkError as error:
            took_s = time.perf_counter() - start_s
            unanswered = [b""] * (len(frames) - 1)
            self._enter(priority, start_unix_s, frames, [*unanswered, _received(error)], [took_s] * len(frames), error)
            self._failed(error)
            raise
        took_s = time.perf_counter() - start_s
        self._went_well(priority, start_unix_s, frames, replies, [took_s] * len(frames))
        return replies

    async def send_batch(
        self,
        port: BatchPort,
        frames: Sequence[bytes],
        priority: Priority,
        timeout_s: float | None,
        answer: Answer,
        preempted: Callable[[], bool],
    ) -> list[bytes]:
        """Up to all of the frames over a port that takes many; fewer as soon as it is `preempted`."""
        start_s, start_unix_s = time.perf_counter(), time.time()
        try:
            replies = await port.exchange_many(frames, preempted, timeout_s, answer)
        except LinkError as error:
            batch = port.batch
            done = len(batch.replies)
            rx, answered_s = [*batch.replies, _received(error)], [*batch.answered_s, time.perf_counter() - start_s]
            self._enter(priority, start_unix_s, frames[: done + 1], rx, answered_s, error)
            self._failed(error)
            raise
        if replies:
            sent = frames if len(replies) == len(frames) else frames[: len(replies)]
            self._went_well(priority, start_unix_s, sent, replies, port.batch.answered_s)
        return replies

    def _went_well(
        self,
        priority: Priority,
        start_unix_s: float,
        tx: Sequence[bytes],
        rx: Sequence[bytes],
        answered_s: Sequence[float],
    ) -> None:
        self._enter(priority, start_unix_s, tx, rx, answered_s)
        self.meter.count(len(tx))
        if self.error is not None:
            self.error = None
            if self._on_result is not None:
                self._on_result(None)

    def _enter(
        self,
        priority: Priority,
        start_unix_s: float,
        tx: Sequence[bytes],
        rx: Sequence[bytes],
        answered_s: Sequence[float],
        error: LinkError | None = None,
    ) -> None:
        counts = self.counts
        counts.frames[priority] += len(tx)
        if not isinstance(error, LinkDown):  # else there was no wire to send them on
            counts.bytes_sent += sum(map(len, tx))
        counts.bytes_received += sum(map(len, rx))
        self.log.add(priority, start_unix_s, tx, rx, answered_s, "" if error is None else str(error))

    def _failed(self, error: LinkError) -> None:
        self.counts.failures += 1
        self.counts.timeouts += isinstance(error, LinkTimeout)
        changed = self.error is None
        self.error = error
        if changed and self._on_result is not None:
            self._on_result(error)


def _received(error: LinkError) -> bytes:
    return error.reply if isinstance(error, BadReply) else b""
