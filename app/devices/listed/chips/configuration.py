"""What the registers mean as a configuration, and how a motor is kept still while one is written."""

from __future__ import annotations

from ....registers.listed.ramp import POSITION
from ....registers.model import Access, Register, to_raw
from ...core.capabilities import ConfigurationRules, Registers
from ...core.results import AxisState
from .state import ChipState


class ChipConfiguration(ConfigurationRules):
    """A target beside the motor, or a velocity, would move it."""

    def __init__(self, state: ChipState, registers: Registers) -> None:
        self._state = state
        self._registers = registers

    def settable(self, register: Register, /) -> bool:
        return register.access is not Access.UNKNOWN or self._state.has_taken(register)

    def as_set(self, register: Register, word: int, /) -> int:
        wanted = self._state.wanted(register) if self._state.overwritten(register) else None
        return word if wanted is None else wanted

    def unread(self, register: Register, /) -> int | None:
        return self._state.wanted(register)

    async def require_idle(self) -> None:
        """Whether anything runs in it but its motors nobody here knows."""

    async def hold_still(self, axis: int, state: AxisState, /) -> list[str]:
        ramp = self._state.ramps[axis]
        told = []
        if state.target_position != state.position:
            await self._registers.write(ramp.target.name, ramp.target.axis, state.position)
            told.append(f"axis {axis}: the target is where it stands, {state.position}")
        if state.target_position is None:
            # In a velocity mode VMAX is the speed that it turns at, and writing it would set the motor off.
            mode, held = ramp.mode, self._state.word(ramp.mode.register) or 0
            word = to_raw(mode.pack(POSITION, held), mode.register.width)
            await self._registers.write(mode.register.name, mode.register.axis, mode.register.decode(word))
            told.append(f"axis {axis} holds its position (mode {POSITION})")
        return told
