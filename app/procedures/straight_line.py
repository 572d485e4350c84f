"""Moves of several axes on a straight line, and on to further points: all start together and arrive together.

Each axis gets its share of one trapezoid: speed and acceleration in proportion to its way, as high as the slowest of
them allows. Each family's planner says what comes of the registers, which hold no number exactly: how far the path
leaves the line, and how far apart they arrive. Their ramps are borrowed, and given back at the end.
"""

from __future__ import annotations

import asyncio
import logging
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..clock import Clock
from ..devices.core.capabilities import LinePace
from ..devices.core.device import Device
from ..devices.core.events import DeviceEvent, MotionCommanded
from ..devices.core.pace import PacedLeg, PaceLimits
from ..devices.core.results import AxisMove
from ..errors import BenchError, LinkTimeout, OutOfRange, UsageError
from .line_path import AxisPath, LegMotion, LegPath
from .procedure import Failed, State
from .start_together import StartNet, TogetherMove, TogetherStart, moment_of, start_together

log = logging.getLogger("stepscope.tuning")

FloatArray = NDArray[np.float64]
POINTS_MAX = 64
SAMPLES = 201
POLL_S = 0.01
"""How often it is looked where they are [s]."""
LOST_MAX = 3
"""Readings of an axis that may be lost one after another: a gap in its path."""
OFF_LINE_STEPS, OFF_LINE_PART = 8, 0.002
"""What an axis may be off the line without a word [microsteps], or of the longest way [-], whichever is more."""
PATH_SAMPLES_MAX = 48_000
"""Samples kept of a line, of all axes on all legs."""
GRACE_S = 2.0
"""How much longer than expected a leg may take [s], and half as long again."""


@dataclass(frozen=True, slots=True)
class LineAxis:
    """An axis of a line."""

    device: Device
    axis: int


@dataclass(frozen=True, slots=True)
class LegAxis:
    """One axis on one leg. Names as in the REST contract."""

    device: str
    axis: int
    from_position: int
    to_position: int
    velocity_pps: float
    """As the registers have it; 0 for an axis that stands."""
    acceleration_pps2: float
    duration_s: float
    off_line: float
    """How far it is from the line at the most [microsteps]."""
    position: list[float]
    """At the times of the leg."""
    warnings: list[str]
    """Why it cannot keep to the line any better, where that is far off."""


@dataclass(frozen=True, slots=True)
class Leg:
    """From one point to the next."""

    duration_s: float
    arrival_spread_s: float
    """Between the first and the last arrival."""
    time_s: list[float]
    axes: tuple[LegAxis, ...]


@dataclass(frozen=True, slots=True)
class LinePlan:
    """A whole line."""

    legs: tuple[Leg, ...]
    duration_s: float


@dataclass(frozen=True, slots=True)
class LinePath:
    """A line that is gone or was: its plan, and where the axes were seen on each leg that has begun."""

    plan: LinePlan
    legs: tuple[tuple[AxisPath, ...], ...]


@dataclass(frozen=True, slots=True)
class Arrival:
    """When an axis was seen to be there, after the start of its leg, and how much sooner it may have been [s]."""

    device: str
    axis: int
    after_s: float
    uncertainty_s: float


@dataclass(frozen=True, slots=True)
class LineState:
    """How a line goes, or went. `started` and `arrivals` are those of the latest leg."""

    state: State
    leg: int
    """The one under way, from 0."""
    legs: int
    started: TogetherStart | None
    arrivals: tuple[Arrival, ...]
    message: str
    off_line: float | None = None
    """How far one of them was seen off the line at the most, on any leg [microsteps]."""
    off_line_uncertainty: float | None = None


IDLE = LineState("idle", 0, 0, None, (), "")


@dataclass(frozen=True, slots=True)
class _Leg:
    told: Leg
    paced: tuple[PacedLeg | None, ...]
    """None for an axis that stands."""
    targets: tuple[int, ...]

    @property
    def motions(self) -> list[LegMotion]:
        return [
            LegMotion(
                each.device,
                each.axis,
                each.from_position,
                each.to_position - each.from_position,
                each.velocity_pps,
                _no_way if paced is None else _expected(paced),
            )
            for each, paced in zip(self.told.axes, self.paced, strict=True)
        ]


def _expected(paced: PacedLeg) -> Callable[[FloatArray], FloatArray]:
    return lambda times: np.asarray(paced.plan.at(np.minimum(times, paced.plan.duration_s)).position)


def _no_way(times: FloatArray) -> FloatArray:
    return np.zeros_like(times)


async def plan_line(
    axes: Sequence[LineAxis], points: Sequence[Sequence[int]], pace: float = 1.0, duration_s: float | None = None
) -> tuple[LinePlan, tuple[_Leg, ...]]:
    """Plan a line from where the axes stand through `points`, a target for each axis in each. Nothing is written.

    pace : share of the highest speed that all can go; duration_s : of each leg instead, where that is slower [s]

    Raises UsageError for what is no line, OutOfRange for what an axis cannot do, SoftLimit, CannotMove, WrongState.
    """
    _check(axes, points, pace)
    limits = [await one.device.need(LinePace).pace_limits(one.device.axis(one.axis).index) for one in axes]
    here = [limit.position for limit in limits]
    for point in points:
        for one, target, limit in zip(axes, point, limits, strict=True):
            if one.device.limiter is not None:
                one.device.limiter.require_target(one.axis, target, limit.position, "the line goes there")
    legs = []
    for point in points:
        legs.append(_leg(axes, limits, here, point, pace, duration_s))
        here = list(point)
    return _plan_of(legs), tuple(legs)


def _plan_of(legs: Sequence[_Leg]) -> LinePlan:
    told = tuple(leg.told for leg in legs)
    return LinePlan(told, sum(leg.duration_s for leg in told))


def _check(axes: Sequence[LineAxis], points: Sequence[Sequence[int]], pace: float) -> None:
    if not axes:
        raise UsageError("a line of no axis")
    if len({(one.device.id, one.device.axis(one.axis).index) for one in axes}) < len(axes):
        raise UsageError("an axis is named twice")
    if not 1 <= len(points) <= POINTS_MAX:
        raise UsageError(f"{len(points)} points: 1 to {POINTS_MAX} make a line")
    if any(len(point) != len(axes) for point in points):
        raise UsageError(f"each point needs {len(axes)} positions, one an axis")
    if not 0 < pace <= 1:
        raise OutOfRange("pace", pace, 0, 1, "of the highest speed that all can go")


def _leg(
    axes: Sequence[LineAxis],
    limits: Sequence[PaceLimits],
    here: Sequence[int],
    there: Sequence[int],
    pace: float,
    duration_s: float | None,
) -> _Leg:
    ways = [to - at for at, to in zip(here, there, strict=True)]
    moving = [(abs(way), limit) for way, limit in zip(ways, limits, strict=True) if way]
    paced: list[PacedLeg | None] = [None] * len(axes)
    if moving:
        speed = pace * min(limit.velocity_pps / way for way, limit in moving)
        slope = min(limit.acceleration_pps2 / way for way, limit in moving)
        if duration_s is not None:
            speed = min(speed, _speed_for(duration_s, slope))
        paced = [
            one.device.need(LinePace).paced(one.axis, way, speed * abs(way), slope * abs(way)) if way else None
            for one, way in zip(axes, ways, strict=True)
        ]
    durations = [0.0 if leg is None else leg.plan.duration_s for leg in paced]
    longest_s = max(durations)
    times = np.linspace(0.0, longest_s, SAMPLES)
    shares = [None if leg is None else _expected(leg)(times) / way for leg, way in zip(paced, ways, strict=True)]
    widest = max(range(len(ways)), key=lambda number: abs(ways[number]))
    line = shares[widest]
    off = [
        0.0 if share is None or line is None else float(np.abs((share - line) * way).max())
        for share, way in zip(shares, ways, strict=True)
    ]
    told = [
        LegAxis(
            device=one.device.id,
            axis=one.axis,
            from_position=at,
            to_position=at + way,
            velocity_pps=0.0 if leg is None else leg.velocity_pps,
            acceleration_pps2=0.0 if leg is None else leg.acceleration_pps2,
            duration_s=seconds,
            off_line=far,
            position=(np.full(SAMPLES, float(at)) if share is None else at + share * way).tolist(),
            warnings=_warnings(leg, far, abs(ways[widest])),
        )
        for one, at, way, leg, seconds, share, far in zip(axes, here, ways, paced, durations, shares, off, strict=True)
    ]
    gone = [seconds for seconds in durations if seconds]
    spread_s = max(gone) - min(gone) if gone else 0.0
    return _Leg(Leg(longest_s, spread_s, times.tolist(), tuple(told)), tuple(paced), tuple(there))


def _warnings(leg: PacedLeg | None, off_line: float, longest: int) -> list[str]:
    """What there is to say of an axis so far off the line [microsteps], where the longest way is so long."""
    if leg is None or off_line <= max(OFF_LINE_STEPS, OFF_LINE_PART * longest):
        return []
    why = "; ".join(leg.shortcomings) or "its ramp has another shape than that of the longest way"
    return [f"{off_line:.3g} microsteps off the line at the most: {why}"]


def _speed_for(duration_s: float, slope: float) -> float:
    """The speed of a trapezoid over a way of 1 that takes so long with acceleration `slope`; no limit where it cannot.

    T = 1 / v + v / a.
    """
    square = duration_s * duration_s - 4.0 / slope
    return math.inf if square < 0 else slope * (duration_s - math.sqrt(square)) / 2.0


class LineRun:
    """Goes along a line that was planned. A stop or another command to one of its axes ends it, and stops all."""

    def __init__(self, axes: Sequence[LineAxis], legs: Sequence[_Leg], nets: Sequence[StartNet], clock: Clock) -> None:
        self._axes = axes
        self._legs = legs
        self._nets = nets
        self._clock = clock
        self._state = LineState("running", 0, len(legs), None, (), "")
        self._task: asyncio.Task[None] | None = None
        self._ending = False
        self._stopped = asyncio.Event()
        """All are told to stop, or it is over."""
        self._ours = 0
        """Commands of our own that are under way."""
        self._paths: list[LegPath] = []
        """Of each leg that has begun."""

    @property
    def state(self) -> LineState:
        return self._state

    @property
    def running(self) -> bool:
        return self._task is not None and not self._task.done()

    @property
    def axes(self) -> Sequence[LineAxis]:
        return self._axes

    @property
    def path(self) -> LinePath:
        """Where the axes were seen, beside the plan."""
        return LinePath(_plan_of(self._legs), tuple(leg.paths() for leg in self._paths))

    def start(self) -> None:
        """Begin. Once only."""
        self._task = asyncio.create_task(self._main(), name="straight line")

    async def abort(self, why: str) -> None:
        """End it and stop its motors; returns when they are told to. Their ramps come back as soon as all stand."""
        if self.running and self._task is not None:
            if not self._ending:
                self._end(why)
            told = asyncio.create_task(self._stopped.wait())
            await asyncio.wait({told, self._task}, return_when=asyncio.FIRST_COMPLETED)
            told.cancel()

    async def _main(self) -> None:
        ends = [device.listen(self._heard) for device in self._devices]
        how: State = "done"
        for one in self._axes:
            one.device.need(LinePace).pace_begin(one.axis)
        try:
            for number, leg in enumerate(self._legs):
                self._state = replace(self._state, leg=number, arrivals=())
                await self._go(leg)
        except asyncio.CancelledError:
            how = "aborted"
            await self._stop()
        except (Failed, BenchError) as error:
            how = "failed"
            await self._stop(str(error))
        except Exception as error:  # a mistake of ours must not leave motors running
            log.exception("a straight line failed")
            how = "failed"
            await self._stop(f"failed by a mistake in stepscope: {error!r}")
        finally:
            self._ending = True
            await self._give_back()
            for end in ends:
                end()
            self._state = replace(self._state, state=how)
            self._stopped.set()

    @property
    def _devices(self) -> list[Device]:
        return list(dict.fromkeys(one.device for one in self._axes))

    def _heard(self, event: DeviceEvent) -> None:
        if not isinstance(event, MotionCommanded) or self._ending or self._task is None:
            return
        if any(event.axis == one.axis for one in self._axes) and (event.what == "stop" or not self._ours):
            self._end(f"ended by another command to one of its axes: {event.what}")

    def _end(self, why: str) -> None:
        """Have it end, once: what it then sends itself must not end it again."""
        assert self._task is not None
        self._ending = True
        self._state = replace(self._state, message=why)
        self._task.cancel()

    async def _go(self, leg: _Leg) -> None:
        moves = []
        self._ours += 1
        try:
            for one, paced, target in zip(self._axes, leg.paced, leg.targets, strict=True):
                if paced is None:
                    continue
                done = await one.device.registers.write_many(paced.writes)
                if done.failed is not None:
                    raise done.failed
                moves.append(TogetherMove(one.device, AxisMove(one.axis, target)))
            if not moves:
                return
            started = await start_together(moves, self._nets, self._clock)
        finally:
            self._ours -= 1
        self._state = replace(self._state, started=started)
        path = LegPath(leg.motions, max(50, PATH_SAMPLES_MAX // (len(self._axes) * len(self._legs))))
        self._paths.append(path)
        try:
            await self._arrive(leg, started.at_s, path)
        finally:
            self._judge(path)

    async def _arrive(self, leg: _Leg, start_s: float, path: LegPath) -> None:
        waiting = [number for number, paced in enumerate(leg.paced) if paced is not None]
        began_s = looked_s = self._clock.now()
        end_s = began_s + 1.5 * leg.told.duration_s + GRACE_S
        lost = [0] * len(self._axes)
        while waiting:
            if self._clock.now() > end_s:
                raise Failed(f"{self._axes[waiting[0]].device.name} is not there after {end_s - began_s:.3g} s")
            await self._clock.sleep(POLL_S)
            for number in list(waiting):
                one, target, asked_s = self._axes[number], leg.targets[number], self._clock.now()
                try:
                    state = await one.device.monitor.axis_state(one.axis)
                except LinkTimeout:
                    lost[number] += 1
                    path.add(number, self._clock.now() - start_s, 0.0, None)
                    if lost[number] > LOST_MAX:
                        raise
                    continue
                lost[number] = 0
                seen = moment_of(one.device, state.time_s, asked_s, self._clock)
                path.add(number, seen.at_s - start_s, seen.uncertainty_s, state.position)
                if state.moving:
                    continue
                if state.position != target:
                    raise Failed(f"{one.device.name} stands at {state.position} and not at {target}")
                now_s = self._clock.now()
                arrival = Arrival(one.device.id, one.axis, now_s - began_s, now_s - looked_s)
                self._state = replace(self._state, arrivals=(*self._state.arrivals, arrival))
                waiting.remove(number)
            looked_s = self._clock.now()

    def _judge(self, path: LegPath) -> None:
        """Tell how far they were off the line, where that is more than on the legs before."""
        seen = [axis for axis in path.paths() if axis.off_line is not None]
        worst = max(seen, key=lambda axis: axis.off_line or 0.0, default=None)
        if worst is not None and (worst.off_line or 0.0) >= (self._state.off_line or 0.0):
            self._state = replace(self._state, off_line=worst.off_line, off_line_uncertainty=worst.uncertainty)

    async def _stop(self, why: str = "") -> None:
        self._ending = True
        self._state = replace(self._state, message=why or self._state.message)
        stops = [device.stop_axes([one.axis for one in self._axes if one.device is device]) for device in self._devices]
        await asyncio.gather(*stops, return_exceptions=True)
        self._stopped.set()

    async def _give_back(self) -> None:
        """Bring the ramps back, as soon as all stand."""
        end_s = self._clock.now() + GRACE_S
        for one in self._axes:
            try:
                while (await one.device.monitor.axis_state(one.axis)).moving and self._clock.now() < end_s:
                    await self._clock.sleep(POLL_S)
                await one.device.need(LinePace).pace_back(one.axis)
            except BenchError as error:
                note = f"the ramp of {one.device.name} is not as it was: {error}"
                self._state = replace(self._state, message=f"{self._state.message} {note}".strip())
