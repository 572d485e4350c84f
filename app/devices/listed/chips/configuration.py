"""What the registers mean as a configuration, and how a motor is kept still while one is written."""

from __future__ import annotations

from ....registers.model import Register
from ...core.capabilities import ConfigurationRules
from ...core.results import AxisState
from .motion import ChipMotion
from .state import ChipState


class ChipConfiguration(ConfigurationRules):
    """A target beside the motor, or a velocity, would move it."""

    def __init__(self, state: ChipState, motion: ChipMotion) -> None:
        self._state = state
        self._motion = motion

    def unread(self, register: Register, /) -> int | None:
        return self._state.wanted(register)

    async def require_idle(self) -> None:
        """Whether anything runs in it but its motors nobody here knows."""

    async def hold_still(self, axis: int, state: AxisState, /) -> list[str]:
        if state.target_position is None or state.target_position == state.position:
            return []
        (outcome,) = await self._motion.stop_axes([axis])
        if outcome.problem is not None:
            raise outcome.problem
        return [f"axis {axis} was not at its target {state.target_position}: it was told to stop there"]
