"""The motions that are expected of the axes."""

from __future__ import annotations

from ...calc.ramps.sixpoint import MotionPlan
from ...errors import BenchError
from ..core.planned_motion import PlannedMotion
from ..core.prediction import PredictionBook
from ..core.results import DeviceState
from ..core.session import Session


class Predictions:
    """A book of predictions for each axis."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._books: tuple[PredictionBook[PlannedMotion], ...] = tuple(PredictionBook() for _ in session.axes)

    def book(self, axis: int) -> PredictionBook[PlannedMotion]:
        """Those of one axis, the past ones included."""
        return self._books[axis]

    def expect(self, axis: int, started_s: float, position: int, plan: MotionPlan | None) -> None:
        """A motion began at `started_s` [s, device time] at `position`; without a plan nothing is known of it."""
        if plan is None:
            self._books[axis].end(started_s, "another command")
        else:
            self._books[axis].add(PlannedMotion(axis, started_s, position, plan))

    def end(self, axis: int, at_s: float, why: str) -> None:
        """Whatever is predicted of an axis holds no longer."""
        self._books[axis].end(at_s, why)

    def end_all(self, why: str) -> None:
        """Whatever is predicted holds no longer, from now on."""
        for book in self._books:
            book.end(self._session.device_time_s(), why)

    def was_reset(self) -> None:
        """The chip was reset."""
        self.end_all("the chip was reset")

    def heard_state(self, state: DeviceState, problem: BenchError | None) -> None:
        """The connection is in this state."""
        del problem
        if state == "failed":
            self.end_all("the link failed")
