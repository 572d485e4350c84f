"""Motors that turn although nobody told them to through this connection: they did so before stepscope was there.

After a crash of the server, or a lost link, a chip goes on with what it was told last. Whoever connects to it has to
know, and the stop works on it like on any other motion.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Sequence
from functools import partial

from ...clock import Clock
from ...errors import BenchError
from .device import Device
from .events import DeviceEvent, MotionCommanded, StateChanged

log = logging.getLogger("stepscope.devices")

POLL_PERIOD_S = 1.0
"""How often it is seen whether a motor that was found moving has come to rest [s]."""


class FoundMoving:
    """Looks at each device when it gets connected, and keeps `Device.notes` true."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._heard: dict[Device, Callable[[], None]] = {}
        self._polls: dict[Device, asyncio.Task[None]] = {}
        self._found: dict[Device, dict[int, str]] = {}

    def sync(self, devices: Sequence[Device]) -> None:
        """These are all devices now."""
        for device in self._heard.keys() - set(devices):
            self._heard.pop(device)()
            self._forget(device)
        for device in devices:
            if device not in self._heard:
                self._heard[device] = device.listen(partial(self._hear, device))

    async def close(self) -> None:
        """End polling."""
        polls = tuple(self._polls.values())
        self.sync(())
        await asyncio.gather(*polls, return_exceptions=True)

    def _hear(self, device: Device, event: DeviceEvent) -> None:
        if isinstance(event, MotionCommanded):
            self._clear(device, event.axis)  # what it does from now on this server has told it
        elif isinstance(event, StateChanged):
            self._forget(device)
            if event.state == "connected":
                self._polls[device] = asyncio.create_task(
                    self._poll(device, tuple(device.session.motion_commands)), name=f"found moving {device.id}"
                )

    async def _poll(self, device: Device, commands: Sequence[int]) -> None:
        """`commands` is how often each axis had been commanded by then."""
        found = self._found[device] = {}
        for axis in device.axes:
            index = axis.index
            if await self._moves(device, index) and device.session.motion_commands[index] == commands[index]:
                how = "kept moving while the link was away" if commands[index] else "was already moving"
                found[index] = f"axis {index} {how} when stepscope connected; a stop ends it"
                log.warning("%s: %s", device.name, found[index])
        self._tell(device)
        while found:
            await self._clock.sleep(POLL_PERIOD_S)
            for index in tuple(found):
                if not await self._moves(device, index):
                    self._clear(device, index)

    @staticmethod
    async def _moves(device: Device, axis: int) -> bool:
        try:
            return (await device.monitor.axis_state(axis)).moving
        except BenchError:
            return False  # the next connection looks again

    def _clear(self, device: Device, axis: int) -> None:
        if self._found.get(device, {}).pop(axis, None) is not None:
            self._tell(device)

    def _forget(self, device: Device) -> None:
        poll = self._polls.pop(device, None)
        if poll is not None:
            poll.cancel()
        self._found.pop(device, None)
        self._tell(device)

    def _tell(self, device: Device) -> None:
        device.notes = tuple(self._found.get(device, {}).values())
