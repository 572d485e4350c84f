"""Register words over one turn of the link: frames in, numbers out."""

from __future__ import annotations

from app.links import datagram32
from app.links.datagram32 import DATA_MASK
from app.links.errors import LinkTimeout
from app.links.queue import LinkQueue, Turn
from app.registers.model import Register, to_raw

READ_FRAMES = tuple(datagram32.read(address) for address in range(128))
"""Made once: a read of one register costs no encoding."""


async def read_once_more(queue: LinkQueue, address: int) -> int:
    """The whole 32-bit reply to a read. Asked again once after no reply: a read moves nothing."""
    frame = READ_FRAMES[address]
    try:
        reply = await queue.exchange(frame)
    except LinkTimeout:
        reply = await queue.exchange(frame)
    return int.from_bytes(reply, "big")


class Words:
    """One turn's view of the chip: 24-bit data by register, and the status bits of the latest reply."""

    __slots__ = ("_turn", "status")

    def __init__(self, turn: Turn) -> None:
        self._turn = turn
        self.status = 0

    @property
    def time_s(self) -> float:
        """Device time of the latest exchange [s]."""
        return self._turn.last_exchange_s

    async def read(self, register: Register) -> int:
        """24 data bits, as they came. Asked again once after LinkTimeout."""
        frame = READ_FRAMES[register.address]
        try:
            reply = await self._turn.exchange(frame)
        except LinkTimeout:
            reply = await self._turn.exchange(frame)
        word = int.from_bytes(reply, "big")
        self.status = word >> 24
        return word & DATA_MASK

    async def value(self, register: Register) -> int:
        """The register's value, signed where it is."""
        return register.decode(await self.read(register))

    async def write(self, register: Register, word: int) -> None:
        """Send raw bits once. Never again: it may have happened although no reply came."""
        reply = await self._turn.exchange(datagram32.write(register.address, word))
        self.status = reply[0]

    async def put(self, register: Register, value: int) -> None:
        """Send a value that is in the register's range."""
        await self.write(register, to_raw(value, register.width))
