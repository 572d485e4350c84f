"""Register words over one turn of the link: frames in, numbers out, whatever carries them (`RegisterAccess`)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...errors import BadReply, LinkTimeout
from ...links.access32 import SPI32
from ...links.queue import LinkQueue, Turn
from ...links.register_access import RegisterAccess
from ...registers.model import Register, to_raw


@dataclass(frozen=True, slots=True)
class Write:
    """One write of a chain."""

    register: Register
    word: int


Step = Write | Sequence[Register]
"""A write, or registers to read."""


async def read_once_more(queue: LinkQueue, address: int, access: RegisterAccess = SPI32) -> int:
    """One word. Asked again once after no reply: a read moves nothing."""
    frames = access.read_frames((address,))
    try:
        replies = await queue.exchange_many(frames)
    except LinkTimeout:
        replies = await queue.exchange_many(frames)
    return access.words(replies)[0]


class Snapshot:
    """Registers as they were read together."""

    __slots__ = ("registers", "words")

    def __init__(self, registers: Sequence[Register], words: Sequence[int]) -> None:
        self.registers = registers
        self.words = {register.address: word for register, word in zip(registers, words, strict=True)}
        """By address."""

    def word(self, register: Register) -> int:
        """The bits as they came."""
        return self.words[register.address]

    def value(self, register: Register) -> int:
        """The register's value, signed where it is."""
        return register.decode(self.words[register.address])

    def fields(self, register: Register) -> dict[str, int]:
        """Every field's value by name."""
        return register.unpack(self.words[register.address])


class RegisterIO:
    """Register reads and writes over one turn: words by register, and the status bits of the latest reply."""

    __slots__ = ("_access", "_turn", "arrived", "asked_s", "first_status", "status")

    def __init__(self, turn: Turn, access: RegisterAccess = SPI32) -> None:
        self._turn = turn
        self._access = access
        self.status = 0
        """Of the latest reply; stays 0 over a link that brings none."""
        self.first_status: int | None = None
        """Of the first reply of the latest call, before anything that call has done; None over a link without."""
        self.arrived = True
        """Whether the link showed no difference between what the latest `chain` wrote and what arrived."""
        self.asked_s = 0.0
        """Before which device time no register of the latest reading was read [s]."""

    @property
    def time_s(self) -> float:
        """Device time of the latest exchange [s]."""
        return self._turn.last_exchange_s

    async def read(self, register: Register) -> int:
        """All data bits, as they came. Asked again once after LinkTimeout."""
        return (await self.read_many((register,)))[0]

    async def read_many(self, registers: Sequence[Register]) -> list[int]:
        """Words of several registers, over a pipelined link in one chain. Asked again once after LinkTimeout."""
        frames = self._access.read_frames([register.address for register in registers])
        self.asked_s = self._turn.device_time_s()
        try:
            replies = await self._turn.exchange_many(frames)
        except LinkTimeout:
            self.asked_s = self._turn.device_time_s()
            replies = await self._turn.exchange_many(frames)
        self._saw_status(replies)
        return self._access.words(replies)

    async def value(self, register: Register) -> int:
        """The register's value, signed where it is."""
        return register.decode(await self.read(register))

    async def values(self, registers: Sequence[Register]) -> list[int]:
        """Values of several registers."""
        words = await self.read_many(registers)
        return [register.decode(word) for register, word in zip(registers, words, strict=True)]

    async def write(self, register: Register, word: int) -> bool:
        """Send raw bits once: `write_many`."""
        return await self.write_many(((register, word),))

    async def write_many(self, writes: Sequence[tuple[Register, int]]) -> bool:
        """Send raw bits, each once and in this order. Never again: it may have happened although no reply came.

        Returns whether the link showed no difference between what was sent and what arrived. That is no
        proof where it does not show what arrived (32-bit datagrams), and no proof of a failure either: the
        answer may be all that was garbled. Reading back tells.
        """
        frames = self._access.write_frames([(register.address, word) for register, word in writes])
        replies = await self._turn.exchange_many(frames)
        self._saw_status(replies)
        try:
            self._access.check_all(frames, replies)
        except BadReply:
            return False
        return True

    async def chain(self, *steps: Step, again: bool = False) -> list[list[int]]:
        """Readings and writes in their order, over a pipelined link in one go: words of each reading.

        With `again` all of it is sent once more after LinkTimeout: for writes that may happen twice. Whether
        writes arrived a reading behind them tells, and `arrived` of those that cannot be read.
        """
        frames: list[bytes] = []
        spans: list[tuple[int, int]] = []
        for step in steps:
            first = len(frames)
            if isinstance(step, Write):
                frames.append(self._access.write_frame(step.register.address, step.word))
            else:
                frames += self._access.read_frames([register.address for register in step])
                spans.append((first, len(frames)))
        self.asked_s = self._turn.device_time_s()
        try:
            replies = await self._turn.exchange_many(frames)
        except LinkTimeout:
            if not again:
                raise
            replies = await self._turn.exchange_many(frames)
        self._saw_status(replies)
        try:
            self._access.check_all(frames, replies)
        except BadReply:
            self.arrived = False
        else:
            self.arrived = True
        return [self._access.words(replies[first:last]) for first, last in spans]

    async def put(self, register: Register, value: int) -> None:
        """Send a value that is in the register's range."""
        await self.write(register, to_raw(value, register.width))

    def _saw_status(self, replies: Sequence[bytes]) -> None:
        self.first_status = self._access.status(replies[:1])
        status = self._access.status(replies)
        if status is not None:
            self.status = status
