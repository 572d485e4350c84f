"""The twin in the server: starts the drawing process when a client opens the view, feeds it, and ends it again.

Off it costs nothing: no process, no task, no reader of telemetry, and nothing of viser is imported here. On, it hands
the latest sample on at most 30 times a second, and no faster than the drawing process takes it; samples in between
are only looked through for lost steps. While nobody looks or nothing changes, nothing is sent.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from ..clock import Clock
from ..devices.core.counter import CounterWritten
from ..devices.core.device import Device
from ..devices.core.events import DeviceEvent
from ..devices.core.session import Axis
from ..errors import BenchError, WrongState
from ..telemetry.hub import TelemetryHub
from ..telemetry.reader import Reader, Rows
from .colours import Scheme
from .process import Address, DrawingProcess, Renderer, StartRenderer, TwinFailed
from .recorded import RecordedAxis
from .scene import flashing
from .shape import CHANNELS, AxisPose, Shape, look_of, sine_coil_of
from .watch import Watches

log = logging.getLogger("stepscope.twin")

UPDATES_PER_S = 30.0
"""At most."""
IDLE_S = 30.0
"""How long the process lives on while nobody looks [s]: a reload of a page must not cost a new start."""
UNSEEN_BEAT_S = 0.25
"""How often samples are looked through for lost steps while nobody looks [s]."""
REJOIN_S = 1.0
WIRE_SHARE = 0.25
"""How much of a wire that sets a limit the twin takes at the most."""
VIEWERS_MAX = 8

State = Literal["off", "starting", "on", "failed"]


@dataclass(frozen=True, slots=True)
class TwinInfo:
    """How the twin is.

    following : "telemetry", or "recording" while a client scrubs
    updates_per_s : what the drawing process has shown in the last second; 0 where nothing changes
    look : the numbers that are shown; None before the first
    problem : why it failed, or why there are no samples now
    """

    state: State
    shape: Shape | None
    scheme: Scheme
    following: Literal["telemetry", "recording"]
    recording: str | None
    recording_s: float | None
    updates_per_s: float
    viewers: int
    look: AxisPose | None
    problem: BenchError | None
    pid: int | None


class Twin:
    """One 3D view for everybody: one axis at a time."""

    def __init__(
        self,
        clock: Clock,
        hub: TelemetryHub,
        start: StartRenderer = DrawingProcess.start,
        idle_s: float = IDLE_S,
    ) -> None:
        self._clock = clock
        self._idle_s = idle_s
        self._hub = hub
        self._start = start
        self._state: State = "off"
        self._task: asyncio.Task[None] | None = None
        self._begun: asyncio.Future[None] | None = None
        self._renderer: Renderer | None = None
        self._source: _Source | _Gone | None = None
        self._scheme: Scheme = "light"
        self._recorded: RecordedAxis | None = None
        self._recorded_s = 0.0
        self._viewers = 0
        self._seen_s = clock.now()
        self._problem: BenchError | None = None
        self._look: AxisPose | None = None
        self._told: tuple[Shape, Scheme] | None = None
        self._shown_s: deque[float] = deque(maxlen=round(2 * UPDATES_PER_S))

    # --- what may be asked ----------------------------------------------------------------------

    @property
    def info(self) -> TwinInfo:
        now_s = self._clock.now()
        recorded = self._recorded
        source = self._source
        return TwinInfo(
            state=self._state,
            shape=recorded.shape if recorded else source.shape if source else None,
            scheme=self._scheme,
            following="recording" if recorded else "telemetry",
            recording=recorded.recording if recorded else None,
            recording_s=self._recorded_s if recorded else None,
            updates_per_s=float(sum(shown_s > now_s - 1.0 for shown_s in self._shown_s)),
            viewers=self._viewers,
            look=self._look,
            problem=self._problem or (source.problem if source and not recorded else None),
            pid=self._renderer.pid if self._renderer else None,
        )

    @property
    def address(self) -> Address:
        """Where the process serves its page. Raises WrongState while there is none."""
        return self._drawing().address

    async def show(self, device: Device, axis: int, scheme: Scheme = "light") -> None:
        """Show that axis; returns when the page can be opened. Raises UnknownThing, TwinFailed."""
        wanted = device.axis(axis)
        self._scheme = scheme
        self._recorded = None
        source = self._source
        if not isinstance(source, _Source) or (source.device, source.axis) != (device, wanted):
            if source is not None:
                source.close()
            self._source = _Source(self._hub, device, wanted, self._clock)
            self._look = None
        await self._running()

    def sync(self, devices: Sequence[Device]) -> None:
        """These are all devices now: of one that is none of them the picture stays, grey; it was connected in another
        way, where another has its id."""
        source = self._source
        if not isinstance(source, _Source) or source.device in devices:
            return
        source.close()
        heir = next((device for device in devices if device.id == source.device.id), None)
        if heir is None or source.axis.index >= len(heir.axes):
            self._source = source.left_behind()
        else:
            self._source = _Source(self._hub, heir, heir.axes[source.axis.index], self._clock)

    async def scrub(self, recorded: RecordedAxis, since_zero_s: float, scheme: Scheme | None = None) -> None:
        """Show a recording at that time since its zero [s], until `follow`. No device is needed. Raises TwinFailed."""
        self._recorded, self._recorded_s = recorded, since_zero_s
        self._scheme = scheme or self._scheme
        await self._running()

    async def follow(self) -> None:
        """Show what happens now again, where something was shown before the recording; else end the view."""
        self._recorded = None
        if self._source is None:
            await self.off()

    def recorded(self, recording: str) -> RecordedAxis | None:
        """The recording that is shown, where it is that one: it need not be read again for each move of a cursor."""
        return self._recorded if self._recorded is not None and self._recorded.recording == recording else None

    async def off(self) -> None:
        """End it; nothing of it is left on return. A second call does nothing."""
        task, self._task = self._task, None
        if task is not None:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
        self._problem = None
        self._state = "off"

    @contextlib.contextmanager
    def looking(self) -> Iterator[None]:
        """While a page looks. Raises WrongState where the view is off, or too many look already."""
        self._drawing()
        if self._viewers >= VIEWERS_MAX:
            raise WrongState(f"{VIEWERS_MAX} pages look at the 3D view already", "close one of them")
        self._viewers += 1
        try:
            yield
        finally:
            self._viewers -= 1
            self._seen_s = self._clock.now()

    def _drawing(self) -> Renderer:
        if self._renderer is None or self._state != "on":
            raise WrongState("the 3D view is off", "start it: POST /api/v1/twin")
        return self._renderer

    # --- while it is on -------------------------------------------------------------------------

    async def _running(self) -> None:
        """Return when the process draws; starts it where it does not. Raises TwinFailed."""
        self._seen_s = self._clock.now()
        if self._task is None or self._task.done():
            self._problem, self._state = None, "starting"
            self._begun = asyncio.get_running_loop().create_future()
            self._task = asyncio.create_task(self._run(self._begun), name="twin")
        if self._begun is not None:
            await asyncio.shield(self._begun)

    async def _run(self, begun: asyncio.Future[None]) -> None:
        renderer: Renderer | None = None
        try:
            renderer = self._renderer = await self._start()
            self._state = "on"
            self._told = None
            if not begun.done():
                begun.set_result(None)
            await self._feed(renderer)
            self._state = "off"
            log.info("nobody looks at the 3D view any more: it is off")
        except TwinFailed as error:
            log.warning("%s", error)
            self._state, self._problem = "failed", error
            if not begun.done():
                begun.set_exception(error)
        finally:
            if not begun.done():
                begun.cancel()
            self._renderer = None
            if self._source is not None:
                self._source.close()
                self._source = None
            self._recorded = self._look = None
            self._shown_s.clear()
            if renderer is not None:
                await renderer.close()

    async def _feed(self, renderer: Renderer) -> None:
        """Keep the picture up to date until nobody has looked for a while. Raises TwinFailed."""
        # An axis at rest tells nothing new: nobody would notice that there is no process any more.
        ended = asyncio.create_task(renderer.ended(), name="twin process ends")
        try:
            while self._viewers or self._clock.now() < self._seen_s + self._idle_s:
                if ended.done():
                    raise ended.result()
                begun_s = self._clock.now()
                await self._update(renderer)
                beat_s = 1 / UPDATES_PER_S if self._viewers else UNSEEN_BEAT_S
                # Counted from the latest picture, and nothing missed is made up for: 30 are the most, not the mean.
                since_s = max(begun_s, self._shown_s[-1] if self._shown_s else begun_s)
                await self._clock.sleep(since_s + beat_s - self._clock.now())
        finally:
            ended.cancel()
            await asyncio.gather(ended, return_exceptions=True)

    async def _update(self, renderer: Renderer) -> None:
        source, recorded = self._source, self._recorded
        live = source.take() if source is not None else AxisPose()
        if recorded is not None:
            shape, look = recorded.shape, recorded.at(self._recorded_s)
        elif source is not None:
            shape, look = source.shape, live
        else:
            return
        if self._told != (shape, self._scheme):
            await renderer.show({"shape": shape.message(), "scheme": self._scheme})
            self._told, self._look = (shape, self._scheme), None
        before, self._look = self._look, look
        # That time goes on is nothing to see, but for the end of a flash.
        same = before is not None and replace(before, time_s=None) == replace(look, time_s=None)
        if before is not None and same and flashing(before) == flashing(look):
            return
        self._shown_s.append(self._clock.now())
        await renderer.show({"look": look.message()})


class _Gone:
    """What was shown of a device that was removed: its shape, and nothing that holds the device."""

    def __init__(self, shape: Shape, look: AxisPose) -> None:
        self.shape, self._look = shape, look
        self.problem: BenchError | None = WrongState(f"{shape.device} was removed", "choose another axis")

    def take(self) -> AxisPose:
        return self._look

    def close(self) -> None:
        pass


class _Source:
    """Samples of one axis, as the latest look at it."""

    def __init__(self, hub: TelemetryHub, device: Device, axis: Axis, clock: Clock) -> None:
        self.device, self.axis = device, axis
        self.problem: BenchError | None = None
        self._hub, self._clock = hub, clock
        self._reader: Reader | None = None
        self._retry_s = -np.inf
        self._watches = Watches()
        self._quantities: tuple[str, ...] = ()
        self._last: tuple[float, dict[str, float]] | None = None
        self._stop_listening: Callable[[], None] = device.listen(self._hear)

    @property
    def shape(self) -> Shape:
        """As it is now: names, mechanics and the microstep resolution may change at any time."""
        settings, limits = self.axis.settings, self.axis.settings.limits
        return Shape(
            device=self.device.id,
            axis=self.axis.index,
            name=self.axis.name,
            full_steps_per_rev=settings.full_steps_per_rev,
            microsteps=self.axis.microsteps_per_full_step,
            gear_ratio=settings.gear_ratio,
            travel_mm_per_rev=settings.travel_mm_per_rev,
            sine_coil=sine_coil_of(self.device.model),
            limits=(limits.position_min, limits.position_max),
            channels=frozenset(
                channel.quantity
                for channel in self.device.telemetry.channels()
                if channel.axis == self.axis.index and channel.quantity in CHANNELS
            ),
        )

    def take(self) -> AxisPose:
        """The state after everything that was sampled until now."""
        shape = self.shape
        self._join(shape)
        if self._reader is not None:
            self._reader.take_events()
            while (rows := self._reader.take_rows(self._clock.now())) is not None:
                self._feed(shape, rows)
            if self._reader.closed is not None:
                self.problem = WrongState(self._reader.closed, "connect the device, or choose another axis")
                self._leave()
        time_s, values = self._last if self._last is not None else (None, {})
        return look_of(shape, time_s, values, self._watches.slips, self._watches.travel(shape))

    def close(self) -> None:
        self._stop_listening()
        self._leave()

    def left_behind(self) -> _Gone:
        """What stays of it when its device is removed."""
        shape = self.shape
        return _Gone(shape, look_of(shape, None, {}, self._watches.slips, self._watches.travel(shape)))

    def _join(self, shape: Shape) -> None:
        if self._reader is not None or self._clock.now() < self._retry_s:
            return
        self._retry_s = self._clock.now() + REJOIN_S
        self._quantities = tuple(name for name in CHANNELS if name in shape.channels)
        channels = tuple(f"{name}.{shape.axis}" for name in self._quantities)
        try:
            rate_hz = 2 * UPDATES_PER_S
            if self.device.telemetry.calls_per_s_possible is not None:
                rate_hz = WIRE_SHARE * self.device.telemetry.sample_rate_max_hz(
                    self.device.telemetry.sample_plan(channels)
                )
            self._reader = self._hub.join(self.device.id, channels, max(1.0, min(2 * UPDATES_PER_S, rate_hz))).reader
            self.problem = None
        except BenchError as error:  # it was removed, or is another one now
            self.problem = error
            self._last = None

    def _leave(self) -> None:
        if self._reader is not None:
            self._hub.leave(self._reader)
        self._reader, self._last = None, None

    def _feed(self, shape: Shape, rows: Rows) -> None:
        columns = dict(zip(self._quantities, rows.columns, strict=True))
        self._watches.feed(shape, rows.time_s, columns)
        self._last = (float(rows.time_s[-1]), {name: float(column[-1]) for name, column in columns.items()})

    def _hear(self, event: DeviceEvent) -> None:
        if isinstance(event, CounterWritten) and event.axis == self.axis.index:
            self._watches.restart()
