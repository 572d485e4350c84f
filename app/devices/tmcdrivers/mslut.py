"""The microstep table of drivers that have one, in registers that may be written only.

What it holds is what was read, or written through this connection since the chip's reset, else what it has after one.
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
from .memory import DriverMemory


@dataclass(frozen=True, slots=True)
class MicrostepTables(MslutTable):
    """The table of the one axis; `rules` hear of every word that goes out."""

    session: Session
    link: RegisterLink
    memory: DriverMemory
    rules: RegisterRules

    async def read_mslut(self, axis: int = 0) -> HeldMslut:
        self.session.axis(axis)
        self.session.require_connected()
        rows = self.memory.rows
        table = [row for row in rows.mslut if row.access.readable]
        async with self.link.turn() as turn:
            mscnt, currents, *held = await self.link.io(turn).read_many((rows.mscnt, rows.mscuract, *table))
        for row, word in zip(table, held, strict=True):
            self.memory.saw_word(row, word)
        shown = rows.mscuract.unpack(currents)
        written = [self.memory.written(row) for row in rows.mslut]
        words = [(row.reset or 0) if word is None else word for row, word in zip(rows.mslut, written, strict=True)]
        sine, cosine = rows.sine
        return HeldMslut(
            MslutRegisters(tuple(words[:8]), words[8], words[9]),
            None not in written,
            rows.mscnt.decode(mscnt),
            shown[sine],
            shown[cosine],
        )

    async def write_mslut(self, registers: MslutRegisters, axis: int | None = None) -> HeldMslut:
        """Raises BadReply where the link shows that a word may have arrived otherwise; then write it again."""
        self.session.axis(axis or 0)
        self.session.require_connected()
        words = (*registers.words, registers.select, registers.start)
        written = list(zip(self.memory.rows.mslut, words, strict=True))
        async with self.link.turn() as turn:
            arrived = await self.link.io(turn).write_many(written)
            tell_table(self.link, self.rules, written, arrived)
        return await self.read_mslut(axis or 0)
