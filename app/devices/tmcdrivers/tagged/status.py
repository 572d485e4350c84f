"""One reading of all that such a driver tells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ....links.queue import Priority
from ....links.spi_access import TaggedAccess
from ....registers.model import Register
from ...core.register_link import RegisterLink
from .memory import TaggedMemory


@dataclass(frozen=True, slots=True)
class Status:
    """Words by address, and of which only the flags came back; device times [s]."""

    words: dict[int, int]
    hidden: frozenset[int]
    asked_s: float
    time_s: float

    def value(self, row: Register, name: str) -> int | None:
        """A field; None where the controller in between does not show it."""
        part = row.field_named(name)
        assert part is not None  # a row of ours
        return None if row.address in self.hidden and part.lsb >= 8 else part.unpack(self.words[row.address])


@dataclass(frozen=True, slots=True)
class StatusReader:
    """Asks for answers by their rows."""

    link: RegisterLink
    memory: TaggedMemory

    async def read(self, rows: Sequence[Register], priority: Priority = Priority.COMMAND) -> Status:
        """These answers in one turn. Raises LinkError; WrongState where none can be asked for yet."""
        access = self.link.access
        async with self.link.turn(priority) as turn:
            asked_s = turn.device_time_s()
            replies = await turn.exchange_many(access.read_frames([row.address for row in rows]))
            time_s = turn.last_exchange_s
        hidden: set[int] = set()
        if isinstance(access, TaggedAccess):
            words = access.words_or_flags(replies)
            hidden = {row.address for row, known in zip(rows, access.known(replies), strict=True) if not known}
        else:
            words = access.words(replies)
        return Status(
            {row.address: word for row, word in zip(rows, words, strict=True)}, frozenset(hidden), asked_s, time_s
        )

    async def read_all(self, priority: Priority = Priority.COMMAND) -> Status:
        """All that it tells."""
        rows = self.memory.rows
        return await self.read((rows.place, rows.load, rows.scale), priority)
