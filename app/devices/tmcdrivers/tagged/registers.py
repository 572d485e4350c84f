"""Registers by name, and single datagrams: written and remembered, never read back."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from ....links.spi_access import TaggedAccess
from ....registers.model import Register
from ....registers.tmcdrivers.tmc2660 import FLAGS
from ...core.raw_datagrams import RawRules
from ...core.register_file import RegisterFile, RegisterRules, reading, written
from ...core.register_io import RegisterIO
from ...core.register_link import RegisterLink
from ...core.results import RegisterReading, RegisterWritten
from ...core.unread_registers import arrived_unread
from .memory import TaggedMemory

SCALE = 2
"""RDSEL: load value and current scale; above it nothing is told."""


class TaggedRegisters(RegisterFile):
    """The same, but where no status can be asked for yet: then there is nothing to read."""

    def __init__(self, link: RegisterLink, rules: RegisterRules, memory: TaggedMemory) -> None:
        super().__init__(link, rules, 1)
        self._memory = memory

    async def read_all(self, axis: int | None = None, groups: Collection[str] = ()) -> list[RegisterReading]:
        return await super().read_all(axis, groups) if self._memory.answers else []


@dataclass(frozen=True, slots=True)
class TaggedWrites(RegisterRules):
    """What a write does besides being remembered."""

    link: RegisterLink
    memory: TaggedMemory

    def kept_word(self, register: Register) -> int | None:
        return self.memory.word(register)

    def saw(self, register: Register, word: int) -> None:
        """A status: nothing of it lasts."""

    def sent(self, register: Register, word: int) -> None:
        self.memory.sent(register, word)

    async def after_write(self, register: Register) -> None:
        """Nothing is left to be done."""

    async def before_write(self, io: RegisterIO, register: Register, word: int) -> list[str]:
        del io
        rows = self.memory.rows
        notes = []
        if register is rows.chopper and not register.unpack(word)["toff"]:
            notes.append("toff is 0: the driver is off")
        if register is rows.configuration and self.memory.takes_currents != bool(register.unpack(word)["SDOFF"]):
            notes.append("DRVCTRL means something else now: write it again")
        if self.memory.word(register) is None:
            notes.append("what it held was not known: fields that were not given are 0 now")
        return notes

    def written_unread(self, register: Register, word: int, notes: Sequence[str]) -> RegisterWritten:
        if isinstance(self.link.access, TaggedAccess):
            said = [*notes, register.write_note, "the driver answered; whether it took the word it cannot say"]
            return written(reading(register, None, word), word, None, "; ".join(filter(None, said)))
        return arrived_unread(register, word, notes)


@dataclass(frozen=True, slots=True)
class TaggedByHand(RawRules):
    """What single datagrams do."""

    memory: TaggedMemory

    def read_by_hand(self, register: Register, data: int, time_s: float) -> None:
        """A status: nothing of it lasts."""

    def known_word(self, register: Register) -> int | None:
        return self.memory.word(register)

    async def moved_by_hand(self, register: Register) -> bool:
        del register
        return False

    def answered(self, word: int) -> dict[str, int]:
        rows, selected = self.memory.rows, self.memory.field(self.memory.rows.configuration, "RDSEL")
        if selected is None or selected > SCALE:
            return {}
        row = (rows.place, rows.load, rows.scale)[selected]
        return {part.name: part.unpack(word) for part in row.fields if part.name not in FLAGS}

    def status_flags(self, status: int) -> dict[str, bool]:
        return {name: bool(status >> bit & 1) for bit, name in enumerate(FLAGS)}
