"""Stops that are answered in time: what each device did, or that it has not said anything yet."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Sequence
from dataclasses import dataclass, field

from ...errors import BenchError, LinkTimeout, WrongState
from .device import Device
from .results import StopMode, StopOutcome

log = logging.getLogger("stepscope.devices")

STOP_WITHIN_S = 0.8
"""After so long a stop is answered for a device that has not answered itself [s]."""
UNDER_WAY_MAX = 4
"""Stops of one device that may wait for its link at once; a further one is the latest of them."""


@dataclass(slots=True)
class Stopping:
    """Stops devices. One that does not answer is told of, and its stop goes on: the link sends it when it can."""

    _under_way: dict[Device, list[asyncio.Task[list[StopOutcome]]]] = field(default_factory=dict)

    async def stop(self, device: Device, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        """Stop these axes ahead of everything that waits for the link. Never raises; answers in `STOP_WITHIN_S` [s]."""
        if device.state == "disconnected":
            off = WrongState(f"{device.name} is not connected, so it cannot be stopped", "use its power switch")
            return _all_failed(device, axes, 0.0, off)
        under_way = self._under_way.setdefault(device, [])
        if len(under_way) < UNDER_WAY_MAX:
            task = asyncio.create_task(self._send(device, axes, mode), name=f"stop {device.id}")
            under_way.append(task)
            task.add_done_callback(lambda done: self._over(device, done))
        else:
            task = under_way[-1]
        done, _ = await asyncio.wait({task}, timeout=STOP_WITHIN_S)
        if done and not task.cancelled():
            return task.result()
        late = LinkTimeout(
            device.session.port.name, STOP_WITHIN_S, "the stop, which may still get through: use its power switch"
        )
        return _all_failed(device, axes, STOP_WITHIN_S, late)

    async def close(self) -> None:
        """Give up what is under way. For the end of the program."""
        tasks = [task for tasks in self._under_way.values() for task in tasks]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    @staticmethod
    async def _send(device: Device, axes: Sequence[int], mode: StopMode) -> list[StopOutcome]:
        try:
            return await device.stop_axes(axes, mode)
        except BenchError as error:
            return _all_failed(device, axes, 0.0, error)
        except Exception as error:  # a mistake of ours must not keep the others from being told of
            log.exception("stopping %s failed", device.name)
            return _all_failed(device, axes, 0.0, WrongState(f"stepscope failed: {error!r}", "use its power switch"))

    def _over(self, device: Device, task: asyncio.Task[list[StopOutcome]]) -> None:
        tasks = self._under_way.get(device, [])
        tasks.remove(task)
        if not tasks:
            self._under_way.pop(device, None)


def _all_failed(device: Device, axes: Sequence[int], took_s: float, problem: BenchError) -> list[StopOutcome]:
    return [StopOutcome(device.id, axis, False, took_s * 1e3, problem) for axis in axes]
