"""Takes notice of the flags that the chip keeps."""

from __future__ import annotations

from dataclasses import dataclass

from ..core.capabilities import LatchedFlags, Registers
from ..core.register_link import RegisterLink
from ..core.session import Session
from .events import Events
from .memory import ChipMemory
from .reader import ChipReader
from .standstill import Standstill


@dataclass(frozen=True, slots=True)
class FlagClearing(LatchedFlags):
    """Clears RAMP_STAT and GSTAT without setting anything off."""

    session: Session
    link: RegisterLink
    memory: ChipMemory
    log: Events
    reader: ChipReader
    standstill: Standstill
    registers: Registers

    async def clear_flags(self, axis: int) -> None:
        """Take notice of RAMP_STAT and GSTAT, as reading or writing them does. An axis that a stall holds is kept
        where it is first, so nothing moves."""
        rows = self.memory.rows(self.session.axis(axis).index)
        self.session.require_connected()
        async with self.session.queue.turn() as turn:
            io = self.link.io(turn)
            if self.log.stalled(axis) or not self.reader.may_read_stat(axis):
                await self.standstill.keep(io, axis)
        for row, where in ((rows.ramp_stat, axis), (self.memory.chip.gstat, None)):
            if row.read_clears:
                await self.registers.read(row.name, where)
            else:
                await self.registers.write(row.name, where, value=(await self.registers.read(row.name, where)).value)
