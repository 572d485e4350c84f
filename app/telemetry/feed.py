"""Everything that is sampled of one device: its history, and what its readers want.

One pump a device. The live samples are those of one beat, the union of all readers' channels at
the highest of their rates: ten pages cost the link no more than one, and a chip behind a slow wire
is never asked the same thing twice.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..clock import Clock
from ..devices.core.changes import RegisterChanged
from ..devices.core.device import Device
from ..devices.core.events import DeviceEvent, MotionCommanded, MotionStarted, StateChanged
from ..devices.core.results import ChipEvents, MotionEnd, ProgramEvent
from ..errors import BenchError, OutOfRange, WrongState
from .group import PUMP_S, FloatArray, Group, Subscription, WireUse
from .history import HISTORY_RATE_HZ, REST_RATE_HZ, SHARED_RATE_HZ, SHARED_SHARE, History
from .reader import QUEUED_ROWS_LEAST, QUEUED_S, Gap, MoveSeen, Reader
from .sampling import Block, Sampling

log = logging.getLogger("stepscope.telemetry")

IDLE_PUMP_S = 0.1
"""The beat of the pump while nobody reads [s]: often enough for the history."""
REST_PUMP_S = 1.0
"""The same while the history rests [s]."""
LIVELY_S = 2.0
"""How long after the latest change of place or speed, and after a command, the history goes on at its full rate [s]."""
LATE_S = 0.25
"""A pump that wakes later than this [s] finds a machine with more to do than it can: the history then rests for
`CROWDED_S` [s], so that requests and readers have what there is."""
CROWDED_S = 5.0
PROGRAM_EVENTS_KEPT = 32
"""Marks of a program that a reader gets with the past: fewer than its queue holds."""
RATE_LIMITS_HZ = (1.0, 1000.0)
BATCH_LIMITS_HZ = (1.0, 60.0)


@dataclass(slots=True)
class Joined:
    """What a reader gets first: how its stream will be, and the past in the same columns."""

    reader: Reader
    units: tuple[str, ...]
    rate_hz: float
    chip_timed: bool
    time_origin_unix_s: float
    history_time_s: FloatArray
    history: FloatArray

    @property
    def history_bytes(self) -> int:
        """Memory that the past takes."""
        return self.history_time_s.nbytes + self.history.nbytes

    def forget_history(self) -> None:
        """It was sent."""
        self.history_time_s, self.history = self.history_time_s[:0].copy(), self.history[:0].copy()


class Feed:
    """Samples one device as long as it is connected."""

    def __init__(
        self,
        device: Device,
        clock: Clock,
        history_minutes: float,
        unix_s: Callable[[], float] = time.time,
        stretch: Callable[[], float] = lambda: 1.0,
    ) -> None:
        """`stretch` tells how much rarer frames are than their readers would like."""
        self.device = device
        self._clock = clock
        self._unix_s = unix_s
        self._stretch = stretch
        self._groups: dict[Subscription, Group] = {}
        channels = device.telemetry.channels()
        self._history = History([channel.name for channel in channels], history_minutes)
        self._tells_motion = [
            index
            for index, channel in enumerate(channels)
            if "position" in channel.quantity or "velocity" in channel.quantity
        ]
        """Columns of the history that change while something moves."""
        self._history_sampling: Sampling | None = None
        self._history_wanted_hz = 0.0
        self._lively_until_s = clock.now() + LIVELY_S
        self._crowded_until_s = clock.now()
        self._live: Sampling | None = None
        self._wanted_hz = 0.0
        """What the readers want of it; it may be less."""
        self._ended: list[Sampling] = []
        self._program: deque[ProgramEvent] = deque(maxlen=PROGRAM_EVENTS_KEPT)
        self._in_gap = True
        self._rows_dropped = 0
        self._seen_s = clock.now()
        self._seen_device_s = device.device_time_s()
        self._device_rate = 1.0
        self._stop_listening = device.listen(self._hear)
        self._task: asyncio.Task[None] | None = None

    @property
    def readers(self) -> int:
        return sum(len(group.readers) for group in self._groups.values())

    @property
    def rows_dropped(self) -> int:
        """Rows that slow readers have lost, those that have gone included."""
        return self._rows_dropped + sum(reader.dropped for group in self._groups.values() for reader in group.readers)

    def start(self) -> None:
        """Begin to pump. Needs a running event loop."""
        self._restart_pump()

    @property
    def subscriptions(self) -> int:
        """How many different ones its readers have: each is chosen, decimated and encoded by itself."""
        return len(self._groups)

    @property
    def frames_per_s(self) -> float:
        """How many all its readers would like."""
        return sum(group.frames_per_s for group in self._groups.values())

    def join(
        self, channels: tuple[str, ...], rate_hz: float, batch_hz: float, history_s: float, *, alone: bool = True
    ) -> Joined:
        """A new reader; with `alone` its subscription may be one that nobody else has.

        Raises UnknownThing for a channel, OutOfRange for a rate or batch rate, WrongState for a subscription too many.
        """
        for name, value, (low, high) in (("rate_hz", rate_hz, RATE_LIMITS_HZ), ("batch_hz", batch_hz, BATCH_LIMITS_HZ)):
            if not low <= value <= high:
                raise OutOfRange(name, value, low, high)
        device = self.device
        plan = device.telemetry.sample_plan(channels)
        granted_hz = min(rate_hz, device.telemetry.sample_rate_max_hz(plan))
        subscription = Subscription(channels, granted_hz, batch_hz)
        if not alone and subscription not in self._groups:
            raise WrongState(
                "telemetry is read in as many different ways as this server samples at once",
                "ask for the channels, rate_hz and batch_hz of another reader of this device, or let some of them end",
            )
        self.flush()
        now_s = self._clock.now()
        group = self._groups.setdefault(subscription, Group(subscription, now_s))
        reader = Reader(len(channels), max(QUEUED_ROWS_LEAST, round(granted_hz * QUEUED_S)))
        group.readers.append(reader)
        self._replan()
        self._restart_pump()
        device_s = device.device_time_s()
        for event in self._program:
            if device_s - event.time_s < history_s:
                reader.tell(event)
        past_s, past = self._history.since(device_s - history_s if history_s > 0 else float("inf"), channels)
        return Joined(
            reader, plan.units, granted_hz, device.session.chip_timed, self._unix_s() - device_s, past_s, past
        )

    def leave(self, reader: Reader) -> None:
        """A reader has gone. One that is not here changes nothing."""
        if not any(reader in group.readers for group in self._groups.values()):
            return
        self.pump()  # what was sampled for the others, before the beat may change
        for subscription, group in list(self._groups.items()):
            if reader in group.readers:
                group.readers.remove(reader)
                self._rows_dropped += reader.dropped
                if not group.readers:
                    del self._groups[subscription]
                    self._replan()

    def flush(self) -> None:
        """What is sampled so far goes out: to the history, and to the readers, whatever their beat is."""
        self.pump()
        now_s = self._clock.now()
        for group in self._groups.values():
            group.flush(now_s, at_once=True)

    def pump(self) -> None:
        """Take what was sampled and hand it on."""
        now_s, device_s = self._clock.now(), self.device.device_time_s()
        if now_s > self._seen_s:
            self._device_rate = (device_s - self._seen_device_s) / (now_s - self._seen_s) or 1.0
            self._seen_s, self._seen_device_s = now_s, device_s
        if self.device.state != "connected":
            self._pause()
        else:
            self._resume()
            port = self.device.session.sampling_port
            if port is not None:
                try:
                    port.run_due_samples()
                except BenchError as error:
                    self._gap(str(error))
        self._take_history()
        if self._live is not None:
            block = self._live.take()
            if self.device.telemetry.shares_rows and len(block.time_s):
                self._history.append_shared(block, self._live.channels)
            self._hand_out(block, now_s, device_s)
        stretch = self._stretch()
        for group in self._groups.values():
            group.flush(now_s, stretch=stretch)
            group.report(now_s, self._use)

    def close(self, reason: str) -> None:
        """End all readers and samplings."""
        self._stop_listening()
        if self._task is not None:
            self._task.cancel()
        self._end_samplings()
        self._history.forget()
        for group in self._groups.values():
            for reader in group.readers:
                reader.close(reason)

    async def drained(self) -> None:
        """After `close`: return when what is still on the link has ended by itself."""
        if self._task is not None:
            await asyncio.gather(self._task, return_exceptions=True)
        await asyncio.gather(*(sampling.wait_ended() for sampling in self._ended))

    async def wait_closed(self) -> None:
        """After `close`: cut off what is still on the link; nothing of this feed runs any more on return."""
        if self._task is not None:
            await asyncio.gather(self._task, return_exceptions=True)
        for sampling in self._ended:
            await sampling.cut_off()

    # --- inside ---------------------------------------------------------------------------------

    def _restart_pump(self) -> None:
        # Not only woken: the sleep of an idle pump may be far longer than the beat that is wanted now.
        if self._task is not None:
            self._task.cancel()
        self._task = asyncio.create_task(self._run(), name=f"telemetry {self.device.id}")

    async def _run(self) -> None:
        due_s = self._clock.now()
        while True:
            beat_s = PUMP_S if self._groups else IDLE_PUMP_S if self._lively else REST_PUMP_S
            due_s = max(due_s + beat_s, self._clock.now())
            await self._clock.sleep(due_s - self._clock.now())
            now_s = self._clock.now()
            if now_s - due_s > LATE_S:
                self._crowded_until_s = now_s + CROWDED_S
            try:
                self.pump()
            except Exception:  # a mistake of ours must not end the telemetry of everybody
                log.exception("a beat of the telemetry of %s failed", self.device.id)

    def _hand_out(self, block: Block, now_s: float, device_s: float) -> None:
        if not len(block.time_s):
            return
        self._in_gap = False
        oldest_s = now_s - max(0.0, device_s - float(block.time_s[0])) / self._device_rate
        for group in self._groups.values():
            group.offer(block, oldest_s)

    def _hear(self, event: DeviceEvent) -> None:
        # A stop sets nothing in motion: what it ends is sampled at the full rate already.
        if isinstance(event, RegisterChanged | StateChanged | MotionStarted) or (
            isinstance(event, MotionCommanded) and event.what != "stop"
        ):
            self._rouse()
        if isinstance(event, MotionStarted):
            for group in self._groups.values():
                group.tell(MoveSeen(event.axis, event.started_at_s))
        elif isinstance(event, MotionEnd | ChipEvents | ProgramEvent):
            if isinstance(event, ProgramEvent):
                self._program.append(event)
            for group in self._groups.values():
                group.tell(event)

    def _failed(self, error: BenchError) -> None:
        self._gap(str(error))

    def _gap(self, reason: str) -> None:
        """Say once that samples are missing; the next one that comes ends the gap."""
        if self._in_gap:
            return
        self._in_gap = True
        now_s, device_s = self._clock.now(), self.device.device_time_s()
        self._history.mark_gap(device_s)
        for group in self._groups.values():
            group.gap(device_s, now_s)
            group.tell(Gap(reason))

    def _use(self) -> WireUse:
        device = self.device
        spread_s = 0.0 if self._live is None else self._live.spread_s
        sampled_per_s = 0.0
        if device.session.chip_timed:  # samples that the emulator takes by itself do not pass the queue
            both = (self._live, self._history_sampling)
            sampled_per_s = sum(sampling.rate_hz * sampling.questions for sampling in both if sampling is not None)
        return WireUse(
            device.telemetry.calls_per_s + sampled_per_s, device.telemetry.calls_per_s_possible, spread_s * 1e3
        )

    # --- the history, at its full rate and at rest ------------------------------------------------

    @property
    def _lively(self) -> bool:
        """Whether the history is sampled at its full rate."""
        now_s = self._clock.now()
        return self._crowded_until_s <= now_s < self._lively_until_s

    def _rouse(self) -> None:
        """Something is about to happen: sample the history at its full rate from now on."""
        rested = not self._lively
        self._lively_until_s = self._clock.now() + LIVELY_S
        if rested and self._lively and self._history_sampling is not None:
            self._remember()
            self._restart_pump()

    def _take_history(self) -> None:
        """Keep what was sampled for the history, and see whether anything moves."""
        if self._history_sampling is None:
            return
        block = self._history_sampling.take()
        if not len(block.time_s):
            return
        self._in_gap = False
        before = self._history.latest
        rows = block.samples if before is None else np.vstack((before, block.samples))
        if (np.ptp(rows[:, self._tells_motion], axis=0) > 0).any():
            self._lively_until_s = self._clock.now() + LIVELY_S
        self._history.append(block)

    def _resume(self) -> None:
        self._remember()
        if self._live is None:
            self._replan()

    def _remember(self) -> None:
        """Sample for the history, but not where that would take the wire from readers: then they share rows."""
        if self.device.telemetry.shares_rows and self._groups:
            self._end_history()
            return
        if not self._history.channels:  # of a chip where each reading writes something
            return
        wanted_hz = HISTORY_RATE_HZ if self._lively else REST_RATE_HZ
        if self._history_sampling is not None and self._history_wanted_hz == wanted_hz:
            return
        self._take_history()
        self._end_history()
        self._history_wanted_hz = rate_hz = wanted_hz
        channels = self._history.channels
        if self.device.telemetry.shares_rows:
            most_hz = self.device.telemetry.sample_rate_max_hz(self.device.telemetry.sample_plan(channels))
            rate_hz = min(rate_hz, SHARED_RATE_HZ, SHARED_SHARE * most_hz)
        self._history_sampling = self._sampling(channels, rate_hz)

    def _pause(self) -> None:
        if self._history_sampling is not None:
            problem = self.device.problem
            self._gap(str(problem) if problem else f"{self.device.name} is {self.device.state}")
        self._end_samplings()

    def _replan(self) -> None:
        """Sample what the readers want now, and nothing else."""
        if not self._groups or self.device.state != "connected":
            self._end_live()
            return
        channels = tuple(sorted({name for subscription in self._groups for name in subscription.channels}))
        rate_hz = max(subscription.rate_hz for subscription in self._groups)
        if self._live is None or (self._live.channels, self._wanted_hz) != (channels, rate_hz):
            self._wanted_hz = rate_hz
            self._end_live()
            self._remember()
            self._live = self._sampling(channels, rate_hz)
        for group in self._groups.values():
            group.follow(channels, self._live.rate_hz)

    def _sampling(self, channels: tuple[str, ...], rate_hz: float) -> Sampling:
        return Sampling(self.device, channels, rate_hz, self._clock, self._failed)

    def _end_live(self) -> None:
        live, self._live = self._live, None
        self._end(live)

    def _end_history(self) -> None:
        history, self._history_sampling = self._history_sampling, None
        self._end(history)

    def _end(self, sampling: Sampling | None) -> None:
        if sampling is not None:
            sampling.end()
            self._ended = [ended for ended in self._ended if ended.running] + [sampling]

    def _end_samplings(self) -> None:
        self._end_live()
        self._end_history()
