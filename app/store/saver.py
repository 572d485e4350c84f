"""Saves in the background: a change is written soon, many changes at once are written once."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections.abc import Callable, Sequence

from app.devices.config import DeviceConfig
from app.store.connections import ConnectionStore

log = logging.getLogger("stepscope.store")


class Saver:
    """`request` is cheap and for any change; `close` waits until the last one is on disk."""

    def __init__(self, store: ConnectionStore, configs: Callable[[], Sequence[DeviceConfig]]) -> None:
        self._store = store
        self._configs = configs
        self._task: asyncio.Task[None] | None = None
        self._again = False
        self.problem: OSError | None = None
        """Why the latest save failed; None while all is kept."""

    def request(self) -> None:
        """Something changed."""
        self._again = True
        if self._task is None or self._task.done():
            self._task = asyncio.get_running_loop().create_task(self._save(), name="save connections")

    async def close(self) -> None:
        """Return when everything requested is saved, or has failed."""
        while self._task is not None and not self._task.done():
            with contextlib.suppress(asyncio.CancelledError):
                await self._task

    async def _save(self) -> None:
        while self._again:
            self._again = False
            configs = list(self._configs())
            try:
                # In a thread: waiting for a disk must not hold up the motors.
                await asyncio.to_thread(self._store.save, configs)
                self.problem = None
            except OSError as error:
                self.problem = error
                log.warning("connections are not saved to %s: %s", self._store.path, error)
