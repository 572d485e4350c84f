"""Saves in the background: a change is written soon, many changes at once are written once."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Callable
from pathlib import Path
from typing import Protocol, TypeVar

from app.clock import Clock

log = logging.getLogger("stepscope.store")

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
    """`request` is cheap and for any change; `close` waits until the last one is on disk.

    With a `clock` what changes all the time is written no more often than every `spacing_s` of it [s].
    """

    def __init__(
        self, store: Store[T], collect: Callable[[], T], clock: Clock | None = None, spacing_s: float = 0.0
    ) -> None:
        self._path = store.path

        async def save_now() -> None:
            # In a thread: waiting for a disk must not hold up the motors.
            await asyncio.to_thread(store.save, collect())

        self._save_now = save_now
        self._clock = clock
        self._spacing_s = spacing_s
        self._task: asyncio.Task[None] | None = None
        self._pause: asyncio.Task[None] | None = None
        self._again = False
        self._closing = False
        self.problem: OSError | None = None
        """Why the latest save failed; None while all is kept."""

    def request(self) -> None:
        """Something changed."""
        self._again = True
        if self._task is None or self._task.done():
            name = f"save {self._path.name}"
            self._task = asyncio.get_running_loop().create_task(self._save(), name=name)

    async def close(self) -> None:
        """Return when everything requested is saved, or has failed."""
        self._closing = True
        if self._pause is not None:
            self._pause.cancel()
        while self._task is not None and not self._task.done():
            with contextlib.suppress(asyncio.CancelledError):
                await self._task
        self._closing = False

    async def _save(self) -> None:
        while self._again:
            self._again = False
            try:
                await self._save_now()
                self.problem = None
            except OSError as error:
                if str(error) != str(self.problem):  # else it was said already
                    log.warning("%s is not saved: %s", self._path, error)
                self.problem = error
            if self._clock is not None and not self._closing:
                self._pause = asyncio.create_task(self._clock.sleep(self._spacing_s), name="spacing of saves")
                await asyncio.wait({self._pause})
