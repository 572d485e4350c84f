"""Polls the axis while a motion is under way, until it rests and the reason is known."""

from __future__ import annotations

import asyncio
import contextlib

from ...errors import BadReply, BenchError, LinkError, LinkTimeout, UnknownParameter
from ...links.queue import Priority, SampleDropped
from ...links.tmcl import Request
from ...registers.tmcl.commands import DriverErrors, ExtendedErrors, Opcode
from ..core.background_tasks import BackgroundTasks
from ..core.motion_watch import POLL_S, MotionReading, UnderWay
from ..core.results import StopReason
from ..core.session import Session
from ..core.tmcl_calls import Calls
from ..core.tmcl_frames import STATUS
from ..core.tmcl_link import TmclLink
from .ongoing import OngoingMotion
from .state import ModuleState

FATAL = DriverErrors.OVERTEMPERATURE | DriverErrors.SHORT_A | DriverErrors.SHORT_B


class Poller:
    """A task that asks the module where its axis is, as long as `ongoing` has a motion under way."""

    def __init__(
        self, session: Session, state: ModuleState, link: TmclLink, ongoing: OngoingMotion, tasks: BackgroundTasks
    ) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._ongoing = ongoing
        self._tasks = tasks
        self._polling: asyncio.Task[None] | None = None

    def begin(self) -> None:
        """`OngoingMotion.began_hooks`: poll until the motion has ended."""
        if self._polling is None or self._polling.done():
            self._polling = self._tasks.begin(self._poll_until_rest(), f"motion of {self._session.id}")

    async def _poll_until_rest(self) -> None:
        while self._ongoing.watch.under_way is not None:
            await self._session.background.sleep(POLL_S)
            try:
                await self.poll()
            except SampleDropped:
                continue  # the link is busy; later then
            except BadReply:
                continue  # noise: asked again often enough for now
            except LinkError as error:
                self._ongoing.lose_sight(str(error))
            except BenchError:
                continue

    async def poll(self, *, at_once: bool = False) -> None:
        """Ask once, unless a caller has just asked; of a motor that rests for a while, ask why. Raises BenchError.

        `at_once`: also where a caller has just asked, for something has happened since.
        """
        watch = self._ongoing.watch
        # Telemetry that asks for the same looks often enough: one set of questions is enough for both.
        if at_once or self._session.device_time_s() - watch.polled_s > POLL_S * self._session.time_scale:
            async with self._link.calls(priority=Priority.SAMPLE) as calls:
                asked_at_s = self._session.device_time_s()
                told_position, told_speed, reached = await calls.ask_many(self._state.roles.poll)
                position = calls.need(self._state.roles.actual_position, told_position)
                speed = calls.need(self._state.roles.actual_speed, told_speed)
                time_s = calls.time_s
            self._session.saw_position(0, position, asked_at_s)
            watch.update(
                MotionReading(time_s, position, speed, self._ongoing.reached(reached, position)),
                self._link.poll_spread_s,
            )
        rests = watch.at_rest(self._session.device_time_s())
        if rests is not None:
            async with self._link.calls(priority=Priority.SAMPLE) as calls:
                why = await self._why(calls, *rests)
            if why is not None and watch.under_way is rests[0]:
                watch.end(*why)

    async def _why(self, calls: Calls, motion: UnderWay, rest: MotionReading) -> tuple[StopReason, str] | None:
        """Why the motor rests; None where it only pauses."""
        if (await calls.do(Request(self._link.address, Opcode.RFS, STATUS))).value:
            return None
        position, speed, told, left, right, left_off, right_off, driver = await calls.ask_many(self._state.roles.end)
        reached = self._ongoing.reached(told, rest.position)
        if speed or position != rest.position:
            return None
        if motion.stopped_s is not None:
            return "stop_command", "stopped on command"
        if motion.kind == "search":
            self._ongoing.driven = None
            return "target_reached", "the reference search has ended"
        # Reading AP 207 clears it, so once and only now; a lost answer loses the flags too, and they stay unknown.
        with contextlib.suppress(BadReply, LinkTimeout, UnknownParameter):
            await calls.get(self._state.roles.extended_error_flags)
        if self._ongoing.latched & ExtendedErrors.STALL:
            return "stall", "StallGuard stopped the motor (AP 207)"
        if self._ongoing.latched & ExtendedErrors.DEVIATION:
            return "deviation", "an encoder's deviation stopped the motor (AP 207)"
        if driver is not None and driver & FATAL:
            names = [part.name for part in self._state.roles.driver_flags.fields if part.unpack(driver & FATAL)]
            return "driver_error", f"the driver reports {', '.join(names)} (AP 208)"
        if motion.direction <= 0 and left and not left_off:
            return "left_switch", "the left stop switch is active"
        if motion.direction >= 0 and right and not right_off:
            return "right_switch", "the right stop switch is active"
        if reached and motion.kind != "velocity":
            return "target_reached", "at its target"
        return "unknown", "the motor rests, and nothing that the module tells says why"
