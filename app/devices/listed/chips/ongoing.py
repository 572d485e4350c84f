"""The motions under way: why each axis came to rest, and the polling that finds it out while one moves."""

from __future__ import annotations

from dataclasses import dataclass

from ....errors import BenchError, LinkDown, LinkTimeout
from ....links.queue import Priority
from ....registers.listed.ramp import HOLD, POSITION, Ramp
from ....registers.model import Register
from ...core.background_tasks import BackgroundTasks
from ...core.motion_watch import MotionReading, MotionWatch
from ...core.polling import Poller
from ...core.register_io import RegisterIO, Snapshot
from ...core.register_link import RegisterLink
from ...core.results import DeviceState
from ...core.session import Session
from .state import ChipState


@dataclass(frozen=True, slots=True)
class RampReading:
    """One axis as its ramp generator tells, in its own numbers."""

    time_s: float
    mode: int
    position: int
    speed: int
    target: int
    moves: bool
    """It moves, or is about to."""
    status: int | None = None
    """The word of its register of flags, where a table names one that reading does not change."""

    @property
    def reached(self) -> bool:
        """At its target, and meant to be there."""
        return self.mode == POSITION and self.position == self.target and not self.speed


class ChipMotions:
    """Of all axes."""

    def __init__(self, session: Session, link: RegisterLink, state: ChipState, tasks: BackgroundTasks) -> None:
        self._session = session
        self._link = link
        self._state = state
        self._poller = Poller(session, tasks, self._poll, self._to_poll)
        self.watches = tuple(MotionWatch(ramp.axis, session.tell, self._poller.begin) for ramp in state.ramps)

    def mark_unknown(self, axis: int) -> None:
        """A command that may have moved or stopped the axis failed: what it does is not known."""
        self.watches[axis].began("unknown", self._session.device_time_s())

    def written(self, ramp: Ramp, register: Register, time_s: float) -> None:
        """A register that may set the axis in motion was written by hand."""
        mode = self._state.word(ramp.mode.register)
        positioning = mode is not None and ramp.mode.unpack(mode) == POSITION
        target = self._state.word(ramp.target)
        if positioning and register in (ramp.target, ramp.mode.register):
            self.watches[ramp.axis].began("position", time_s, None if target is None else ramp.target.decode(target))
        else:
            self.watches[ramp.axis].began("unknown", time_s)

    def on_state(self, state: DeviceState, problem: BenchError | None) -> None:
        """`Session.state_hooks`: what moved while the link failed nobody saw to its end."""
        if state == "connected" and self.watches:
            self._poller.begin()
        elif state == "failed" and isinstance(problem, LinkDown | LinkTimeout):
            for watch in self.watches:
                if watch.under_way is not None:
                    watch.end("lost_link", f"the link failed while it moved; what it did then is not known: {problem}")

    async def poll(self, io: RegisterIO, ramp: Ramp) -> RampReading:
        """Read what tells how an axis is, in one turn, and heed it. Raises LinkError."""
        state = self._state
        asked = [ramp.mode.register, ramp.target, ramp.max_speed, ramp.acceleration, ramp.speed, ramp.position]
        flags = ramp.status
        if flags is not None and (flags.read_clears or not flags.access.readable):
            flags = None
        asked = [row for row in (*asked, *([flags] if flags is not None else [])) if row.access.readable]
        held = Snapshot(asked, await io.read_many(asked))
        for row in asked:
            state.saw(row, held.word(row))
        self._session.saw_position(ramp.axis, held.value(ramp.position), io.asked_s)
        reading = self._told(held, ramp, io.time_s, None if flags is None else held.word(flags))
        seen = MotionReading(reading.time_s, reading.position, reading.speed or int(reading.moves), reading.reached)
        self.watches[ramp.axis].update(seen, io.time_s - io.asked_s)
        return reading

    def _told(self, held: Snapshot, ramp: Ramp, time_s: float, status: int | None) -> RampReading:
        mode = ramp.mode.unpack(held.word(ramp.mode.register))
        position, speed, target = (held.value(row) for row in (ramp.position, ramp.speed, ramp.target))
        able = all(self._state.word(row) != 0 for row in (ramp.max_speed, ramp.acceleration))
        going = mode != HOLD and (mode != POSITION or position != target)
        return RampReading(time_s, mode, position, speed, target, bool(speed) or (going and able), status)

    # --- polling --------------------------------------------------------------------------------

    def _to_poll(self) -> bool:
        return any(watch.under_way is not None for watch in self.watches)

    async def _poll(self) -> None:
        for ramp in self._state.ramps:
            watch = self.watches[ramp.axis]
            async with self._session.queue.turn(Priority.SAMPLE) as turn:
                await self.poll(self._link.io(turn), ramp)
            if watch.at_rest(self._session.device_time_s()) is not None:
                watch.end("unknown", "the axis rests, and nothing that its registers tell by standard names says why")
