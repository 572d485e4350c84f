"""The motions under way: what drives each axis, why it came to rest, and the task that polls while one moves."""

from __future__ import annotations

import asyncio

from ...errors import BadReply, BenchError, LinkDown, LinkError, LinkTimeout
from ...links.queue import Priority, SampleDropped
from ...registers.model import Register
from ..core.background_tasks import BackgroundTasks
from ..core.motion_watch import POLL_S, Kind, MotionReading, MotionWatch
from ..core.results import DeviceState, MotionEnd
from ..core.session import Session
from ..core.tmcl_calls import Calls
from ..core.tmcl_link import TmclLink
from .state import ListedState


class ListedAxisMotion:
    """Of one axis. Sends nothing that moves it: who does so tells it here."""

    def __init__(self, axis: int, motions: ListedMotions) -> None:
        self.driven: Kind | None = None
        """What the latest command from here made of the axis; None where that is not known."""
        self.watch = MotionWatch(axis, motions.tell_end, motions.begin_polling)

    def drives(self, kind: Kind, started_s: float, target: int | None) -> None:
        """The axis follows `kind` from now on."""
        self.driven = kind
        self.watch.began(kind, started_s, target)

    def stop_commanded(self, time_s: float) -> None:
        """The axis was told to stop, and the module has answered."""
        self.driven = "velocity"
        self.watch.stop_commanded(time_s)

    def mark_unknown(self, now_s: float) -> None:
        """A command that may have moved or stopped the axis failed: what it does is not known."""
        self.driven = None
        self.watch.began("unknown", now_s)

    def reached(self, told: int | None, position: int, target: int | None) -> bool:
        """Whether the axis is at its target: as the module tells, else by where it is and where it was sent."""
        return position == target if told is None else bool(told)


class ListedMotions:
    """Of all axes, and the task that polls those that move."""

    def __init__(self, session: Session, state: ListedState, link: TmclLink, tasks: BackgroundTasks) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._tasks = tasks
        self._polling: asyncio.Task[None] | None = None
        self.axes = tuple(ListedAxisMotion(axis.index, self) for axis in session.axes)

    def tell_end(self, end: MotionEnd) -> None:
        self._session.tell(end)

    def mark_unknown(self, axis: int) -> None:
        self.axes[axis].mark_unknown(self._session.device_time_s())

    def written(self, register: Register, value: int, time_s: float) -> None:
        """A parameter that may set an axis in motion was written."""
        assert register.axis is not None  # only such a row is said to move one
        rows, axis = self._state.axes[register.axis], self.axes[register.axis]
        if register is rows.target_position:
            axis.drives("position", time_s, value)
        elif register is rows.target_speed:
            axis.drives("velocity", time_s, None)
        else:
            axis.drives(axis.driven or "unknown", time_s, None)

    def on_seen(self, register: Register, value: int) -> None:
        """`ListedState.saw_hooks`: a motion that another master began."""
        if register.axis is None or register is not self._state.axes[register.axis].speed or not value:
            return
        watch = self.axes[register.axis].watch
        if watch.under_way is None:
            watch.began("unknown", self._session.port.last_exchange_s)

    def on_state(self, state: DeviceState, problem: BenchError | None) -> None:
        """`Session.state_hooks`: where the link failed, nobody knows what the axes do."""
        if state != "failed":
            return
        for axis in self.axes:
            axis.driven = None
            if isinstance(problem, LinkDown | LinkTimeout):
                self._lose_sight(axis, str(problem))

    # --- polling --------------------------------------------------------------------------------

    def begin_polling(self) -> None:
        """Look at every axis that moves until it has come to rest."""
        if self._polling is None or self._polling.done():
            self._polling = self._tasks.begin(self._poll_until_rest(), f"motion of {self._session.id}")

    async def _poll_until_rest(self) -> None:
        while any(axis.watch.under_way is not None for axis in self.axes):
            await self._session.background.sleep(POLL_S)
            for index, axis in enumerate(self.axes):
                if axis.watch.under_way is None:
                    continue
                try:
                    await self._poll(index)
                except (SampleDropped, BadReply):
                    continue  # the link is busy, or noisy: later then
                except LinkError as error:
                    self._lose_sight(axis, str(error))
                except BenchError:
                    continue

    async def _poll(self, index: int) -> None:
        """Ask once, unless a caller has just asked; where the axis rests for a while, its motion has ended."""
        watch = self.axes[index].watch
        if self._session.device_time_s() - watch.polled_s > POLL_S * self._session.time_scale:
            async with self._link.calls(priority=Priority.SAMPLE) as calls:
                await self.poll(index, calls)
        if watch.at_rest(self._session.device_time_s()) is not None:
            watch.end("unknown", "the axis rests, and nothing that the module tells by standard names says why")

    async def poll(self, index: int, calls: Calls) -> list[int | None]:
        """Read what tells how an axis is (`AxisRoles.polled`, None for what is lacking), and heed it."""
        rows = self._state.axes[index]
        asked_at_s = self._session.device_time_s()
        values = [*await calls.ask_many(rows.polled), *[None] * (rows.position_reached is None)]
        position, speed = calls.need(rows.position, values[0]), calls.need(rows.speed, values[1])
        axis = self.axes[index]
        self._session.saw_position(index, position, asked_at_s)
        reached = axis.reached(values[4], position, values[2])
        axis.watch.update(MotionReading(calls.time_s, position, speed, reached), self._link.poll_spread_s)
        return values

    @staticmethod
    def _lose_sight(axis: ListedAxisMotion, why: str) -> None:
        if axis.watch.under_way is not None:
            axis.watch.end("lost_link", f"the link failed while it moved; what it did then is not known: {why}")
