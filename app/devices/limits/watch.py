"""Stops an axis before it leaves its range, whatever set it in motion: a rotation, a search, a program in a module.

It looks at the axis as often as is needed to stop it in time: a pause until the next look is as long as the axis, had
it sped up as fast as it can, could still be braked by its ramp after it and `REACTION_S` more. Where not even the
shortest pause leaves that, the axis is stopped. So a limit is passed only if a look comes later than it was meant to by
more than `REACTION_S`, and then by velocity times what it is later; and the axis stops some way before it, at the most
velocity times (`REACTION_S` + `POLL_S` + twice what a look takes on the link). A motion that nobody here commanded (a
program, another master, a start signal) is noticed within `IDLE_S`, and may have got as far as it gets in that time.

A move to a target inside ends there by itself and is left alone, unless it cannot be braked before the limit any more.
"""

from __future__ import annotations

import asyncio
import logging
import math
from contextvars import Context
from dataclasses import replace

from ...errors import BenchError
from ..core.device import Device
from ..core.events import DeviceEvent, LimitReached, MotionCommanded, StateChanged, motion_owner
from ..core.limit_rules.quantities import Motion, sign
from ..core.limit_rules.rules import AxisReading
from .limiter import Limiter

log = logging.getLogger("stepscope.limits")

IDLE_S = 0.25
"""How seldom an axis is looked at that rests [s]."""
POLL_S = 0.004
"""How often one is looked at at the most [s]."""
REACTION_S = 0.02
"""How much time has to be left from the last look to where the axis has to brake [s, server time]."""
UNSURE_S = 1.0
"""For so long after a command an axis that stands and may go either way is looked at as often as can be [s]."""
ROOM = 64
"""By how much a move may miss its way of braking, by rounding and by how the chip ends a ramp [microsteps]."""
UNKNOWN_PPS2 = 1e9
"""How fast a velocity may rise where nobody knows [pps^2]."""


class RangeWatch:
    """One device, from its connection on to its end."""

    def __init__(self, device: Device, limiter: Limiter) -> None:
        self.why = ""
        """What it has stopped an axis for, last: for procedures that are ended by it."""
        self._device = device
        self._limiter = limiter
        self._task: asyncio.Task[None] | None = None
        self._sleeper: asyncio.Future[None] | None = None
        self._stopped: dict[int, tuple[int, float]] = {}
        """By axis that was stopped: how many commands it had had by then, and its speed at the latest look."""
        self._commanded_s = float("-inf")
        self._unlisten = device.listen(self._heard)
        if device.state == "connected":
            self._begin()

    def end(self) -> None:
        """Look no more."""
        self._unlisten()
        self._cancel()

    def _heard(self, event: DeviceEvent) -> None:
        if isinstance(event, StateChanged):
            if event.state == "connected":
                self._begin()
            else:
                self._cancel()
        elif isinstance(event, MotionCommanded) and event.by is not self:
            self._commanded_s = self._device.session.clock.now()
            if self._sleeper is not None:
                self._sleeper.cancel()

    def _begin(self) -> None:
        if self._task is None:
            # In a context of its own: what it does is nobody's request.
            self._task = asyncio.get_running_loop().create_task(
                self._run(), name=f"range of {self._device.id}", context=Context()
            )

    def _cancel(self) -> None:
        task, self._task = self._task, None
        if task is not None:
            task.cancel()

    async def _run(self) -> None:
        motion_owner.set(self)
        while True:
            pause_s = IDLE_S
            for axis in self._limiter.ranged():
                try:
                    pause_s = min(pause_s, await self._serve(axis))
                except BenchError:
                    pause_s = min(pause_s, IDLE_S / 4)  # the link tells by itself that it failed
                except Exception:  # a mistake of ours must not leave an axis without its limits
                    log.exception("axis %d of %s is not watched well", axis, self._device.name)
            self._sleeper = asyncio.ensure_future(self._device.session.clock.sleep(pause_s))
            try:
                await asyncio.wait({self._sleeper})
            finally:
                self._sleeper.cancel()
                self._sleeper = None

    async def _serve(self, axis: int) -> float:
        """Look at an axis, and stop it where it is time; when to look again [s]."""
        device, limiter = self._device, self._limiter
        began_s, commands = device.session.clock.now(), device.session.motion_commands[axis]
        reading = await limiter.rules.read_axis(axis)
        took_s = device.session.clock.now() - began_s
        soon_s = max(POLL_S, took_s)  # on a slow line others want to ask too
        motion = limiter.motion(axis)
        way = sign(reading.velocity_pps) or self._way_to_be(reading, motion)
        if way == 0:
            self._stopped.pop(axis, None)
            unsure = motion is not None and not motion.positioning and began_s - self._commanded_s < UNSURE_S
            return soon_s if unsure else IDLE_S
        limits = limiter.limits[axis]
        end = limits.position_max if way > 0 else limits.position_min
        turns_round = motion is not None and not motion.positioning and motion.way * way < 0
        pause_s: float | None = IDLE_S
        if end is not None:
            pause_s = self._pause_s(axis, reading, (end - reading.position) * way, soon_s, REACTION_S + took_s)
        if pause_s is not None:
            self._stopped.pop(axis, None)
            return soon_s if turns_round else pause_s
        stopped_at, speed_pps = self._stopped.get(axis, (-1, 0.0))
        if stopped_at != commands or abs(reading.velocity_pps) >= speed_pps > 0:  # else it brakes already
            assert end is not None
            await self._stop(axis, reading, way, end)
        self._stopped[axis] = (device.session.motion_commands[axis], abs(reading.velocity_pps))
        return soon_s

    @staticmethod
    def _way_to_be(reading: AxisReading, motion: Motion | None) -> int:
        """Of an axis that does not turn yet, or no more."""
        if motion is None:
            return 0
        return motion.way if reading.target is None else sign(reading.target - reading.position)

    def _pause_s(self, axis: int, reading: AxisReading, room: int, soon_s: float, reaction_s: float) -> float | None:
        """How long the axis may go unlooked at [s, server time]; None where it is to be stopped now."""
        rules, view, scale = self._limiter.rules, self._limiter.view(), self._device.session.time_scale
        if scale <= 0:
            return IDLE_S  # an emulator whose time stands
        speed = abs(reading.velocity_pps)
        rise_pps2 = rules.acceleration_pps2(axis, view) or UNKNOWN_PPS2
        if reading.target is not None and not self._limiter.limits[axis].beyond(reading.target):
            # It ends by itself, at the latest where it was told to; unless that cannot be any more.
            return None if speed and room + ROOM < 0.9 * speed**2 / (2 * rise_pps2) else IDLE_S / 2
        top_pps = rules.top_pps(axis, view)
        for pause_s in (IDLE_S, IDLE_S / 2, IDLE_S / 4, IDLE_S / 8, IDLE_S / 16, soon_s):
            until_s = (max(pause_s, soon_s) + reaction_s) * scale
            # It may speed up meanwhile. Where nobody knows how far, it is looked at as often as can be.
            fastest = speed if top_pps is None else max(speed, min(top_pps, speed + rise_pps2 * until_s))
            braked = rules.braking(
                axis, replace(reading, velocity_pps=math.copysign(fastest, reading.velocity_pps)), view
            )
            if (braked or 0.0) + fastest * until_s <= room and not (top_pps is None and pause_s > soon_s):
                return pause_s
        return None

    async def _stop(self, axis: int, reading: AxisReading, way: int, end: int) -> None:
        device = self._device
        known = self._limiter.rules.braking(axis, reading, self._limiter.view()) is not None
        name = "position_max" if way > 0 else "position_min"
        self.why = f"axis {axis} came to {name} {end}, its soft limit"
        log.info("%s: %s; stopped at %d", device.name, self.why, reading.position)
        outcome = (await device.stop_axes([axis], "ramp" if known else "immediate"))[0]
        device.stopped_by_limit(LimitReached(axis, name, end, reading.position))
        if outcome.problem is not None:
            raise outcome.problem
