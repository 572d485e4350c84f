"""What the registers of a ramp generator chip mean as a configuration."""

from __future__ import annotations

from ...registers.model import Register
from ..core.capabilities import ConfigurationRules
from ..core.register_file import RegisterFile
from ..core.results import AxisState
from .axis_roles import POSITIONING_MODES
from .memory import RampMemory
from .writes import RampWrites


class RampConfiguration(ConfigurationRules):
    """The ramp mode of a rotation or a stop is no configuration; a target beside the motor would move it."""

    def __init__(self, registers: RegisterFile, memory: RampMemory, writes: RampWrites) -> None:
        self._registers = registers
        self._memory = memory
        self._writes = writes

    def as_set(self, register: Register, word: int, /) -> int:
        return self.as_written(register, word)

    def as_written(self, register: Register, word: int, /) -> int:
        return self._writes.as_written(register, word)

    def commanded_bits(self, register: Register, word: int, /) -> int:
        for rows in self._memory.rows:
            if register is rows.reference and rows.mode.unpack(word) not in POSITIONING_MODES:
                return rows.mode.mask
        return 0

    async def require_idle(self) -> None:
        """Nothing runs in such a chip but its motors."""

    async def hold_still(self, axis: int, state: AxisState, /) -> list[str]:
        if state.target_position == state.position:
            return []
        await self._registers.write(self._memory.rows[axis].x_target.name, axis, state.position)
        return [f"axis {axis}: the target is where it stands, {state.position} instead of {state.target_position}"]
