"""One beat on one device: the same channels, asked again and again, handed over in blocks.

Emulators sample themselves on their own clock (`SamplingPort`); everything else is asked over the
link with the lowest priority, on an absolute beat, so that a late sample does not delay the next.
"""

from __future__ import annotations

import asyncio
import contextlib
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from app.clock import Clock
from app.devices.device import Device
from app.links.errors import BenchError
from app.links.queue import SampleDropped

FloatArray = NDArray[np.float64]

AFTER_FAILURE_S = 0.25
"""How long a failed link is left alone before the next sample is tried [s]."""


@dataclass(frozen=True, slots=True)
class Block:
    """Samples in order: `time_s` [rows], `samples` [rows, columns]; `first` is the first one's number on this beat."""

    first: int
    time_s: FloatArray
    samples: FloatArray


class Sampling:
    """Samples `channels` of `device` at `rate_hz` until `end`. `on_failure` hears why samples fail to come."""

    def __init__(
        self,
        device: Device,
        channels: Sequence[str],
        rate_hz: float,
        clock: Clock,
        on_failure: Callable[[BenchError], None],
    ) -> None:
        self.channels = tuple(channels)
        self.rate_hz = rate_hz
        self._device = device
        self._clock = clock
        self._on_failure = on_failure
        self._plan = device.sample_plan(self.channels)
        self._times_s: list[float] = []
        self._replies: list[bytes] = []
        self._taken = 0
        self._task: asyncio.Task[None] | None = None
        self._ended = False
        self._asleep = False
        self._end: Callable[[], None] | None = None
        port = device.sampling_port
        if port is not None:
            self._end = port.start_sampling(self._plan.frames, 1 / rate_hz, self._sink)
        else:
            self._task = asyncio.create_task(self._pace(), name=f"sampling {device.id}")

    @property
    def running(self) -> bool:
        """Whether a task of this sampling may still use the link."""
        return self._task is not None and not self._task.done()

    def take(self) -> Block:
        """All samples since the last call, decoded; often none."""
        times_s = np.array(self._times_s)
        replies = b"".join(self._replies)
        self._times_s.clear()
        self._replies.clear()
        first, self._taken = self._taken, self._taken + len(times_s)
        return Block(first, times_s, self._plan.decode(times_s, replies))

    def end(self) -> None:
        """Take no more samples. A sample on its way is waited for by the link, not cut off: a cut would close it."""
        self._ended = True
        if self._end is not None:
            self._end()
        if self._task is not None and self._asleep:
            self._task.cancel()

    async def cut_off(self) -> None:
        """After `end`: do not even wait for a sample on its way. For the end of the program."""
        if self._task is not None:
            self._task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._task

    def _sink(self, time_s: float, replies: bytes) -> None:
        self._times_s.append(time_s)
        self._replies.append(replies)

    async def _pace(self) -> None:
        period_s = 1 / self.rate_hz
        start_s = self._clock.now()
        beat = 0
        while not self._ended:
            pause_s = 0.0
            try:
                self._sink(*await self._device.queue.sample(self._plan.frames))
            except SampleDropped:
                pass  # counted by the queue; the next beat may find it free
            except BenchError as error:
                self._on_failure(error)
                pause_s = AFTER_FAILURE_S
            # The next beat that is still to come: after a stall there is no burst, only a hole.
            now_s = self._clock.now()
            beat = max(beat + 1, math.ceil((now_s + pause_s - start_s) / period_s))
            if not self._ended:
                self._asleep = True
                await self._clock.sleep(start_s + beat * period_s - now_s)
                self._asleep = False
