"""One beat on one device: the same channels, asked again and again, handed over in blocks.

Emulators sample themselves on their own clock (`SamplingPort`); everything else is asked over the
link with the lowest priority. The beat is absolute, so that a late sample does not delay the next. A
wire that cannot keep it is asked without a pause: what it achieves is then the rate.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..clock import Clock
from ..devices.core.device import Device
from ..errors import BadReply, BenchError
from ..links.queue import SampleDropped

FloatArray = NDArray[np.float64]

AFTER_FAILURE_S = 0.25
"""How long a failed link is left alone before the next sample is tried [s]."""
SOON_S = 0.5e-3
"""A beat so close is kept at once [s]: the timers of an event loop are no finer, and a slept-in wire is lost."""
SPREAD_SHARE = 0.1
"""Share of the latest row in the mean of `spread_s`."""


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
        self.spread_s = 0.0
        """From the first to the last question of a row, mean of the latest rows [s]."""
        self._device = device
        self._clock = clock
        self._on_failure = on_failure
        self._plan = device.telemetry.sample_plan(self.channels)
        self.rate_hz = min(rate_hz, device.telemetry.sample_rate_max_hz(self._plan))
        self._times_s: list[float] = []
        self._replies: list[bytes] = []
        self._taken = 0
        self._task: asyncio.Task[None] | None = None
        self._ended = False
        self._asleep = False
        self._end: Callable[[], None] | None = None
        port = device.session.sampling_port
        if port is not None:
            self._end = port.start_sampling(self._plan.frames, 1 / self.rate_hz, self._sink)
        else:
            self._task = asyncio.create_task(self._pace(), name=f"sampling {device.id}")

    @property
    def questions(self) -> int:
        """Frames of one sample."""
        return len(self._plan.frames)

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

    async def wait_ended(self) -> None:
        """After `end`: return when nothing of it is on the link any more."""
        if self._task is not None:
            await asyncio.wait({self._task})

    async def cut_off(self) -> None:
        """After `end`: do not even wait for a sample on its way. For the end of the program."""
        if self._task is not None:
            self._task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._task

    def _sink(self, time_s: float, replies: bytes) -> None:
        if len(replies) != self._plan.row_bytes:
            # Some answer broke off: nobody can tell which bytes are whose, so the row is as good as lost.
            name = self._device.session.port.name
            self._on_failure(BadReply(name, f"{len(replies)} bytes instead of {self._plan.row_bytes}", replies))
            return
        self._times_s.append(time_s)
        self._replies.append(replies)

    async def _pace(self) -> None:
        rows = self._device.telemetry.rows_at_once(self._plan, self.rate_hz)
        period_s = rows / self.rate_hz
        due_s = self._clock.now()
        while not self._ended:
            pause_s = 0.0
            try:
                taken = await self._device.telemetry.take_samples(self._plan, rows)
            except SampleDropped:
                pass  # counted by the queue; the next beat may find it free
            except BenchError as error:
                self._on_failure(error)
                pause_s = AFTER_FAILURE_S
            else:
                self.spread_s += SPREAD_SHARE * (taken.spread_s - self.spread_s)
                for time_s, replies in zip(taken.times_s, taken.replies, strict=True):
                    self._sink(time_s, replies)
            # One beat late is made up for, more are not: after a stall there is no burst, only a hole.
            now_s = self._clock.now()
            due_s = max(due_s + period_s, now_s - period_s, now_s + pause_s if pause_s else 0.0)
            if not self._ended:
                self._asleep = True
                await self._clock.sleep(due_s - now_s if due_s - now_s > SOON_S else 0.0)
                self._asleep = False
