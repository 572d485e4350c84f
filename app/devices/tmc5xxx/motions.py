"""The motions under way: when each began, and what ended it."""

from __future__ import annotations

from collections.abc import Callable

from ...errors import BenchError, LinkDown, LinkTimeout
from ..core.motion_watch import MotionWatch
from ..core.results import DeviceState, MotionEnd
from ..core.session import Session
from .predictions import Predictions


class Motions:
    """A watch for each axis; whoever listens to the device hears of each end."""

    def __init__(self, session: Session, predictions: Predictions) -> None:
        self.wake: Callable[[], None] = lambda: None
        """Sees to it that the axes are polled until the motion under way has ended."""
        self._session = session
        self._predictions = predictions
        self._watches = tuple(MotionWatch(axis.index, self._tell_end, self._begun) for axis in session.axes)
        self._ended = False
        """A motion has ended since the latest poll of our own."""

    def of(self, axis: int) -> MotionWatch:
        """The watch of one axis."""
        return self._watches[axis]

    def ends(self, axis: int) -> tuple[MotionEnd, ...]:
        """Why the motor came to rest, the latest last."""
        return self._watches[axis].ends

    def uncertain(self, axis: int, why: str) -> None:
        """Nobody knows what the axis does now."""
        now_s = self._session.device_time_s()
        self._predictions.end(axis, now_s, why)
        self._watches[axis].began("unknown", now_s)

    # --- polling --------------------------------------------------------------------------------

    def to_poll(self) -> bool:
        """Whether a motion is under way, or has ended: the flags that came with it shall not wait."""
        return self._ended or any(watch.under_way is not None for watch in self._watches)

    def polled(self) -> None:
        """A poll of our own begins."""
        self._ended = False

    def heard_state(self, state: DeviceState, problem: BenchError | None) -> None:
        """The connection is in this state."""
        if state == "connected":
            self.wake()
        elif state == "failed" and isinstance(problem, LinkDown | LinkTimeout):
            for watch in self._watches:
                if watch.under_way is not None:
                    watch.end("lost_link", f"the link failed while it moved; what it did then is not known: {problem}")

    def _begun(self) -> None:
        self.wake()

    def _tell_end(self, end: MotionEnd) -> None:
        present = self._predictions.book(end.axis).present()
        if present is not None and (end.reason != "target_reached" or not present.ends):
            self._predictions.end(end.axis, end.time_s, end.detail)
        self._session.tell(end)
        self._ended = True
