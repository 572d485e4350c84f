"""The moves of one axis: begun, taken further at every look, and ended for good by whatever ends them."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator

from ..devices.core.counter import PositionSeen
from ..devices.core.events import MotionCommanded, motion_owner
from ..devices.core.results import AxisState
from ..errors import BenchError, LinkError, WriteRefused
from .observer import Followed
from .segmented_move import How, Journey

SOON_S = 0.05
"""How soon to look again where something is about to happen: an arrival, a motor slowing down [s]."""
AGAIN_S = 0.5
"""How soon to look again where a look failed though the link works, or nothing moves yet [s]."""


class Mover(Followed):
    """An axis that is sent beyond its counter."""

    journey: Journey | None = None
    """The move under way, or the latest."""

    def close(self) -> None:
        self._end("ended", "the watch ended")
        super().close()

    # --- what ends a move -----------------------------------------------------------------------

    def _commanded(self, event: MotionCommanded) -> None:
        if self.journey is None or event.by is not self.journey:
            self._end("ended", f"ended by another command to this axis: {event.what}")

    def _lost_sight(self, why: str) -> None:
        self._end("ended", f"ended, and nothing is sent again: {why}")

    def _saw(self, event: PositionSeen) -> None:
        super()._saw(event)
        if self.going is not None and self.going.hurries(self.track.followed):
            self._wake_for_others()

    def _end(self, how: How, message: str) -> None:
        if self.going is not None:
            self.going.end(how, message)
            self._changed()

    @property
    def going(self) -> Journey | None:
        """The move under way."""
        return self.journey if self.journey is not None and self.journey.going else None

    # --- one move -------------------------------------------------------------------------------

    async def set_off(self, target: int) -> None:
        """Go to `target`, as the track counts. Raises BenchError; what may have set off then was stopped again."""
        if self.device.limiter is not None:  # told at once, and not at the piece of the way that leads out
            self.device.limiter.require_target(self.axis, target, self.track.followed)
        await self._begin(Journey(self.track.counter, self.track.followed, target, None))

    async def set_off_from_rest(self, find: Callable[[int], int]) -> None:
        """Go to what `find` makes of where the axis stands, stopping it first where it moves. Raises BenchError."""
        journey = Journey(self.track.counter, self.track.followed, None, find)
        if (await self.device.monitor.axis_state(self.axis)).moving:
            self._replace(journey)
            try:
                with self._commanding(journey):
                    await self.device.stop(self.axis)
            except BenchError as error:
                self._end("failed", str(error))
                raise
            self._wake(self)
            return
        journey.stands(self.track.followed)
        await self._begin(journey)

    async def _begin(self, journey: Journey) -> None:
        self._replace(journey)
        try:
            await self._step(journey)
        except (LinkError, WriteRefused) as error:
            await self.give_up(str(error))
            raise
        except BenchError as error:
            self._end("failed", str(error))  # refused before anything was sent: whatever moves is not ours
            raise
        self._wake(self, AGAIN_S)

    def _replace(self, journey: Journey) -> None:
        self._end("ended", "another target")
        self.journey = journey

    async def go_on(self) -> None:
        """Take the move under way further, after a look."""
        journey, doubt = self.going, self.track.doubt
        if journey is None:
            return
        if doubt is not None:
            await self.give_up(f"the position is not known any more: {doubt.reason}")
            return
        try:
            await self._step(journey)
        except BenchError as error:
            await self.give_up(str(error))

    async def _step(self, journey: Journey) -> None:
        """Move the chip's target on, or see that the motor has arrived, or that it never will. Raises BenchError."""
        if journey.target is None:
            if (await self.device.monitor.axis_state(self.axis)).moving or not await self.look():
                return
            journey.stands(self.track.followed)  # and this is where
        if not journey.going:
            return
        at = self.track.followed
        wanted = journey.wants(at)
        if wanted is not None:
            with self._commanding(journey):
                started = await self.device.motion.retarget(self.axis, wanted)
            journey.wrote(wanted, at)
            journey.warnings = list(started.warnings)
            return
        if self._pps and self.track.followed != journey.target:
            journey.turns()
            return
        state = await self.device.monitor.axis_state(self.axis)
        if state.moving:
            journey.turns()
        elif self.track.followed == journey.target:
            self._end("arrived", "at its target")
        elif journey.rests(self.track.followed):
            self._end("failed", _stands_short(state))

    async def give_up(self, why: str) -> None:
        """End the move for a reason of ours and stop the motor; where somebody else has ended it it is theirs."""
        journey = self.going
        if journey is None:
            return
        self._end("failed", why)
        if self.connected:
            with contextlib.suppress(BenchError), self._commanding(journey):
                await self.device.stop(self.axis)

    @contextlib.contextmanager
    def _commanding(self, journey: Journey) -> Iterator[None]:
        token = motion_owner.set(journey)
        try:
            yield
        finally:
            motion_owner.reset(token)

    def next_look_s(self) -> float:
        """When to look next, from now [s]."""
        journey, at = self.going, self.track.followed
        if journey is None:
            return self.period_s
        if journey.target is None or journey.target == at:
            return SOON_S
        arrives_s = abs(journey.target - at) / self._pps if self._pps else AGAIN_S
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
