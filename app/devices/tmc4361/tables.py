"""The microstep table, which lies in registers that cannot be read.

What they hold is what was written through this connection since the chip's reset, else what the chip has after a reset.
"""

from __future__ import annotations

from ...calc.microsteps.mslut import MslutRegisters
from ..core.capabilities import MslutTable
from ..core.register_file import RegisterRules
from ..core.register_link import RegisterLink
from ..core.results import HeldMslut
from ..core.unread_registers import tell_table
from . import roles
from .memory import ChipMemory

TABLE = (*roles.MSLUT, roles.MSLUTSEL, roles.MSLUTSTART)


class MicrostepTable(MslutTable):
    """The table of one TMC4361; `rules` hear of what is written."""

    def __init__(self, link: RegisterLink, memory: ChipMemory, rules: RegisterRules) -> None:
        self._link = link
        self._session = link.session
        self._memory = memory
        self._rules = rules

    async def read_mslut(self, axis: int = roles.AXIS) -> HeldMslut:
        self._session.axis(axis)
        self._session.require_connected()
        async with self._link.turn() as turn:
            mscnt, currents = await self._link.io(turn).read_many((roles.MSCNT, roles.CURRENTS))
        shown = roles.CURRENTS.unpack(currents)
        return HeldMslut(
            self._table(),
            all(self._memory.kept_word(register) is not None for register in TABLE),
            roles.MSCNT.decode(mscnt),
            shown["CURRENTA"],
            shown["CURRENTB"],
        )

    def _table(self) -> MslutRegisters:
        *words, select, start = (self._memory.held_unread(register) for register in TABLE)
        return MslutRegisters(tuple(words), select, start)

    async def write_mslut(self, registers: MslutRegisters, axis: int | None = None) -> HeldMslut:
        """Raises BadReply where the link shows that a word may have arrived otherwise; then write it again."""
        self._session.axis(axis or roles.AXIS)
        self._session.require_connected()
        with_offset = registers.with_dac_offset(roles.DAC_OFFSET.unpack(self._table().start))
        written = tuple(zip(TABLE, (*with_offset.words, with_offset.select, with_offset.start), strict=True))
        async with self._link.turn() as turn:
            arrived = await self._link.io(turn).write_many(written)
            tell_table(self._link, self._rules, written, arrived)
        return await self.read_mslut()
