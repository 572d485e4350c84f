"""Whether a move has arrived, from polls of the axis. No clock and no socket: both clients feed it."""

from __future__ import annotations

from .errors import MoveEnded
from .records import AxisState, MoveStarted

POLL_PERIOD_S = 0.05
"""A poll costs the device a few registers; the page's own is no faster [s]."""
STANDSTILL_POLLS = 4
"""So often in a row it is seen to stand elsewhere before the move counts as ended: a turning point stands as well."""


class Arrival:
    """Fed with every poll; `update` returns True once the axis stands at its target."""

    def __init__(self, started: MoveStarted) -> None:
        self._started = started
        self._standing = 0

    def update(self, state: AxisState) -> bool:
        """Raises MoveEnded where it will not arrive by itself any more."""
        target = self._started.target_position
        if state.target_position is not None and state.target_position != target:
            raise self._ended(state, f"was sent to {state.target_position} instead")
        if not state.moving and state.position_reached:
            return True
        self._standing = 0 if state.moving else self._standing + 1
        if self._standing >= STANDSTILL_POLLS:
            raise self._ended(state, self._why(state))
        return False

    def share(self, state: AxisState) -> float:
        """How much of the way is done, 0..1."""
        way = self._started.target_position - self._started.from_position
        done = state.position - self._started.from_position
        return 1.0 if way == 0 else min(max(done / way, 0.0), 1.0)

    def _ended(self, state: AxisState, why: str) -> MoveEnded:
        target = self._started.target_position
        message = f"axis {self._started.axis} {why}: at {state.position}, on the way to {target}"
        return MoveEnded(message, state.position, target)

    def _why(self, state: AxisState) -> str:
        pressed = [name for name, active in state.switches.items() if active]
        return f"stands; active switches: {', '.join(pressed)}" if pressed else "stands: it was stopped"
