"""The motion under way: the ramp that is expected of it, and the watch that tells how it ended."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...calc.ramps.sramp_plan import SRampPlan
from ...errors import BenchError
from ..core.motion_watch import MotionWatch
from ..core.planned_motion import PlannedMotion
from ..core.prediction import FloatArray, PredictionBook
from ..core.results import DeviceState, MotionEnd
from ..core.session import Session
from . import roles


class ExpectedMotion:
    """Of the one axis."""

    def __init__(self, session: Session) -> None:
        self.book: PredictionBook[PlannedMotion] = PredictionBook()
        self.watch = MotionWatch(roles.AXIS, self._ended, self._began)
        self.begun_hooks: list[Callable[[], None]] = []
        """Parts that see to it that the axis is polled until the motion under way has ended."""
        self._session = session
        session.state_hooks.append(self._state_set)

    def expect(self, started_s: float, position: int, plan: SRampPlan | None) -> None:
        """A command went out at `started_s` [s], and this comes of it; None where nobody can tell."""
        if plan is None:
            self.book.end(started_s, "another command")
        else:
            self.book.add(PlannedMotion(roles.AXIS, started_s, position, plan))

    def uncertain(self, why: str) -> None:
        """What the axis does now is not known."""
        now_s = self._session.device_time_s()
        self.book.end(now_s, why)
        self.watch.began("unknown", now_s)

    def end_at_reset(self) -> None:
        """The chip was reset."""
        self.book.end(self._session.device_time_s(), "the chip was reset")

    def accelerations(self, times_s: FloatArray) -> FloatArray:
        """What was expected at device times [pps^2]; NaN where nothing was."""
        acceleration = np.full(times_s.shape, np.nan)
        for motion in self.book.over(times_s):
            expected = motion.acceleration_at(times_s)
            known = ~np.isnan(expected)
            acceleration[known] = expected[known]
        return acceleration

    def _ended(self, end: MotionEnd) -> None:
        present = self.book.present()
        if present is not None and (end.reason != "target_reached" or not present.ends):
            self.book.end(end.time_s, end.detail)
        self._session.tell(end)

    def _began(self) -> None:
        for hook in self.begun_hooks:
            hook()

    def _state_set(self, state: DeviceState, problem: BenchError | None) -> None:
        del problem
        if state == "failed":
            self.book.end(self._session.device_time_s(), "the link failed")
