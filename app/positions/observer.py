"""One axis that is observed: its own looks and everybody else's, and what they say. Times are device time [s]."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

from ..calc.positions.extended import Counter, checked_position
from ..devices.core.counter import CounterReading, CounterWritten, PositionSeen
from ..devices.core.device import Device
from ..devices.core.events import DeviceEvent, MotionCommanded, StateChanged
from ..devices.core.results import ChipEvents
from ..errors import BenchError
from ..store.positions import SavedPosition
from .history import History
from .tracker import CLOCK_TOLERANCE, Tracker

RESET_NAMES = frozenset({"RST_EV", "reset"})
"""Names of events by which chips tell that they were reset."""
HEARD_EVERY_S = 0.25
"""Polls of others closer together than this are left out [s]."""
CONNECT = "connect the device: it is trusted again where a look can show that nothing was missed"


class Wake(Protocol):
    """Has an axis served."""

    def __call__(self, watched: Observer, in_s: float = 0.0) -> None:
        """In `in_s` of device time [s]."""
        ...


class Observer:
    """One axis from the beginning of its watch to the end. `changed` has it saved."""

    def __init__(
        self,
        device: Device,
        axis: int,
        tracker: Tracker,
        unix_s: Callable[[], float],
        wake: Wake,
        changed: Callable[[], None],
    ) -> None:
        self.device = device
        self.axis = axis
        self.tracker = tracker
        self.lock = asyncio.Lock()
        """One operation at a time: the service's, or a request's."""
        self.due_s = float("inf")
        """When it is served next, server time [s]."""
        self.history = History()
        self.encoder: int | None = None
        """Where the encoder said that the axis was, extended; None where there is none."""
        self.trouble = ""
        """Why the latest look failed though the link works."""
        self._pps = 0.0
        """How fast it went between the latest two looks of the service [pps]."""
        self._unix_s = unix_s
        self._times: tuple[float, float] | None = None
        """When the service looked last: Unix time, and device time [s]."""
        self._wake = wake
        self._changed = changed
        self._unlisten = device.listen(self._heard)

    # --- beginning and end ----------------------------------------------------------------------

    def restore(self, saved: SavedPosition) -> None:
        """It is what was kept of an earlier run; trusted when a look shows that nothing was missed."""
        tracker = self.tracker
        if saved.lost:
            tracker.lose(saved.lost)
        elif saved.seen_unix_s > self._unix_s():
            tracker.lose("it was saved in the future: this computer's clock was set back")
        elif saved.model != self.device.model or saved.bits != self.device.counter.counter_bits(self.axis):
            tracker.lose(f"it was saved of a {saved.model} with a counter of {saved.bits} bits")
        elif saved.link != link_text(self.device):
            tracker.lose("the connection's link was changed: it may lead to another chip")
        tracker.lost_sight("not looked at since the server started", CONNECT)

    def close(self) -> None:
        """Follow no more."""
        self._unlisten()
        self.due_s = float("inf")

    # --- what others tell -----------------------------------------------------------------------

    def _heard(self, event: DeviceEvent) -> None:
        match event:
            case PositionSeen(axis=self.axis):
                self._saw(event)
            case MotionCommanded(axis=self.axis):
                self._commanded(event)
            case CounterWritten(axis=self.axis):
                self.tracker.counter_written(event.what)
                self._wake(self)
            case ChipEvents(axis=self.axis):
                if RESET_NAMES.intersection(event.names):
                    self._wake(self)
            case StateChanged(state="connected"):
                self._wake(self)
            case StateChanged(state="failed" | "disconnected"):
                why = "the device is not connected" if event.problem is None else f"the link failed: {event.problem}"
                self.tracker.lost_sight(why, CONNECT)
                self._lost_sight(why)
                self._changed()
            case _:
                pass

    def _saw(self, event: PositionSeen) -> None:
        tracker = self.tracker
        if 0 <= event.asked_at_s - tracker.asked_s < HEARD_EVERY_S and not self.lock.locked():
            return  # telemetry shows more than anybody needs here, and each look costs
        trusted = tracker.trusted
        tracker.seen(event.count, event.asked_at_s, self.device.device_time_s(), self.speed_limit_pps)
        if tracker.asked_s == event.asked_at_s and tracker.count == event.count:
            encoder = event.encoder_count
            self._note(None if encoder is None else tracker.position + tracker.counter.way(encoder, event.count))
        if trusted != tracker.trusted:
            self._wake_for_others()

    def _wake_for_others(self) -> None:
        """Another reader has seen something; while we poll ourselves that is seen to anyway."""
        if not self.lock.locked():
            self._wake(self)

    def _note(self, encoder: int | None) -> None:
        """There was a look, the tracker has taken it in, and the encoder said so."""
        tracker = self.tracker
        if encoder is not None:
            self.encoder = encoder
        if tracker.trusted:
            self.history.add(tracker.asked_s, tracker.position, encoder)
        self._changed()

    @property
    def seen_unix_s(self) -> float:
        """When the counter was read, at the earliest, Unix time [s]."""
        return self._unix_s() - (self.device.device_time_s() - self.tracker.asked_s)

    def _commanded(self, event: MotionCommanded) -> None:
        """The axis was commanded."""

    def _lost_sight(self, why: str) -> None:
        """The axis cannot be looked at any more."""

    # --- looks of our own -----------------------------------------------------------------------

    @property
    def connected(self) -> bool:
        return self.device.state == "connected"

    @property
    def speed_limit_pps(self) -> float:
        return self.device.motion.speed_limit_pps(self.axis)

    @property
    def allowed_s(self) -> float:
        """After so long without a look the position is lost [s]."""
        return self.tracker.counter.allowed_s(self.speed_limit_pps * CLOCK_TOLERANCE)

    @property
    def period_s(self) -> float:
        """How often it has to be looked at [s]."""
        return self.tracker.counter.service_period_s(self.speed_limit_pps * CLOCK_TOLERANCE)

    async def poll(self) -> bool:
        """Look; whether that went well. Everything that is wrong is in the tracker then."""
        device, tracker = self.device, self.tracker
        before, before_s = tracker.extended, tracker.asked_s
        try:
            look = await device.counter.poll(self.axis)
            if tracker.away is not None and look.reset_seen is None:
                look = await self._with_run_time(look)
        except BenchError as error:
            self.trouble = f"the latest look failed: {error}"
            return False
        self.trouble = ""
        tracker.returned(look, device.device_time_s(), self.speed_limit_pps)
        self._check_counter()
        self._check_sleep()
        elapsed_s = tracker.asked_s - before_s
        if elapsed_s > 0:
            self._pps = abs(tracker.extended - before) / elapsed_s
        self._note(None)
        return True

    def _check_counter(self) -> None:
        if self.device.counter.counter_bits(self.axis) != self.tracker.counter.bits:
            self.tracker.lose("the counter does not wrap any more where it did: its range was changed")

    def _check_sleep(self) -> None:
        """A computer that sleeps has clocks that stand; the time of day does not, and neither does a motor."""
        before, self._times = self._times, (self._unix_s(), self.device.device_time_s())
        if before is None or self.device.session.emulated:
            return
        unix_s, device_s = self._times[0] - before[0], self._times[1] - before[1]
        if unix_s > max(self.allowed_s, 2 * device_s):
            self.tracker.lose(
                f"by the time of day {unix_s:.4g} s have gone by, and only {device_s:.4g} s were counted:"
                " this computer slept, or its clock was set forward"
            )

    async def _with_run_time(self, look: CounterReading) -> CounterReading:
        """`look`, judged by how long the chip says that it runs, where it does say."""
        runs_s = await self.device.counter.runs_for_s()
        if runs_s is None:
            return look
        unseen_s = self.device.device_time_s() - self.tracker.asked_s
        return replace(look, reset_seen=runs_s < unseen_s * CLOCK_TOLERANCE)


def tracker_of(device: Device, saved: SavedPosition, unix_s: float) -> Tracker:
    """The tracker of what was kept, as seen at `unix_s`, Unix time [s]. Raises ValueError for what cannot be."""
    asked_s = device.device_time_s() - (unix_s - saved.seen_unix_s)
    return Tracker(Counter(saved.bits), saved.count, asked_s, checked_position(saved.position))


def link_text(device: Device) -> str:
    """The link as text that is the same for the same link."""
    return json.dumps(dict(device.link), sort_keys=True, default=str)
