"""The audit log: who did what, when, from where, and what came of it.

`add` costs a request next to nothing: entries wait in memory and go to the database together, at most `FLUSH_S` later.
The log is bounded: the oldest entries go. It never holds a token or a session's id, for it never sees one.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import Context, ContextVar
from dataclasses import replace
from itertools import count
from typing import TYPE_CHECKING

from ..clock import Clock
from ..devices.core.actor import Actor, actor
from ..devices.core.changes import DONE
from ..errors import StoreUnavailable
from .audit_entries import Entry, EntryFilter, Known, Value
from .database import Database

if TYPE_CHECKING:  # the page is there before the database is: see `database_file`
    from sqlalchemy.orm import Session

    from .audit_queries import AuditQueries

log = logging.getLogger("stepscope.audit")

FLUSH_S = 0.25
"""How long an entry waits for others to be written together [s]; with the writing itself it is on disk within 1 s."""
RETRY_S = 1.0
"""How often writing is tried again that the disk did not take [s]."""
KEPT = 200_000
"""Entries in the database; some 50 MB."""
TRIMMED_EVERY = 1000
WAITING_MAX = 20_000
"""Entries in memory while the database takes none; the oldest of them are lost, and counted."""


_last_number = count(time.time_ns() // 1000)
"""Of requests: another server on the same file, or the one before, has others."""


class Request:
    """One call from outside: what belongs to it is told once, and found together again."""

    __slots__ = ("changes", "failures", "number")

    def __init__(self) -> None:
        self.number = next(_last_number)
        self.changes = 0
        """Entries so far."""
        self.failures = 0
        """Those among them that are not done."""


_request: ContextVar[Request | None] = ContextVar("audited_request", default=None)


@contextmanager
def request_under_way() -> Iterator[Request]:
    """Count what is entered in this context."""
    request = Request()
    token = _request.set(request)
    try:
        yield request
    finally:
        _request.reset(token)


class AuditLog:
    """`add` from the loop; everything else waits for the database."""

    def __init__(
        self, database: Database, clock: Clock, unix_s: Callable[[], float] = time.time, first_after_s: float = FLUSH_S
    ) -> None:
        """`first_after_s`: how long its first entries wait [s]."""
        self._database, self._clock, self._unix_s = database, clock, unix_s
        self._flush_after_s = first_after_s
        self._waiting: deque[Entry] = deque()
        self._lost = 0
        self._since_trim = TRIMMED_EVERY  # so the first batch trims: an earlier version may have kept more
        self._task: asyncio.Task[None] | None = None
        self._pause: asyncio.Task[None] | None = None
        self._writing = asyncio.Lock()
        self._problem = ""
        self._closing = False

    # --- writing --------------------------------------------------------------------------------

    def note(
        self,
        action: str,
        subject: str = "",
        *,
        device: str | None = None,
        axis: int | None = None,
        old: Value = None,
        new: Value = None,
        outcome: str = DONE,
        detail: str = "",
        by: Actor | None = None,
    ) -> None:
        """`add` what happens now, by `by`, else by whoever this task works for."""
        who = by or actor.get()
        whose = who.name, who.kind, who.address
        at_unix_s = round(self._unix_s(), 6)  # as far as a date can tell: asked for by it, it is found
        self.add(Entry(at_unix_s, *whose, device, axis, action, subject, old, new, outcome, detail))

    def add(self, entry: Entry) -> None:
        """Keep it. Returns at once, and raises nothing: what cannot be kept is told in the log."""
        request = _request.get()
        if request is not None:
            request.changes += 1
            request.failures += not entry.outcome.startswith(DONE)
            entry = replace(entry, call=request.number)
        self._waiting.append(entry)
        self._shed()
        if not self._closing and (self._task is None or self._task.done()):
            # In a context of its own: it is nobody's request, and would keep what belongs to one as long as it is kept.
            loop = asyncio.get_running_loop()
            self._task = loop.create_task(self._write_soon(), name="audit log", context=Context())

    @property
    def why_not(self) -> str:
        """Why the latest entries are not on disk, for people; "" where they are."""
        return f"the audit log is not written: {self._problem}" if self._problem else ""

    async def close(self) -> None:
        """Write what waits, and end. What comes afterwards is lost."""
        self._closing = True
        if self._pause is not None:
            self._pause.cancel()
        if self._task is not None:
            await self._task
        await self._flush()
        if self._waiting:
            log.warning("%d entries of the audit log are lost", len(self._waiting))

    async def _write_soon(self) -> None:
        while self._waiting and not self._closing:
            await self._wait(RETRY_S if self._problem else self._flush_after_s)
            self._flush_after_s = FLUSH_S
            await self._flush()

    async def _wait(self, seconds: float) -> None:
        # A task of its own: `close` ends the waiting, and never a write that has begun.
        self._pause = asyncio.create_task(self._clock.sleep(seconds), name="audit log waits")
        await asyncio.wait({self._pause})

    async def _flush(self) -> None:
        """Write what waits; what the database does not take waits on."""
        async with self._writing:
            batch, lost = list(self._waiting), self._lost
            if not batch:
                return
            self._waiting.clear()
            self._since_trim += len(batch)
            trim = self._since_trim >= TRIMMED_EVERY
            written = [_loss(batch[0], lost), *batch] if lost else batch

            kept = KEPT if trim else None
            try:
                await self._database.write(lambda session: _on(session).insert_entries(written, kept))
            except StoreUnavailable as problem:
                self._waiting.extendleft(reversed(batch))
                self._shed()
                if str(problem) != self._problem:  # else it was said already
                    log.warning("the audit log is not written: %s; %s", problem, problem.way_out)
                self._problem = str(problem)
                return
            if self._problem:
                log.warning("the audit log is written again")
            self._problem = ""
            self._lost -= lost
            if trim:
                self._since_trim = 0

    def _shed(self) -> None:
        while len(self._waiting) > WAITING_MAX:
            self._waiting.popleft()
            self._lost += 1

    # --- reading --------------------------------------------------------------------------------

    async def search(self, wanted: EntryFilter, limit: int, before: int | None = None) -> list[Entry]:
        """The latest `limit` entries that are wanted, newest first; with `before` those with lower ids.

        Everything that was added before is among them. Raises StoreUnavailable.
        """
        await self._flush()
        return await self._database.read(lambda session: _on(session).search(wanted, limit, before))

    async def of_device(self, device: str, first: int) -> list[Entry]:
        """All entries of a device from the id `first` on, the oldest first. Raises StoreUnavailable."""
        await self._flush()
        return await self._database.read(lambda session: _on(session).of_device(device, first))

    async def first_of_call(self, call: int) -> int:
        """The lowest id of the entries of a request; 0 where it has none. Raises StoreUnavailable."""
        return await self._database.read(lambda session: _on(session).first_of_call(call))

    async def last_writes(self, device: str, before: int) -> list[Entry]:
        """Of each register of a device its last write before the id `before`, since the device was added last.

        Raises StoreUnavailable.
        """
        return await self._database.read(lambda session: _on(session).last_writes(device, before))

    async def first_since(self, unix_s: float) -> tuple[int, float | None]:
        """The id that entries since then begin with, and when the log itself begins [s]. Raises StoreUnavailable."""
        await self._flush()
        return await self._database.read(lambda session: _on(session).first_since(unix_s))

    async def known(self) -> Known:
        """All names that entries bear. Raises StoreUnavailable."""
        await self._flush()
        return await self._database.read(lambda session: _on(session).known())


def _on(session: Session) -> AuditQueries:
    """What is asked of the log: imported with the first session, for the page is there before the database is."""
    from .audit_queries import AuditQueries

    return AuditQueries(session)


def _loss(first: Entry, lost: int) -> Entry:
    return Entry(first.at_unix_s, "stepscope", "server", "", None, None, "lost entries", "audit log", new=lost)
