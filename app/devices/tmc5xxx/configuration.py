"""What the registers mean as a configuration."""

from __future__ import annotations

from ...registers.model import Register
from ..core.capabilities import ConfigurationRules, Registers
from ..core.results import AxisState
from . import roles as r
from .memory import ChipMemory


class Configuration(ConfigurationRules):
    """Ramps are as the user wants them; a target beside the motor, or a velocity, would move it."""

    def __init__(self, memory: ChipMemory, registers: Registers) -> None:
        self._memory = memory
        self._registers = registers

    def unread(self, register: Register, /) -> int | None:
        return self._memory.wanted(register)

    async def require_idle(self) -> None:
        """Nothing runs in such a chip but its motors."""

    async def hold_still(self, axis: int, state: AxisState, /) -> list[str]:
        del state
        rows, registers = self._memory.rows(axis), self._registers
        mode = (await registers.read(rows.rampmode.name, axis)).value
        target = (await registers.read(rows.xtarget.name, axis)).value
        position = (await registers.read(rows.xactual.name, axis)).value
        told = []
        if target != position:
            await registers.write(rows.xtarget.name, axis, position)
            told.append(f"axis {axis}: the target is where it stands, {position} instead of {target}")
        if mode != r.POSITION:
            # In velocity mode VMAX is the speed that it turns at, and writing it would set the motor off.
            await registers.write(rows.rampmode.name, axis, r.POSITION)
            told.append(f"axis {axis} holds its position (RAMPMODE {r.POSITION} instead of {mode})")
        return told
