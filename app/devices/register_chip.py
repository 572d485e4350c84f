"""Reading and writing the registers of a 32-bit register chip: every write is read back and judged.

What a family knows beyond its table (which writes act, which values change on their own) comes in
by the three hooks at the end.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from app.clock import Clock
from app.devices.config import DeviceConfig
from app.devices.device import Device
from app.devices.lookup import Changes, Lookup, checked_fields, modify, word_of_value
from app.devices.results import BatchResult, RawExchange, RegisterReading, RegisterWritten, WriteItem
from app.devices.words import Words, read_once_more
from app.links.datagram32 import DATA_MASK, FRAME_BYTES, Request, status_flags
from app.links.errors import BenchError, OutOfRange, UsageError, WriteRefused, WrongState
from app.links.port import FramePort
from app.links.queue import Priority, Turn
from app.registers.model import Access, Field, Register


class RegisterChip(Device):
    """A chip of which everything is a register of 24 bits behind 4-byte datagrams."""

    status_names: tuple[str, ...]
    """Names of the status bits of each reply, bit 0 first, "" where unused."""

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> None:
        super().__init__(device_id, config, port, clock)
        self.table = self.family.table
        self.find = Lookup(self.table, self.family.axes)

    # --- reading --------------------------------------------------------------------------------

    async def read(self, name: str, axis: int | None = None) -> RegisterReading:
        register, part = self.find(name, axis)
        if not register.access.readable:
            raise WrongState(f"{register.name} is write only")
        self.require_connected()
        word = await read_once_more(self.queue, register.address) & DATA_MASK
        if register.address in self._remembered:
            self._saw_word(register, word)
        return _reading(register, part, word)

    async def read_all(self, axis: int | None = None, groups: Collection[str] = ()) -> list[RegisterReading]:
        if axis is not None:
            self.axis(axis)
        self.require_connected()
        readings = []
        for register in self.table:
            if not register.access.readable or (groups and register.group not in groups):
                continue
            if axis is None or register.axis == axis:
                # A turn each, not one for all: 120 questions must not keep other commands waiting.
                word = await read_once_more(self.queue, register.address) & DATA_MASK
                self._saw_word(register, word)
                readings.append(_reading(register, None, word))
        return readings

    # --- writing --------------------------------------------------------------------------------

    async def write(
        self,
        name: str,
        axis: int | None = None,
        value: int | None = None,
        fields: dict[str, int | str] | None = None,
    ) -> RegisterWritten:
        register, part = self.find(name, axis)
        changes: Changes | None = None
        word = 0
        if (value is None) == (fields is None):
            raise UsageError("give either a value or fields")
        if fields is not None:
            changes = checked_fields(register, fields)
        elif part is not None and value is not None:
            changes = checked_fields(register, {part.name: value})
        elif value is not None:
            word = word_of_value(register, value)
        self.require_connected()
        async with self._command(register.axis) as turn:
            words = Words(turn)
            written = await self._write(words, register, word, changes)
        await self._after_write(register)
        return _renamed(written, part)

    async def write_many(self, items: Sequence[WriteItem]) -> BatchResult:
        done: list[RegisterWritten] = []
        for index, item in enumerate(items):
            try:
                done.append(await self.write(item.name, item.axis, item.value, item.fields))
            except BenchError as error:
                return BatchResult(done, error, len(items) - index - 1)
        return BatchResult(done, None, 0)

    async def _write(self, words: Words, register: Register, word: int, changes: Changes | None) -> RegisterWritten:
        """Write within a turn: `changes` over what the chip holds, or the whole `word`."""
        if changes is not None:
            held = await words.read(register) if _needs_old(register, changes) else 0
            word = modify(register, self._as_written(register, held), changes)
        notes = await self._before_write(words, register, word)
        await words.write(register, word)
        self._sent(register, word)
        if not register.access.readable:
            reading = _reading(register, None, 0)
            return _written(reading, word, None, "; ".join([*notes, register.write_note]))
        back = await words.read(register)
        verified, note = await self._judge(words, register, word, back)
        if note is None:
            # One flipped bit on the way back looks like a refused write. Asking again moves nothing.
            back = await words.read(register)
            verified, note = await self._judge(words, register, word, back)
            if note is None:
                self._saw_word(register, back)
                raise WriteRefused(register.name, word, back & register.mask, register.write_note)
            notes.append("the first read-back differed, the second did not")
        self._saw_word(register, back)
        if note:
            notes.append(note)
        return _written(_reading(register, None, back), word, verified, "; ".join(notes))

    async def _judge(self, words: Words, register: Register, word: int, back: int) -> tuple[bool | None, str | None]:
        """Whether the chip took `word`: (verified, note), or (False, None) where it did not and nothing explains it."""
        expected = self._expected_back(register, word)
        flags = sum(part.mask for part in register.fields if part.access is Access.R_W1C)
        fixed = sum(part.mask for part in register.fields if not part.access.writable)
        differs = (expected ^ back) & register.mask & ~flags & ~fixed
        if differs:
            explained = await self._explain(words, register, word, back)
            return (None, explained) if explained is not None else (False, None)
        again = [part.name for part in register.fields if part.access is Access.R_W1C and word & back & part.mask]
        if again:
            return None, f"{', '.join(again)} came up again"
        kept = [part.name for part in register.fields if not part.access.writable and (word ^ back) & part.mask]
        if kept and word & fixed:
            return True, f"{', '.join(kept)}: read only, not changed"
        return True, ""

    # --- raw ------------------------------------------------------------------------------------

    async def exchange(self, frame: bytes) -> RawExchange:
        if len(frame) != FRAME_BYTES:
            raise OutOfRange("frame length", len(frame), FRAME_BYTES, FRAME_BYTES, "bytes")
        self.require_connected()
        request = Request.decode(frame)
        register = self.table.at(request.address)
        async with self._command(register.axis if register and not request.read else None) as turn:
            reply = await turn.exchange(frame)
        status, data = reply[0], int.from_bytes(reply[1:], "big")
        if register is not None:
            if request.read:
                self._saw_word(register, data)
            else:
                self._sent(register, request.data)
                await self._after_write(register)
        shown = data if request.read else request.data
        return RawExchange(
            reply,
            {
                "address": request.address,
                "register": register.name if register else None,
                "axis": register.axis if register else None,
                "rw": "read" if request.read else "write",
                "data": data,
                "value": register.decode(shown) if register else None,
                "fields": register.unpack(shown) if register else {},
                "status": status,
                "flags": status_flags(status, self.status_names),
            },
        )

    # --- turns ----------------------------------------------------------------------------------

    def _command(self, axis: int | None) -> Turn:
        """A turn for a command; one that touches an axis gives up when a stop of that axis overtakes it."""
        return self.queue.turn(Priority.COMMAND, None if axis is None else self.stop_guard([axis]))

    # --- what a family adds ---------------------------------------------------------------------

    _remembered: frozenset[int] = frozenset()
    """Addresses of registers whose words `_saw_word` wants to see."""

    def _saw_word(self, register: Register, word: int) -> None:
        """The chip was seen to hold `word`."""

    def _sent(self, register: Register, word: int) -> None:
        """`word` went out to `register`."""

    async def _before_write(self, words: Words, register: Register, word: int) -> list[str]:
        """What to tell about a write that is about to happen. Raises WrongState or WriteRefused to prevent it."""
        return []

    async def _after_write(self, register: Register) -> None:
        """A write to `register` has happened, and its turn is over."""

    def _as_written(self, register: Register, held: int) -> int:
        """The word that, written, would make the chip hold `held`."""
        return held

    def _expected_back(self, register: Register, word: int) -> int:
        """What a read gives after `word` was written."""
        return word

    async def _explain(self, words: Words, register: Register, word: int, back: int) -> str | None:
        """Why `back` differs from `word` though the chip took the write; None where nothing explains it."""
        if not register.volatile:
            return None
        return f"the chip changes this register by itself; it holds {register.decode(back)} now"


def _needs_old(register: Register, changes: Changes) -> bool:
    given = sum(part.mask for part, _ in changes)
    return bool(register.write_mask & ~given)


def _reading(register: Register, part: Field | None, word: int) -> RegisterReading:
    raw = word & register.mask
    fields = register.unpack(raw) if register.fields else {}
    if part is not None:
        return RegisterReading(part.name, register.address, register.axis, raw, fields[part.name], fields, part.unit)
    return RegisterReading(
        register.name, register.address, register.axis, raw, register.decode(raw), fields, register.unit
    )


def _written(reading: RegisterReading, word: int, verified: bool | None, note: str) -> RegisterWritten:
    return RegisterWritten(
        reading.name,
        reading.address,
        reading.axis,
        reading.raw,
        reading.value,
        reading.fields,
        reading.unit,
        written=word,
        verified=verified,
        note=note,
    )


def _renamed(written: RegisterWritten, part: Field | None) -> RegisterWritten:
    """As the caller named it: a field asked for by its own name answers with its own value."""
    if part is not None:
        written.name, written.value, written.unit = part.name, written.fields[part.name], part.unit
    return written
