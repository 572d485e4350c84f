"""It is moved by whatever steps it, or tells it currents: here nothing can be sent anywhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ....errors import BenchError, WrongState
from ...core.capabilities import Motion
from ...core.prediction import Prediction
from ...core.results import AxisMove, MoveStarted, Rotating, StopMode, StopOutcome
from ...core.session import Session
from ...core.stop_each import stop_each
from ..motion import HOW_TO_STOP, STEPPED
from .memory import STANDS, TaggedMemory
from .status import StatusReader


@dataclass(frozen=True, slots=True)
class TaggedMotion(Motion):
    """Says what could move it, and what could stop it."""

    session: Session
    memory: TaggedMemory
    reader: StatusReader

    async def move_together(self, moves: Sequence[AxisMove]) -> list[MoveStarted]:
        raise self._cannot("counts no position and has no ramp, so it cannot be sent anywhere")

    async def rotate(self, axis: int, velocity: float, unit: str = "pps") -> Rotating:
        raise self._cannot("has no velocity of its own")

    def _cannot(self, why: str) -> WrongState:
        return WrongState(f"a {self.session.family.title} {why}", "move it by whatever steps it")

    async def stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        """Nothing here moves it; where it is stepped, the outcome says who could end that."""

        async def stop(axis: int) -> BenchError | None:
            del axis
            if self.memory.takes_currents or not self.memory.answers:
                return None  # whoever tells it currents is stopped by itself
            row = self.memory.rows.scale
            try:
                status = await self.reader.read((row,))
            except BenchError as error:
                return error
            return None if status.value(row, STANDS) else WrongState(STEPPED, HOW_TO_STOP)

        return await stop_each(self.session, axes, mode, stop)

    def speed_limit_pps(self, axis: int) -> float:
        self.session.axis(axis)
        return self.session.clock_hz / 2

    def prediction(self, axis: int) -> Prediction | None:
        self.session.axis(axis)
        return None
