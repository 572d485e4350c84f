"""The service of all watched axes: one task that sleeps until the next look is due, wherever that is.

Polls of different devices do not wait for each other: a link that takes its time delays only its own.
"""

from __future__ import annotations

import asyncio
import contextlib
import heapq
import itertools
import logging
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from fractions import Fraction

from ..calc.positions.rotary import Way
from ..clock import Clock
from ..devices.core.device import Device
from ..errors import UsageError, WrongState
from ..store.positions import Gear, SavedPosition
from .axis import WatchedAxis
from .observer import Observer
from .state import ExtendedState, HistoryState, Latched
from .turn import Turn

log = logging.getLogger("stepscope.positions")

PERIOD_MIN_S = 0.005
"""No axis is looked at more often than this, however fast an emulator's time runs [s, server time]."""
PERIOD_MAX_S = 10.0
"""An axis that could go unlooked at for longer is looked at this often: a reset is to be told of before long [s]."""
LAST_LOOK_S = 0.5
"""How long the last looks at the end of the program may take [s]."""


class ExtendedPositionService:
    """All axes that are watched. `changed` hears of whatever is worth saving; `unix_s` is the time of day [s].

    `period_max_s` [s, server time] caps what the counter's range and the chip's greatest speed allow.
    """

    def __init__(
        self,
        clock: Clock,
        changed: Callable[[], None] | None = None,
        unix_s: Callable[[], float] = time.time,
        period_max_s: float = PERIOD_MAX_S,
    ) -> None:
        self._clock = clock
        self._changed = changed or (lambda: None)
        self._unix_s = unix_s
        self._period_max_s = period_max_s
        self._axes: dict[tuple[Device, int], WatchedAxis] = {}
        self._waiting: dict[tuple[str, int], SavedPosition] = {}
        """Kept positions of devices that are not there yet."""
        self._beginning = asyncio.Lock()
        self._due: list[tuple[float, int, WatchedAxis]] = []
        self._order = itertools.count()
        self._sleeper: asyncio.Task[None] | None = None
        self._task: asyncio.Task[None] | None = None
        self._serving: set[asyncio.Task[None]] = set()

    # --- what is kept ---------------------------------------------------------------------------

    def restore(self, kept: Iterable[SavedPosition]) -> None:
        """What an earlier run has kept: taken up as soon as `sync` shows the device."""
        self._waiting |= {saved.key: saved for saved in kept}

    def saved(self) -> list[SavedPosition]:
        """What has to outlive this run, of devices that are there and of those that are not."""
        return [*(watched.saved() for watched in self._axes.values()), *self._waiting.values()]

    def sync(self, devices: Sequence[Device]) -> None:
        """The devices there are now. One that got another link is followed on, and has to prove what it can."""
        for key, watched in list(self._axes.items()):
            if key[0] not in devices:
                del self._axes[key]
                saved = watched.saved()
                watched.close()
                if any(device.id == saved.device for device in devices):
                    self._waiting[saved.key] = saved
                self._due = [due for due in self._due if due[2] is not watched]
                heapq.heapify(self._due)
                self._changed()
        for device in devices:
            for axis in range(len(device.axes)):
                kept = self._waiting.pop((device.id, axis), None)
                if kept is not None and (device, axis) not in self._axes:
                    self._take_up(device, kept)

    def _take_up(self, device: Device, kept: SavedPosition) -> None:
        try:
            watched = WatchedAxis.restored(device, kept, self._unix_s, self._wake, self._changed)
        except ValueError as error:
            log.warning("the kept position of axis %d of %s is left out: %s", kept.axis, device.name, error)
            return
        self._axes[device, kept.axis] = watched
        if device.state == "connected":
            self._wake(watched)

    async def close(self) -> None:
        """Have a last look at everything, and end. Nothing is sent that moves or stops a motor."""
        if self._task is not None:
            self._task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._task
            self._task = None
        for task in tuple(self._serving):
            task.cancel()
        await asyncio.gather(*self._serving, return_exceptions=True)
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(LAST_LOOK_S):
                await asyncio.gather(*(axis.poll() for axis in self._axes.values() if axis.connected))
        for watched in self._axes.values():
            watched.close()

    # --- asking ---------------------------------------------------------------------------------

    async def state(self, device: Device, axis: int) -> ExtendedState:
        """Where the axis is now. Raises UnknownThing."""
        watched = self._find(device, axis)
        if watched is None:
            return ExtendedState(
                watching=False,
                counter_bits=device.counter.counter_bits(axis),
                speed_limit_pps=device.motion.speed_limit_pps(axis),
                latch_register=device.counter.latch_register(axis),
            )
        async with watched.lock:
            await watched.fresh()
            return watched.state()

    def history(self, device: Device, axis: int, seconds: float) -> HistoryState:
        """Polls of the last `seconds` [s]. Raises UnknownThing, and WrongState where nobody watches."""
        return self._watched(device, axis).history_of(seconds)

    async def latched(self, device: Device, axis: int) -> Latched:
        """What the chip's snapshot register holds, extended. Raises WrongState, LinkError."""
        watched = self._watched(device, axis)
        async with watched.lock:
            return await watched.latched()

    # --- asking for something -------------------------------------------------------------------

    async def watch(self, device: Device, axis: int) -> None:
        """Watch from now on; where it is watched already nothing changes. Raises WrongState, LinkError."""
        await self._watching(device, axis)

    async def unwatch(self, device: Device, axis: int) -> None:
        """Watch no more, and forget; a move under way is stopped by its ramp. Raises UnknownThing, LinkError."""
        self._waiting.pop((device.id, device.axis(axis).index), None)
        watched = self._axes.pop((device, axis), None)
        self._changed()
        if watched is None:
            return
        under_way = watched.going is not None
        watched.close()
        if under_way and watched.connected:
            await device.stop(axis)

    async def go_to(self, device: Device, axis: int, position: int) -> None:
        """Set off to `position`, in as many pieces as it takes. Raises BenchError."""
        watched = await self._watching(device, axis)
        async with watched.lock:
            await watched.go_to(position)

    async def go_to_place(self, device: Device, axis: int, place: Fraction, way: Way) -> None:
        """Set off to a place within the turn [microsteps]; a moving axis is stopped first. Raises BenchError."""
        watched = await self._watching(device, axis)
        async with watched.lock:
            await watched.go_to_place(place, way)

    async def go_to_angle(self, device: Device, axis: int, angle_deg: float, way: Way) -> None:
        """The same by an angle [deg]. Raises BenchError."""
        watched = await self._watching(device, axis)
        async with watched.lock:
            await watched.go_to_angle(angle_deg, way)

    async def go_turns(self, device: Device, axis: int, turns: int) -> None:
        """Set off so many whole turns on; a moving axis is stopped first. Raises BenchError."""
        watched = await self._watching(device, axis)
        async with watched.lock:
            await watched.go_turns(turns)

    async def set_actual(self, device: Device, axis: int, position: int) -> None:
        """The axis stands at `position`. Writes no register. Raises WrongState, UsageError, LinkError."""
        watched = await self._watching(device, axis)
        async with watched.lock:
            await watched.set_actual(position)

    async def confirm(self, device: Device, axis: int) -> None:
        """What is shown is right. Raises WrongState."""
        watched = self._watched(device, axis)
        async with watched.lock:
            await watched.confirm()

    async def set_turn(self, device: Device, axis: int, microsteps_per_turn: Fraction | None) -> None:
        """A turn of that length; None: no turn any more. Raises UsageError for one that cannot be, WrongState."""
        watched = await self._watching(device, axis)
        zero = 0 if watched.turn is None else watched.turn.zero
        with _refusing():
            watched.set_turn(None if microsteps_per_turn is None else Turn(microsteps_per_turn, None, zero))

    async def set_gear(self, device: Device, axis: int, gear: Gear) -> None:
        """The turn of the shaft behind a gear. Raises UsageError for one that cannot be, WrongState."""
        watched = await self._watching(device, axis)
        with _refusing():
            watched.set_turn(Turn.geared(gear, 0 if watched.turn is None else watched.turn.zero))

    async def set_zero(self, device: Device, axis: int, position: int) -> None:
        """That position is angle 0. Raises WrongState where there is no turn."""
        self._watched(device, axis).set_zero(position)

    async def set_compare(self, device: Device, axis: int, position: int | None) -> None:
        """What the compare register is for; None: it is let alone. Raises WrongState where there is none."""
        watched = await self._watching(device, axis)
        async with watched.lock:
            watched.set_compare(position)

    def hurry(self, device: Device) -> None:
        """Look at once: how fast the device's time runs has changed."""
        for (of, _), watched in self._axes.items():
            if of is device and watched.connected:
                self._wake(watched)

    # --- inside ---------------------------------------------------------------------------------

    def _find(self, device: Device, axis: int) -> WatchedAxis | None:
        return self._axes.get((device, device.axis(axis).index))

    def _watched(self, device: Device, axis: int) -> WatchedAxis:
        watched = self._find(device, axis)
        if watched is None:
            raise WrongState(f"axis {axis} of {device.name} is not watched", 'PUT {"watch": true} first')
        return watched

    async def _watching(self, device: Device, axis: int) -> WatchedAxis:
        async with self._beginning:
            watched = self._find(device, axis)
            if watched is None:
                watched = await WatchedAxis.begun(device, axis, self._unix_s, self._wake, self._changed)
                self._axes[device, axis] = watched
                self._wake(watched)
            return watched

    def _wake(self, watched: Observer, in_s: float = 0.0) -> None:
        assert isinstance(watched, WatchedAxis)
        self._schedule(watched, self._clock.now() + self._server_s(watched, in_s))

    def _server_s(self, watched: WatchedAxis, device_s: float) -> float:
        """Device time as the server's, no more than an axis may go unlooked at [s]."""
        scale = watched.device.session.time_scale
        return min(self._period_max_s, device_s / scale) if scale > 0 else self._period_max_s

    def _schedule(self, watched: WatchedAxis, due_s: float) -> None:
        if self._axes.get((watched.device, watched.axis)) is not watched:
            return  # watched no more
        watched.due_s = due_s
        if due_s == float("inf"):
            return
        heapq.heappush(self._due, (due_s, next(self._order), watched))
        if self._task is None:
            self._task = asyncio.get_running_loop().create_task(self._run(), name="extended positions")
        elif self._sleeper is not None and self._due[0][2] is watched:
            self._sleeper.cancel()  # it sleeps for too long now

    async def _run(self) -> None:
        while True:
            self._begin_due()
            until_s = self._due[0][0] if self._due else None
            self._sleeper = asyncio.create_task(self._sleep(until_s), name="sleep until the next look")
            try:
                await asyncio.wait({self._sleeper})
            finally:
                self._sleeper.cancel()
                self._sleeper = None

    def _begin_due(self) -> None:
        now_s = self._clock.now()
        while self._due and (self._due[0][0] <= now_s or self._due[0][0] != self._due[0][2].due_s):
            due_s, _, watched = heapq.heappop(self._due)
            if due_s == watched.due_s:  # else it was scheduled anew
                watched.due_s = float("inf")
                self._begin(watched)

    async def _sleep(self, until_s: float | None) -> None:
        if until_s is None:
            await asyncio.Event().wait()  # until an axis is scheduled
        else:
            await self._clock.sleep(max(until_s - self._clock.now(), 1e-6))

    def _begin(self, watched: WatchedAxis) -> None:
        task = asyncio.create_task(self._serve(watched), name=f"look at {watched.device.id}.{watched.axis}")
        self._serving.add(task)
        task.add_done_callback(self._serving.discard)

    async def _serve(self, watched: WatchedAxis) -> None:
        try:
            next_s = await watched.serve()
        except Exception:  # a mistake of ours must not leave an axis unwatched
            log.exception("axis %d of %s", watched.axis, watched.device.name)
            next_s = 1.0
        period_s = max(PERIOD_MIN_S, self._server_s(watched, next_s))
        due_s = float("inf") if next_s == float("inf") else self._clock.now() + period_s
        if due_s < watched.due_s:  # unless it was woken meanwhile
            self._schedule(watched, due_s)


@contextlib.contextmanager
def _refusing() -> Iterator[None]:
    """The calculators refuse with ValueError; for a request that is a UsageError."""
    try:
        yield
    except ValueError as error:
        raise UsageError(str(error)) from error
