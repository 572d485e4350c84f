"""The microstep table, and the whole configuration as a document.

Both lie in registers that cannot be read. What they hold is what was written through this connection since the chip's
reset, else what the chip has after a reset.
"""

from __future__ import annotations

from app.calc.mslut import MslutRegisters
from app.devices.profile import is_configuration, read_profile
from app.devices.results import HeldMslut, ProfileDocument, ProfileEntry
from app.devices.tmc4361 import rows
from app.devices.tmc4361.raw import Raw
from app.links.errors import BadReply
from app.links.queue import Priority
from app.registers.model import Access, Register

TABLE = (*rows.MSLUT, rows.MSLUTSEL, rows.MSLUTSTART)
ONCE = frozenset(
    rows.row(name).name
    for name in (
        "COVER_LOW",
        "COVER_HIGH",
        "ADDR_TO_ENC",
        "DATA_TO_ENC",
    )
)
"""Registers whose writing does something instead of setting something."""


class Tables(Raw):
    """A TMC4361 with its tables."""

    async def read_mslut(self) -> HeldMslut:
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

    async def write_mslut(self, registers: MslutRegisters) -> HeldMslut:
        """Raises BadReply where the link shows that a word may have arrived otherwise; then write it again."""
        self.require_connected()
        with_offset = registers.with_dac_offset(rows.DAC_OFFSET.unpack(self._table().start))
        written = tuple(zip(TABLE, (*with_offset.words, with_offset.select, with_offset.start), strict=True))
        async with self.queue.turn(Priority.COMMAND) as turn:
            arrived = await self.words(turn).write_many(written)
            for register, word in written:
                self._sent(register, word)
        if not arrived:
            raise BadReply(self.port.name, "a word of the microstep table may have arrived otherwise", b"")
        return await self.read_mslut()

    async def profile(self) -> ProfileDocument:
        readable = [entry for entry in await read_profile(self) if entry.name not in _STATE]
        return ProfileDocument(readable + self._written_entries(), None, None)

    def _written_entries(self) -> list[ProfileEntry]:
        """Write-only registers that were written."""
        entries = []
        for register in self.table:
            word = self._blind.get(register.address)
            if word is None or register.access is not Access.W or register.when or register.name in ONCE:
                continue
            raw = word & register.mask
            entries.append(_entry(register, raw))
        return entries


_STATE = frozenset(
    ("XACTUAL", "XTARGET", "ENC_POS", "RESET_CLK_GATING", *(f"X_PIPE{index}" for index in range(8)), "X_HOME")
)
"""Readable and writable, but where the motor is or what happens once."""


def _entry(register: Register, raw: int) -> ProfileEntry:
    return ProfileEntry(register.name, register.axis, raw, register.decode(raw), register.unpack(raw))


__all__ = ["ONCE", "TABLE", "Tables", "is_configuration"]
