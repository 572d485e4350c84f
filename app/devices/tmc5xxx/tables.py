"""Microstep tables, which lie in registers that cannot be read.

What they hold is what was written through this connection since the
chip's reset, else what the chip has after a reset. The two axes of a TMC5031 and a TMC5062 have a table each, those of
a TMC5072 share one.
"""

from __future__ import annotations

from ...calc.microsteps.mslut import MslutRegisters
from ...errors import BadReply
from ...links.queue import Priority
from ..core.results import HeldMslut
from .raw import Raw


class Tables(Raw):
    """A TMC5xxx with its tables."""

    async def read_mslut(self, axis: int = 0) -> HeldMslut:
        """The table of an axis, and what the chip shows of it."""
        rows = self.rows(self.axis(axis).index)
        self.require_connected()
        async with self.queue.turn() as turn:
            mscnt, currents = await self.words(turn).read_many((rows.mscnt, rows.mscuract))
        shown = rows.mscuract.unpack(currents)
        words = [self._blind.get(row.address, row.reset or 0) for row in rows.mslut]
        # Phase A of the drawing is the sine, which these chips call CUR_B (data sheets, MSCURACT).
        return HeldMslut(
            MslutRegisters(tuple(words[:8]), words[8], words[9]),
            all(row.address in self._blind for row in rows.mslut),
            rows.mscnt.decode(mscnt),
            shown["CUR_B"],
            shown["CUR_A"],
        )

    async def write_mslut(self, registers: MslutRegisters, axis: int | None = None) -> HeldMslut:
        """Raises BadReply where the link shows that a word may have arrived otherwise; then write it again."""
        axes = self.chip.axes if axis is None else (self.rows(self.axis(axis).index),)
        self.require_connected()
        words = (*registers.words, registers.select, registers.start)
        written = {row.address: (row, word) for rows in axes for row, word in zip(rows.mslut, words, strict=True)}
        async with self.queue.turn(Priority.COMMAND) as turn:
            arrived = await self.words(turn).write_many(list(written.values()))
            self._wrote_table(written.values(), arrived)
        if not arrived:
            raise BadReply(self.port.name, "a word of the microstep table may have arrived otherwise", b"")
        return await self.read_mslut(axis or 0)
