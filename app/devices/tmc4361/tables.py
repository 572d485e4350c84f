"""The microstep table, which lies in registers that cannot be read.

What they hold is what was written through this connection since the chip's reset, else what the chip has after a reset.
"""

from __future__ import annotations

from ...calc.microsteps.mslut import MslutRegisters
from ...errors import BadReply
from ...links.queue import Priority
from ..core.results import HeldMslut
from . import rows
from .raw import Raw

TABLE = (*rows.MSLUT, rows.MSLUTSEL, rows.MSLUTSTART)


class Tables(Raw):
    """A TMC4361 with its tables."""

    async def read_mslut(self, axis: int = rows.AXIS) -> HeldMslut:
        self.axis(axis)
        self.require_connected()
        async with self.queue.turn() as turn:
            mscnt, currents = await self.words(turn).read_many((rows.MSCNT, rows.CURRENTS))
        shown = rows.CURRENTS.unpack(currents)
        return HeldMslut(
            self._table(),
            all(register.address in self._blind for register in TABLE),
            rows.MSCNT.decode(mscnt),
            shown["CURRENTA"],
            shown["CURRENTB"],
        )

    def _table(self) -> MslutRegisters:
        *words, select, start = (self._blind.get(register.address, register.reset or 0) for register in TABLE)
        return MslutRegisters(tuple(words), select, start)

    async def write_mslut(self, registers: MslutRegisters, axis: int | None = None) -> HeldMslut:
        """Raises BadReply where the link shows that a word may have arrived otherwise; then write it again."""
        self.axis(axis or rows.AXIS)
        self.require_connected()
        with_offset = registers.with_dac_offset(rows.DAC_OFFSET.unpack(self._table().start))
        written = tuple(zip(TABLE, (*with_offset.words, with_offset.select, with_offset.start), strict=True))
        async with self.queue.turn(Priority.COMMAND) as turn:
            arrived = await self.words(turn).write_many(written)
            self._wrote_table(written, arrived)
        if not arrived:
            raise BadReply(self.port.name, "a word of the microstep table may have arrived otherwise", b"")
        return await self.read_mslut()
