"""What the registers mean as a configuration."""

from __future__ import annotations

from ...registers.model import Register
from ..core.capabilities import ConfigurationRules, Registers
from ..core.results import AxisState
from .memory import DriverMemory


class Configuration(ConfigurationRules):
    """VACTUAL is what the motor was last told to do; all else is configuration."""

    def __init__(self, memory: DriverMemory, registers: Registers) -> None:
        self._memory = memory
        self._registers = registers

    def unread(self, register: Register, /) -> int | None:
        return self._memory.word(register)

    async def require_idle(self) -> None:
        """Nothing runs in such a chip but its motor."""

    async def hold_still(self, axis: int, state: AxisState, /) -> list[str]:
        del state
        row = self._memory.rows.vactual
        if row is None or self._memory.velocity == 0:
            return []
        await self._registers.write(row.name, axis, 0)
        return [f"axis {axis} turns by STEP alone ({row.name} 0)"]
