"""What is known of a listed module as a configuration: its firmware's version, and how its axes are kept still."""

from __future__ import annotations

from ...registers.model import Register
from ..core.capabilities import ConfigurationRules
from ..core.results import AxisState
from .motion import ListedMotion
from .state import ListedState


class ListedConfiguration(ConfigurationRules):
    """Its settings are what it was seen to take."""

    def __init__(self, state: ListedState, motion: ListedMotion) -> None:
        self._state = state
        self._motion = motion

    @property
    def firmware(self) -> str:
        return self._state.firmware

    def settable(self, register: Register, /) -> bool:
        return self._state.has_taken(register)

    async def require_idle(self) -> None:
        """Whether a program runs in it nobody here knows."""

    async def hold_still(self, axis: int, state: AxisState, /) -> list[str]:
        if state.target_position is None or state.target_position == state.position:
            return []
        (outcome,) = await self._motion.stop_axes([axis])
        if outcome.problem is not None:
            raise outcome.problem
        return [f"axis {axis} was not at its target {state.target_position}: it was told to stop there"]
