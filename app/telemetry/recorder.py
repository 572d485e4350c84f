"""Recording: a reader like any page, whose rows go to a file as they come.

It begins at once or at a trigger, and then has what came before it, too. What happens meanwhile is marked: moves and
stops, the chip's own events, gaps, rows that got lost, commands of everybody.
"""

from __future__ import annotations

import asyncio
import contextlib
import errno
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy as np

from ..clock import Clock
from ..devices.core.changes import RegisterChanged
from ..devices.core.device import Device
from ..devices.core.events import DeviceEvent, MotionCommanded
from ..devices.core.marks import MarkKind
from ..devices.core.results import ChipEvents, MotionEnd, ProgramEvent
from ..errors import OutOfRange, UnknownThing
from .feed import Joined
from .frames import FloatArray
from .hub import TelemetryHub
from .reader import Gap, MoveSeen, Rows

BEATS_HZ = 10.0
"""How often rows go to the file: what a crash costs is a tenth of a second."""
PRE_S_MAX = 60.0
State = Literal["waiting", "recording", "done", "failed"]


@dataclass(frozen=True, slots=True)
class Trigger:
    """What a recording waits for.

    now : nothing. move : `axis` is sent somewhere. level : `channel` crosses `level`, upwards (rising) or downwards.
    pre_s : so much of what was before is kept [s].
    """

    kind: Literal["now", "move", "level"] = "now"
    axis: int = 0
    channel: str = ""
    level: float = 0.0
    rising: bool = True
    pre_s: float = 0.0


class Sink(Protocol):
    """Where it goes. Each call raises OSError where the disk does not take it."""

    def append(self, time_s: FloatArray, columns: FloatArray) -> None:
        """Rows: `time_s` [rows], `columns` [channels, rows]."""
        ...

    def mark(
        self, time_s: float, kind: MarkKind, text: str, axis: int | None, detail: Mapping[str, Any] | None = None
    ) -> None:
        """Something happened at device time `time_s` [s]; `detail` is the same for programs."""
        ...

    def close(self) -> None:
        """That was all."""
        ...


class Recorder:
    """One recording while it runs. `begin` makes the sink, once the granted rate and units are known."""

    def __init__(
        self,
        hub: TelemetryHub,
        device: Device,
        channels: tuple[str, ...],
        rate_hz: float,
        trigger: Trigger,
        duration_s: float | None,
        clock: Clock,
    ) -> None:
        """Raises UnknownThing and OutOfRange for what cannot be recorded."""
        if not 0 <= trigger.pre_s <= PRE_S_MAX:
            raise OutOfRange("pre_s", trigger.pre_s, 0, PRE_S_MAX)
        if trigger.kind == "level" and trigger.channel not in channels:
            raise UnknownThing("recorded channel", trigger.channel, list(channels))
        if trigger.kind == "move":
            device.axis(trigger.axis)
        self._hub, self._device, self._trigger, self._clock = hub, device, trigger, clock
        self._channels, self._duration_s = channels, duration_s
        self.joined: Joined = hub.join(device.id, channels, rate_hz, BEATS_HZ)
        self.state: State = "waiting"
        self.message = ""
        """Why it is over, where that was not asked for."""
        self.rows = 0
        self.zero_s: float | None = None
        """Device time of the trigger, or of the first row [s]."""
        self._before: deque[Rows] = deque()
        self._last = np.nan
        self._dropped = 0
        self._sink: Sink | None = None
        self._on_end: Callable[[], None] = _nothing
        self._task: asyncio.Task[None] | None = None
        self._stop_listening: Callable[[], None] = _nothing

    def start(self, sink: Sink, on_end: Callable[[], None]) -> None:
        """Write to `sink` from now on; `on_end` is called once, when nothing more will be written."""
        self._sink, self._on_end = sink, on_end
        self._stop_listening = self._device.listen(self._hear)
        self._task = asyncio.create_task(self._run(), name=f"recording of {self._device.id}")

    async def stop(self) -> None:
        """End it with all that was sampled until now. A second call does nothing."""
        if self._task is not None:
            if self.state in ("waiting", "recording"):
                self._hub.flush(self._device.id)
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
            if self.state in ("waiting", "recording"):  # it had not even begun to run
                self._end()

    def mark(
        self,
        text: str,
        kind: MarkKind = "note",
        axis: int | None = None,
        time_s: float | None = None,
        detail: Mapping[str, Any] | None = None,
    ) -> None:
        """Mark now, or `time_s` [s] of the device; `detail` is the same for programs."""
        if self._sink is not None and self.state in ("waiting", "recording"):
            try:
                self._sink.mark(self._device.device_time_s() if time_s is None else time_s, kind, text, axis, detail)
            except OSError as error:
                self._fail(error)

    async def _run(self) -> None:
        try:
            with contextlib.suppress(asyncio.CancelledError):
                while self.state in ("waiting", "recording"):
                    await self.joined.reader.wait()
                    self._take()
            if self.state in ("waiting", "recording"):
                self._take()
        finally:
            self._end()

    def _take(self) -> None:
        """What waits in the queue."""
        reader, sink = self.joined.reader, self._sink
        assert sink is not None
        try:
            for event in reader.take_events():
                if isinstance(event, MoveSeen):
                    self.mark("sent somewhere", "move", event.axis, event.started_at_s)
                    if self.state == "waiting" and (self._trigger.kind, self._trigger.axis) == ("move", event.axis):
                        self._triggered(event.started_at_s)
                elif isinstance(event, MotionEnd):
                    ended = {"reason": event.reason, "position": event.position}
                    self.mark(event.detail or event.reason, "stopped", event.axis, event.time_s, ended)
                elif isinstance(event, ChipEvents):
                    self.mark(", ".join(event.names), "event", event.axis, event.time_s)
                elif isinstance(event, ProgramEvent):
                    self.mark(event.text, "program", event.axis, event.time_s)
                elif isinstance(event, Gap):
                    self.mark(event.reason, "gap")
            while self.state in ("waiting", "recording"):
                rows = reader.take_rows(self._clock.now())
                if rows is None:
                    break
                self._rows(rows)
        except OSError as error:
            self._fail(error)
        if reader.closed is not None and self.state in ("waiting", "recording"):
            self.state, self.message = "done", reader.closed

    def _rows(self, rows: Rows) -> None:
        if rows.dropped > self._dropped:
            self.mark(f"{rows.dropped - self._dropped} rows were lost here", "gap", None, float(rows.time_s[0]))
            self._dropped = rows.dropped
        if self.state == "waiting":
            self._before.append(rows)
            if self._trigger.kind == "now":
                self._triggered(float(rows.time_s[0]), told=False)
            elif self._trigger.kind == "level":
                crossed_s = self._crossing(rows)
                if crossed_s is not None:
                    self._triggered(crossed_s)
            if self.state == "waiting":
                newest_s = float(rows.time_s[-1])
                while len(self._before) > 1 and self._before[1].time_s[0] < newest_s - self._trigger.pre_s:
                    self._before.popleft()
            return
        self._write(rows)

    def _crossing(self, rows: Rows) -> float | None:
        """When the trigger's channel crosses its level in these rows [s]; None: not in these."""
        values = rows.columns[self._channels.index(self._trigger.channel)]
        values = values if self._trigger.rising else -values
        level = self._trigger.level if self._trigger.rising else -self._trigger.level
        before = np.concatenate(([self._last if self._trigger.rising else -self._last], values[:-1]))
        last = values[-1] if self._trigger.rising else -values[-1]
        self._last = float(last)
        crossed = np.flatnonzero((before < level) & (values >= level))
        return float(rows.time_s[crossed[0]]) if len(crossed) else None

    def _triggered(self, at_s: float, *, told: bool = True) -> None:
        """From here on rows are written, those of just before first."""
        self.state, self.zero_s = "recording", at_s
        if told:
            self.mark("trigger", "trigger", None, at_s)
        before, self._before = list(self._before), deque()
        for rows in before:
            wanted = rows.time_s >= at_s - self._trigger.pre_s
            self._write(Rows(rows.dropped, rows.time_s[wanted], rows.columns[:, wanted]))

    def _write(self, rows: Rows) -> None:
        assert self._sink is not None
        assert self.zero_s is not None
        time_s, columns = rows.time_s, rows.columns
        if self._duration_s is not None:
            wanted = time_s <= self.zero_s + self._duration_s
            if not wanted.all():
                time_s, columns, self.state = time_s[wanted], columns[:, wanted], "done"
        self._sink.append(time_s, columns)
        self.rows += len(time_s)

    def _hear(self, event: DeviceEvent) -> None:
        if isinstance(event, MotionCommanded):
            text, detail = _command(event)
            self.mark(text, "command", event.axis, detail=detail)
        elif isinstance(event, RegisterChanged):
            write = {"do": "write", "register": event.register, "old": event.old, "new": event.new}
            self.mark(event.text, "write", event.axis, event.at_s, write)

    def _fail(self, error: OSError) -> None:
        if error.errno == errno.ENOSPC:  # what was recorded is whole, and nobody did anything wrong
            self.state, self.message = "done", f"it was ended, because the disk is full: {error.strerror}"
        else:
            self.state, self.message = "failed", f"the disk did not take it: {error.strerror or error}"

    def _end(self) -> None:
        self._stop_listening()
        self._hub.leave(self.joined.reader)
        if self._sink is not None:
            with contextlib.suppress(OSError):
                self._sink.close()
        if self.state != "failed":
            self.state = "done"
        self._on_end()


def _command(event: MotionCommanded) -> tuple[str, dict[str, Any] | None]:
    """A command for people (`move to 2000`), and for a replay what to do; None where that is not known."""
    for name, do, text in _ASKED:
        if name in event.asked:
            asked = event.asked[name]
            return event.what if event.what not in _PLAIN else text.format(asked), {"do": do, name: asked}
    return event.what, None


_PLAIN = ("move", "rotate", "stop", "set_position")
"""Commands that say nothing more than their kind; a module's are written out: `MVP ABS, 0, 2000`."""
_ASKED = (
    ("target", "move", "move to {}"),
    ("velocity", "rotate", "rotate at {} (chip)"),
    ("mode", "stop", "stop ({})"),
    ("position", "set_position", "position set to {}"),
)


def _nothing() -> None: ...
