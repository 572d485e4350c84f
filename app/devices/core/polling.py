"""Looking on at a chip that tells nobody anything: often while something moves, seldom while all rests."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

from ...errors import BadReply, BenchError
from ...links.queue import SampleDropped
from .background_tasks import BackgroundTasks
from .motion_watch import POLL_S
from .session import Session

IDLE_LOOKS = 10
"""How many looks are left out while nothing moves."""


class Looking:
    """The task that looks at `device` as long as it is connected; `moves` tells whether a motion is under way."""

    def __init__(
        self, device: Session, tasks: BackgroundTasks, look: Callable[[], Awaitable[None]], moves: Callable[[], bool]
    ) -> None:
        self._device = device
        self._tasks = tasks
        self._look = look
        self._moves = moves
        self._task: asyncio.Task[None] | None = None

    def begin(self) -> None:
        """See to it that looks come."""
        if self._task is None or self._task.done():
            self._task = self._tasks.begin(self._look_while_connected(), f"looks at {self._device.id}")

    async def _look_while_connected(self) -> None:
        left_out = 0
        while self._device.state != "disconnected":
            await self._device.background.sleep(POLL_S)
            left_out += 1
            if self._device.state != "connected" or (not self._moves() and left_out < IDLE_LOOKS):
                continue
            left_out = 0
            try:
                await self._look()
            except SampleDropped:
                continue  # the link is busy; later then
            except BadReply:
                continue  # noise: asked again often enough
            except BenchError:
                continue  # the link has failed, and its state tells
