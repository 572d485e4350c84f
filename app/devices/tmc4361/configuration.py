"""What the registers of a TMC4361 mean as a configuration."""

from __future__ import annotations

from ...errors import WrongState
from ...registers.model import Register
from ..core.capabilities import ConfigurationRules, Registers
from ..core.results import AxisState
from ..core.session import Session
from . import roles
from .memory import ChipMemory
from .moves import Moves


class Configuration(ConfigurationRules):
    """Of one TMC4361."""

    def __init__(self, session: Session, memory: ChipMemory, registers: Registers, moves: Moves) -> None:
        self._session = session
        self._memory = memory
        self._registers = registers
        self._moves = moves

    def as_set(self, register: Register, word: int, /) -> int:
        return self._memory.as_set(register, word)

    def unread(self, register: Register, /) -> int | None:
        return self._memory.word_unread(register)

    async def require_idle(self) -> None:
        regulation = (await self._registers.read(roles.ENC_IN_CONF.name, roles.AXIS)).fields[roles.REGULATION.name]
        if regulation:
            raise WrongState(f"the closed loop of {self._session.name} is on", "switch it off first")

    async def hold_still(self, axis: int, state: AxisState, /) -> list[str]:
        mode = (await self._registers.read(roles.RAMPMODE.name, axis)).value
        if mode & roles.POSITIONING_BIT and state.target_position == state.position:
            return []
        await self._moves.stand_ready(axis)
        was = f"RAMPMODE was {mode}, XTARGET {state.target_position}"
        return [f"axis {axis} holds its position, {state.position} ({was})"]
