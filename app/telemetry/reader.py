"""One client's queue: bounded, the oldest samples go first and are counted.

A reader that is slow, or a page in a sleeping tab, costs the server a fixed amount of memory and
nobody else a sample. Of the states (status) the latest wins; of events the oldest go.
"""

from __future__ import annotations

import asyncio
from collections import deque
from dataclasses import dataclass, field
from functools import cached_property

from ..devices.core.results import ChipEvents, MotionEnd, ProgramEvent
from .frames import FloatArray, encode_body, encode_header

QUEUED_S = 2.0
"""How much a reader may be behind [s] before it loses samples."""
QUEUED_ROWS_LEAST = 64
EVENTS_QUEUED = 64


@dataclass(frozen=True)
class Body:
    """Rows, shared by all readers of one subscription: `time_s` [rows], `samples` [rows, columns], NaN where a value is
    missing. `oldest_s` is server time of the first row [s]."""

    time_s: FloatArray
    samples: FloatArray
    oldest_s: float

    @property
    def rows(self) -> int:
        return len(self.time_s)

    @cached_property
    def data(self) -> bytes:
        """As they go over a socket: encoded once, and only where there is one."""
        return encode_body(self.time_s, self.samples)


@dataclass(frozen=True, slots=True)
class Rows:
    """Rows as a reader in this process takes them: `time_s` [rows], `columns` [columns, rows].

    dropped : rows that were lost so far
    """

    dropped: int
    time_s: FloatArray
    columns: FloatArray


@dataclass(frozen=True, slots=True)
class Status:
    """How the stream went since the last status."""

    achieved_rate_hz: float
    jitter_ms: float
    dropped: int
    latency_ms: float
    calls_per_s: float = 0.0
    """Questions that all users of this wire asked."""
    calls_per_s_possible: float | None = None
    """None where the wire sets no limit."""
    row_spread_ms: float = 0.0
    """From the first to the last question of a row."""


@dataclass(frozen=True, slots=True)
class Gap:
    """From here on samples are missing."""

    reason: str


@dataclass(frozen=True, slots=True)
class MoveSeen:
    """An axis was sent somewhere at device time `started_at_s` [s]."""

    axis: int
    started_at_s: float


Event = Status | Gap | MoveSeen | MotionEnd | ChipEvents | ProgramEvent


@dataclass(slots=True, eq=False)
class Reader:
    """What one socket still has to send. Made by `Feed.join`, ended by `Feed.leave`."""

    columns: int
    rows_max: int
    dropped: int = 0
    sequence: int = 0
    closed: str | None = None
    """Why nothing more will come; None while something may."""
    latency_s: float = 0.0
    """The longest way from a sample to its socket since the last status [s]."""
    _bodies: deque[Body] = field(default_factory=deque)
    _rows: int = 0
    _events: deque[Event] = field(default_factory=lambda: deque(maxlen=EVENTS_QUEUED))
    _status: Status | None = None
    _wake: asyncio.Event = field(default_factory=asyncio.Event)

    def push(self, body: Body) -> None:
        """Queue rows; where there are too many, the oldest go and are counted."""
        self._bodies.append(body)
        self._rows += body.rows
        while self._rows > self.rows_max and len(self._bodies) > 1:
            lost = self._bodies.popleft()
            self._rows -= lost.rows
            self.dropped += lost.rows
        self._wake.set()

    def tell(self, event: Event) -> None:
        """Queue an event; a status replaces one that was not sent yet."""
        if isinstance(event, Status):
            self._status = event
        else:
            self._events.append(event)
        self._wake.set()

    def close(self, reason: str) -> None:
        """Let the socket end after what is queued."""
        self.closed = reason
        self._wake.set()

    async def wait(self) -> None:
        """Return when there is something to take, or nothing more will come."""
        await self._wake.wait()
        self._wake.clear()  # before the taking: what comes meanwhile wakes again

    def take_events(self) -> list[Event]:
        """Events in order, the status last."""
        events = list(self._events)
        self._events.clear()
        if self._status is not None:
            events.append(self._status)
            self._status = None
        return events

    def take(self, now_s: float) -> bytes | None:
        """The next frame, or None where nothing waits. `now_s` [s] is server time, for the latency."""
        body = self._next(now_s)
        return None if body is None else self.frame(body.rows, body.data)

    def take_rows(self, now_s: float) -> Rows | None:
        """The same for who reads in this process: nothing is encoded."""
        body = self._next(now_s)
        return None if body is None else Rows(self.dropped, body.time_s, body.samples.T)

    def _next(self, now_s: float) -> Body | None:
        if not self._bodies:
            return None
        body = self._bodies.popleft()
        self._rows -= body.rows
        self.latency_s = max(self.latency_s, now_s - body.oldest_s)
        return body

    def frame(self, rows: int, body: bytes) -> bytes:
        """Rows under this reader's own header; also for history, which never waits in the queue."""
        header = encode_header(self.sequence, self.dropped, rows, self.columns)
        self.sequence += 1
        return header + body
