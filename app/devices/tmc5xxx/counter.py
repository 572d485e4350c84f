"""The position counter, and what is compared with it or latches it."""

from __future__ import annotations

from ..core.capabilities import PositionCounter
from ..core.counter import CounterReading
from ..core.register_link import RegisterLink
from ..core.session import Session
from .events import Events
from .memory import ChipMemory
from .reader import ChipReader

BITS = 32


class Counter(PositionCounter):
    """XACTUAL, with GSTAT behind it."""

    def __init__(
        self, session: Session, link: RegisterLink, memory: ChipMemory, log: Events, reader: ChipReader
    ) -> None:
        self.session = session
        self.link = link
        self.memory = memory
        self.log = log
        self.reader = reader
        self._seen_at_reset = [0] * len(session.axes)
        """How many resets had been seen at the latest `look` at each axis."""

    def counter_bits(self, axis: int) -> int | None:
        self.session.axis(axis)
        return BITS

    async def poll(self, axis: int) -> CounterReading:
        """The counter, then GSTAT, in one chain; a reset is told once, and stays to be read by its name."""
        rows = self.memory.rows(self.session.axis(axis).index)
        self.session.require_connected()
        asked = (rows.xactual, *(() if rows.x_enc is None else (rows.x_enc,)), rows.vactual)
        async with self.session.queue.turn() as turn:
            io = self.link.io(turn)
            held = await self.reader.poll(io, [axis], asked)
            asked_at_s = io.asked_s
        before, self._seen_at_reset[axis] = self._seen_at_reset[axis], self.log.resets
        return CounterReading(held.value(rows.xactual), asked_at_s, self.log.resets > before)

    def latch_register(self, axis: int) -> str | None:
        return self.link.table.get("XLATCH", self.session.axis(axis).index).name

    def compare_register(self, axis: int) -> str | None:
        found = self.memory.rows(self.session.axis(axis).index).find("X_COMPARE")
        return None if found is None or found.axis != axis else found.name
