"""What moves the axis: positioning, rotation and stops as one capability."""

from __future__ import annotations

from collections.abc import Sequence

from ...errors import UsageError
from ..core.capabilities import Motion
from ..core.prediction import Prediction
from ..core.results import AxisMove, MoveStarted, Rotating, StopMode, StopOutcome
from ..core.session import Session
from .expected_motion import ExpectedMotion
from .moves import Moves
from .rotation import Rotation
from .stops import Stops


class ChipMotion(Motion):
    """Of the one axis of a TMC4361."""

    def __init__(
        self, session: Session, moves: Moves, rotation: Rotation, stops: Stops, expected: ExpectedMotion
    ) -> None:
        self._session = session
        self._moves = moves
        self._rotation = rotation
        self._stops = stops
        self._expected = expected

    async def move_together(self, moves: Sequence[AxisMove]) -> list[MoveStarted]:
        """One move, of the one axis. Speed and shape are those the user has set, whatever a stop or a rotation has
        written over them."""
        if len(moves) != 1:
            raise UsageError(f"a {self._session.family.title} has one axis, so a move is of one axis")
        return [await self._moves.go(moves[0])]

    async def rotate(self, axis: int, velocity: float, unit: str = "pps") -> Rotating:
        """In velocity mode, on ramps of the shape that is set. Raises OutOfRange with the chip's limit in `unit`."""
        return await self._rotation.rotate(axis, velocity, unit)

    async def stop_axes(self, axes: Sequence[int], mode: StopMode) -> list[StopOutcome]:
        return await self._stops.stop_axes(axes, mode)

    def speed_limit_pps(self, axis: int) -> float:
        self._session.axis(axis)
        return self._session.clock_hz / 2

    def prediction(self, axis: int) -> Prediction | None:
        self._session.axis(axis)
        return self._expected.book.present()
