"""Polls a chip that reports nothing by itself: often while something moves, seldom while all rests."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

from ...errors import BadReply, BenchError
from ...links.queue import SampleDropped
from .background_tasks import BackgroundTasks
from .motion_watch import POLL_S
from .session import Session

IDLE_POLLS = 10
"""How many polls are left out while nothing moves."""


class Poller:
    """The task that polls `device` as long as it is connected; `moves` tells whether a motion is under way."""

    def __init__(
        self, device: Session, tasks: BackgroundTasks, poll: Callable[[], Awaitable[None]], moves: Callable[[], bool]
    ) -> None:
        self._device = device
        self._tasks = tasks
        self._poll = poll
        self._moves = moves
        self._task: asyncio.Task[None] | None = None

    def begin(self) -> None:
        """See to it that it is polled."""
        if self._task is None or self._task.done():
            self._task = self._tasks.begin(self._poll_while_connected(), f"polls {self._device.id}")

    async def _poll_while_connected(self) -> None:
        left_out = 0
        while self._device.state != "disconnected":
            await self._device.background.sleep(POLL_S)
            left_out += 1
            if self._device.state != "connected" or (not self._moves() and left_out < IDLE_POLLS):
                continue
            left_out = 0
            try:
                await self._poll()
            except SampleDropped:
                continue  # the link is busy; later then
            except BadReply:
                continue  # noise: asked again often enough
            except BenchError:
                continue  # the link has failed, and its state tells
