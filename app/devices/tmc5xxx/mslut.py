"""Microstep tables, which lie in registers that cannot be read.

What they hold is what was written through this connection since the
chip's reset, else what the chip has after a reset. The two axes of a TMC5031 and a TMC5062 have a table each, those of
a TMC5072 share one.
"""

from __future__ import annotations

from dataclasses import dataclass

from ...calc.microsteps.mslut import MslutRegisters
from ..core.capabilities import MslutTable
from ..core.register_file import RegisterRules
from ..core.register_link import RegisterLink
from ..core.results import HeldMslut
from ..core.session import Session
from ..core.unread_registers import tell_table
from .memory import ChipMemory


@dataclass(frozen=True, slots=True)
class MicrostepTables(MslutTable):
    """The table of each axis; `rules` hear of every word that goes out."""

    session: Session
    link: RegisterLink
    memory: ChipMemory
    rules: RegisterRules

    async def read_mslut(self, axis: int = 0) -> HeldMslut:
        """The table of an axis, and what the chip shows of it."""
        rows = self.memory.rows(self.session.axis(axis).index)
        self.session.require_connected()
        async with self.link.turn() as turn:
            mscnt, currents = await self.link.io(turn).read_many((rows.mscnt, rows.mscuract))
        shown = rows.mscuract.unpack(currents)
        written = [self.memory.written(row) for row in rows.mslut]
        words = [(row.reset or 0) if word is None else word for row, word in zip(rows.mslut, written, strict=True)]
        # Phase A of the drawing is the sine, which these chips call CUR_B (data sheets, MSCURACT).
        return HeldMslut(
            MslutRegisters(tuple(words[:8]), words[8], words[9]),
            None not in written,
            rows.mscnt.decode(mscnt),
            shown["CUR_B"],
            shown["CUR_A"],
        )

    async def write_mslut(self, registers: MslutRegisters, axis: int | None = None) -> HeldMslut:
        """Raises BadReply where the link shows that a word may have arrived otherwise; then write it again."""
        axes = self.memory.chip.axes if axis is None else (self.memory.rows(self.session.axis(axis).index),)
        self.session.require_connected()
        words = (*registers.words, registers.select, registers.start)
        written = {row.address: (row, word) for rows in axes for row, word in zip(rows.mslut, words, strict=True)}
        async with self.link.turn() as turn:
            arrived = await self.link.io(turn).write_many(list(written.values()))
            tell_table(self.link, self.rules, written.values(), arrived)
        return await self.read_mslut(axis or 0)
