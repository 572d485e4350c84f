"""The moves of one axis: begun, taken further at every look, and ended for good by whatever ends them."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator

from ..devices.core.counter import PositionSeen
from ..devices.core.events import MotionCommanded, motion_owner
from ..devices.core.results import AxisState
from ..errors import BenchError, LinkError, WriteRefused
from .observer import Observer
from .segmented_move import How, SegmentedMove

SOON_S = 0.05
"""How soon to look again where something is about to happen: an arrival, a motor slowing down [s]."""
AGAIN_S = 0.5
"""How soon to look again where a look failed though the link works, or nothing moves yet [s]."""


class Mover(Observer):
    """An axis that is sent beyond its counter."""

    move: SegmentedMove | None = None
    """The move under way, or the latest."""

    def close(self) -> None:
        self._end("ended", "the watch ended")
        super().close()

    # --- what ends a move -----------------------------------------------------------------------

    def _commanded(self, event: MotionCommanded) -> None:
        if self.move is None or event.by is not self.move:
            self._end("ended", f"ended by another command to this axis: {event.what}")

    def _lost_sight(self, why: str) -> None:
        self._end("ended", f"ended, and nothing is sent again: {why}")

    def _saw(self, event: PositionSeen) -> None:
        super()._saw(event)
        if self.going is not None and self.going.hurries(self.tracker.extended):
            self._wake_for_others()

    def _end(self, how: How, message: str) -> None:
        if self.going is not None:
            self.going.end(how, message)
            self._changed()

    @property
    def going(self) -> SegmentedMove | None:
        """The move under way."""
        return self.move if self.move is not None and self.move.going else None

    # --- one move -------------------------------------------------------------------------------

    async def set_off(self, target: int) -> None:
        """Go to `target`, as the tracker counts. Raises BenchError; what may have set off then was stopped again."""
        if self.device.limiter is not None:  # told at once, and not at the piece of the way that leads out
            self.device.limiter.require_target(self.axis, target, self.tracker.extended)
        await self._begin(SegmentedMove(self.tracker.counter, self.tracker.extended, target, None))

    async def set_off_from_rest(self, find: Callable[[int], int]) -> None:
        """Go to what `find` makes of where the axis stands, stopping it first where it moves. Raises BenchError."""
        move = SegmentedMove(self.tracker.counter, self.tracker.extended, None, find)
        if (await self.device.monitor.axis_state(self.axis)).moving:
            self._replace(move)
            try:
                with self._commanding(move):
                    await self.device.stop(self.axis)
            except BenchError as error:
                self._end("failed", str(error))
                raise
            self._wake(self)
            return
        move.stands(self.tracker.extended)
        await self._begin(move)

    async def _begin(self, move: SegmentedMove) -> None:
        self._replace(move)
        try:
            await self._step(move)
        except (LinkError, WriteRefused) as error:
            await self.give_up(str(error))
            raise
        except BenchError as error:
            self._end("failed", str(error))  # refused before anything was sent: whatever moves is not ours
            raise
        self._wake(self, AGAIN_S)

    def _replace(self, move: SegmentedMove) -> None:
        self._end("ended", "another target")
        self.move = move

    async def go_on(self) -> None:
        """Take the move under way further, after a look."""
        move, lost = self.going, self.tracker.lost
        if move is None:
            return
        if lost is not None:
            await self.give_up(f"the position is not known any more: {lost.reason}")
            return
        try:
            await self._step(move)
        except BenchError as error:
            await self.give_up(str(error))

    async def _step(self, move: SegmentedMove) -> None:
        """Move the chip's target on, or see that the motor has arrived, or that it never will. Raises BenchError."""
        if move.target is None:
            if (await self.device.monitor.axis_state(self.axis)).moving or not await self.poll():
                return
            move.stands(self.tracker.extended)  # and this is where
        if not move.going:
            return
        at = self.tracker.extended
        wanted = move.wants(at)
        if wanted is not None:
            with self._commanding(move):
                started = await self.device.motion.retarget(self.axis, wanted)
            move.wrote(wanted, at)
            move.warnings = list(started.warnings)
            return
        if self._pps and self.tracker.extended != move.target:
            move.turns()
            return
        state = await self.device.monitor.axis_state(self.axis)
        if state.moving:
            move.turns()
        elif self.tracker.extended == move.target:
            self._end("arrived", "at its target")
        elif move.rests(self.tracker.extended):
            self._end("failed", _stands_short(state))

    async def give_up(self, why: str) -> None:
        """End the move for a reason of ours and stop the motor; where another client has ended it it is theirs."""
        move = self.going
        if move is None:
            return
        self._end("failed", why)
        if self.connected:
            with contextlib.suppress(BenchError), self._commanding(move):
                await self.device.stop(self.axis)

    @contextlib.contextmanager
    def _commanding(self, move: SegmentedMove) -> Iterator[None]:
        token = motion_owner.set(move)
        try:
            yield
        finally:
            motion_owner.reset(token)

    def next_poll_s(self) -> float:
        """When to look next, from now [s]."""
        move, at = self.going, self.tracker.extended
        if move is None:
            return self.period_s
        if move.target is None or move.target == at:
            return SOON_S
        arrives_s = abs(move.target - at) / self._pps if self._pps else AGAIN_S
        # A little before it arrives, if it goes on like this: while it slows down that comes nearer and nearer.
        return min(self.period_s, max(SOON_S, 0.9 * arrives_s))


def _stands_short(state: AxisState) -> str:
    sides = [
        name
        for name, active in (
            ("left", state.switches.left),
            ("right", state.switches.right),
        )
        if active
    ]
    why = f": the {' and the '.join(sides)} switch is active" if sides else ""
    return f"the motor stands short of its target{why}; nothing is sent again"
