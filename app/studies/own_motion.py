"""A motion that a study has begun and could not stop, for its link was dead: stopped as soon as the device is back."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable

from ..devices.core.device import Device
from ..devices.core.events import DeviceEvent, MotionCommanded, StateChanged, motion_owner
from ..errors import BenchError


class StopWhenBack:
    """Stops one axis when its device is connected again and it turns, unless somebody else has sent it anywhere.

    Until then nobody but the study has commanded it: what turns is the study's. It is over after one stop, and with a
    disconnect on request.
    """

    def __init__(
        self, device: Device, axis: int, is_own: Callable[[object], bool], stopped: Callable[[], Awaitable[None]]
    ) -> None:
        """`is_own`: whether who commands is the study; `stopped` is called after the motor was stopped."""
        self._device, self._axis, self._is_own, self._stopped = device, axis, is_own, stopped
        self._taken_over = False
        self._task: asyncio.Task[None] | None = None
        self._end = device.listen(self._heard)

    def _heard(self, event: DeviceEvent) -> None:
        if isinstance(event, MotionCommanded):
            others = event.axis == self._axis and event.by is not self and not self._is_own(event.by)
            if others and event.what != "stop":
                self._taken_over = True
                self._end()
        elif isinstance(event, StateChanged):
            if event.state == "disconnected":
                self._end()
            elif event.state == "connected" and (self._task is None or self._task.done()):
                self._task = asyncio.create_task(self._stop(), name=f"stop what a study began on {self._device.id}")

    async def _stop(self) -> None:
        motion_owner.set(self)
        try:
            moving = (await self._device.monitor.axis_state(self._axis)).moving
            if moving and not self._taken_over:
                await self._device.stop(self._axis)
                await self._stopped()
        except BenchError:  # gone again: with its next return
            return
        self._end()
