"""Saves in the background: soon, many changes at once, and again where the disk took nothing."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Callable
from contextvars import Context
from pathlib import Path
from typing import Protocol, TypeVar

from ..clock import Clock

log = logging.getLogger("stepscope.store")

RETRY_S = 5.0
"""What could not be written is tried again after that [s]."""
SETTLED_WITHIN_S = 2.0
"""How long an answer waits for the disk at most [s]."""

T_contra = TypeVar("T_contra", contravariant=True)
T = TypeVar("T")


class Store(Protocol[T_contra]):
    """What has a file to save to."""

    @property
    def path(self) -> Path: ...

    def save(self, what: T_contra, /) -> None:
        """Raises OSError."""
        ...


class Saver:
    """`request` is cheap and for any change; `close` waits until the last one is on disk, or has failed once more.

    What changes all the time is written no more often than every `spacing_s` of `clock` [s]; what could not be written
    is tried again every `RETRY_S` of it.
    """

    def __init__(self, store: Store[T], collect: Callable[[], T], clock: Clock, spacing_s: float = 0.0) -> None:
        self._path = store.path

        async def save_now() -> None:
            # In a thread: waiting for a disk must not hold up the motors.
            await asyncio.to_thread(store.save, collect())

        self._save_now = save_now
        self._clock = clock
        self._spacing_s = spacing_s
        self._task: asyncio.Task[None] | None = None
        self._pause: asyncio.Task[None] | None = None
        self._wanted = self._saved = self._tried = 0
        """Numbers of requests: the latest one, the latest that is on disk, the latest that was tried."""
        self._news = asyncio.Condition()
        self._closing = False
        self.problem: Exception | None = None
        """Why the latest save failed; None while all is kept."""

    def request(self) -> None:
        """Something changed."""
        self._wanted += 1
        if self._task is None or self._task.done():
            name = f"save {self._path.name}"
            # In a context of its own: else it would keep what belongs to a request as long as it is kept.
            self._task = asyncio.get_running_loop().create_task(self._save(), name=name, context=Context())
        elif self.problem is not None:
            self._go_on()  # the disk may have room by now, and the user wants to know

    async def settled(self, within_s: float = SETTLED_WITHIN_S) -> str:
        """Wait until what was requested so far is on disk; why it is not, or not yet, else ""."""
        wanted = self._wanted
        try:
            async with asyncio.timeout(within_s), self._news:
                await self._news.wait_for(lambda: self._tried >= wanted)
        except TimeoutError:
            return f"{self._path} takes longer than {within_s:g} s to write; it is still tried"
        return self.why_not

    @property
    def why_not(self) -> str:
        """Why the latest change is not on disk, for people; "" where it is."""
        if self.problem is None:
            return ""
        return f"{self._path} cannot be written: {self.problem}; it is tried again every {RETRY_S:g} s"

    async def close(self) -> None:
        """Return when everything requested is saved, or has failed."""
        self._closing = True
        self._go_on()
        while self._task is not None and not self._task.done():
            with contextlib.suppress(asyncio.CancelledError):
                await self._task
        self._closing = False

    def _go_on(self) -> None:
        if self._pause is not None:
            self._pause.cancel()

    async def _save(self) -> None:
        while self._saved < self._wanted:
            last, wanted = self._closing, self._wanted
            try:
                await self._save_now()
            except Exception as error:  # OSError, or what no document can hold: neither may end the saving for good
                if str(error) != str(self.problem):  # else it was said already
                    log.warning("%s is not saved: %s", self._path, error)
                self.problem = error
            else:
                self.problem, self._saved = None, wanted
            async with self._news:
                self._tried = wanted
                self._news.notify_all()
            if last and self.problem is not None:
                break
            pause_s = self._spacing_s if self.problem is None else RETRY_S
            if pause_s and not self._closing:
                self._pause = asyncio.create_task(self._clock.sleep(pause_s), name="pause between saves")
                await asyncio.wait({self._pause})
                self._pause = None
