"""Keeps one device's state true: looks in on what works, tries again what does not."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable

from ...clock import Clock
from ...errors import BenchError, LinkDown
from .device import Device

LOOK_IN_S = 1.5
"""How often a working device is looked in on: a cable pulled while nobody asks anything is seen within 2 s, with the
wait for an answer, also where the port does not notice it by itself."""
GLANCES = 3
"""How many times in between it is seen whether another caller found out."""
RETRIES_S = (0.25, 0.5, 1.0)
"""Waits before the next attempts; the last one repeats. A cable that is plugged in again is found within 3 s, with the
time that an attempt takes."""


ANSWER_WITHIN_S = 5.0
"""How long whoever connects a device waits for what comes of it [s]; the attempt itself goes on."""


class Watch:
    """One device from connect to disconnect."""

    def __init__(self, device: Device, clock: Clock) -> None:
        self._device = device
        self._clock = clock
        self._task: asyncio.Task[None] | None = None
        self._end_listening: Callable[[], None] = _nothing

    async def start(self, *, wait: bool) -> None:
        """Connect, and go on watching. With `wait` the first attempt is over on return, or takes too long."""
        self._device.session.set_state("connecting")
        line = self._device.session.port.traits.batches
        if line is not None:
            self._end_listening = line.on_down(self._went_down)
        attempted = asyncio.Event()
        self._task = asyncio.create_task(self._run(attempted), name=f"watch {self._device.id}")
        if wait:
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(ANSWER_WITHIN_S):
                    await attempted.wait()

    async def stop(self) -> None:
        """End watching. A second call does nothing."""
        self._end_listening()
        task, self._task = self._task, None
        if task is not None:
            task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await task

    async def _run(self, attempted: asyncio.Event) -> None:
        try:
            await self._attempt()
        finally:
            attempted.set()
        failures = 0
        while True:
            if self._works():
                failures = 0
                for _ in range(GLANCES):
                    await self._clock.sleep(LOOK_IN_S / GLANCES)
                    if not self._works():
                        break
                else:
                    await self._probe()
            else:
                await self._clock.sleep(RETRIES_S[min(failures, len(RETRIES_S) - 1)])
                failures += 1
                await self._attempt()

    def _went_down(self, error: LinkDown) -> None:
        """The port saw the cable go while nobody asked anything."""
        if self._works():
            self._device.session.set_state("failed", error)

    def _works(self) -> bool:
        return self._device.state == "connected"

    async def _probe(self) -> None:
        # A failure of the link is told to the device by its queue; here it only must not end the watch.
        with contextlib.suppress(BenchError):
            await self._device.identity.refresh()

    async def _attempt(self) -> None:
        device = self._device
        try:
            await device.identify()
            await device.identity.refresh()
            if device.limiter is not None:
                await device.limiter.learn()
        except BenchError as error:
            device.session.set_state("failed", error)
        else:
            device.session.set_state("connected")


def _nothing() -> None:
    pass
