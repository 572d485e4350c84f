"""Notices that the session which had the bench has vanished, also while nobody asks, and sees to its motors."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable, Coroutine, Sequence
from contextvars import copy_context
from typing import Any

from ..clock import Clock
from ..devices.core.actor import STEPSCOPE, actor
from ..devices.core.background_tasks import BackgroundTasks
from ..devices.core.device import Device
from ..errors import BenchError
from ..settings import OnVanish
from .calls import CallsUnderWay
from .lease import Lease, LeaseEvent

log = logging.getLogger("stepscope.lease")

AGAIN_S = 1.0
"""How long after a device could not be told it is tried again [s]: its cable may be back."""
CALLS_END_WITHIN_S = 5.0

Act = Callable[[OnVanish], Awaitable[Sequence[tuple[Device, BenchError]]]]


class LeaseWatch:
    """`act` does to the motors what is configured, and returns the devices that did not hear it."""

    def __init__(self, lease: Lease, calls: CallsUnderWay, clock: Clock, act: Act) -> None:
        self._lease = lease
        self._calls = calls
        self._clock = clock
        self._act = act
        self._changed = asyncio.Event()
        self._tasks = BackgroundTasks()
        lease.listen(self._heard)

    def start(self) -> None:
        """Begin to watch."""
        self._begin(self._watch(), "lease watch")

    async def close(self) -> None:
        """End it, and what it is about to do: the server stops the motors next."""
        await self._tasks.end()

    def _begin(self, work: Coroutine[Any, Any, None], name: str) -> None:
        context = copy_context()
        context.run(actor.set, STEPSCOPE)  # not of whoever happened to notice
        self._tasks.begin(work, name, context)

    def _heard(self, event: LeaseEvent) -> None:
        self._changed.set()
        log.info("%s: %s %s", event.action, event.name, event.detail)
        if event.action == "vanished":
            log.warning("%s has vanished: %s", event.name, event.detail)
            self._begin(self._after_vanishing(self._lease.on_vanish), "after vanishing")

    async def _watch(self) -> None:
        while True:
            self._changed.clear()
            left_s = self._lease.expires_in_s  # tells of the end itself, where it has come
            waits: list[asyncio.Task[Any]] = [asyncio.create_task(self._changed.wait(), name="lease changed")]
            if left_s is not None:
                waits.append(asyncio.create_task(self._clock.sleep(left_s), name="lease expires"))
            try:
                await asyncio.wait(waits, return_when=asyncio.FIRST_COMPLETED)
            finally:
                for wait in waits:
                    wait.cancel()

    async def _after_vanishing(self, how: OnVanish) -> None:
        missed = await self._act(how)
        if self._calls.any:
            # A call of the vanished session may have set a motor going behind that.
            await self._calls.over(CALLS_END_WITHIN_S)
            missed = await self._act(how)
        for device, error in missed:
            log.warning("the motors of %s could not be stopped: %s", device.name, error)
        while missed and self._lease.holder is None:
            await self._clock.sleep(AGAIN_S)
            if self._lease.holder is None:  # else the motors are that one's
                missed = await self._act(how)
