"""Reading and writing the registers of a chip: every write that can be is read back and judged.

What a family knows beyond its table (which writes act, which values change on their own) comes in
by the hooks at the end; how its words travel (datagrams of 32 or 40 bits, an evaluation board), by `access`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from functools import reduce
from operator import or_

from ...clock import Clock
from ...errors import BadReply, BenchError, UsageError, WriteRefused, WrongState
from ...links.port import FramePort
from ...links.queue import Priority, Turn
from ...links.register_access import RegisterAccess
from ...registers.model import Access, Field, Register
from .changes import outcome_of, outcome_of_failure, register_changed
from .config import DeviceConfig
from .device import Device
from .lookup import Changes, Lookup, checked_fields, modify, word_of_value
from .register_io import Words, Write, read_once_more
from .results import BatchResult, RegisterReading, RegisterWritten, WriteItem


class RegisterChip(Device):
    """A chip of which everything is a register."""

    READ_AT_ONCE = 1
    """How many registers `read_all` asks for in one turn: a stop has to wait for no more."""

    def __init__(
        self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock, access: RegisterAccess
    ) -> None:
        super().__init__(device_id, config, port, clock)
        self.access = access
        self.table = self.family.table
        self.find = Lookup(self.table, self.family.axes)

    def only_reads(self, frame: bytes) -> bool:
        return self.access.is_read(frame)

    # --- reading --------------------------------------------------------------------------------

    async def read(self, name: str, axis: int | None = None) -> RegisterReading:
        register, part = self.find(name, axis)
        if not register.access.readable:
            raise WrongState(f"{register.name} is write only")
        self.require_connected()
        word = await self._read_alone(register)
        if register.address in self._remembered:
            self._saw_word(register, word)
        shown = self._shown(register, word)
        self._delivered(register)
        return reading(register, part, shown)

    def clears_when_read(self, name: str, axis: int | None = None) -> bool:
        return self.find(name, axis)[0].read_clears

    async def read_all(self, axis: int | None = None, groups: Collection[str] = ()) -> list[RegisterReading]:
        if axis is not None:
            self.axis(axis)
        self.require_connected()
        wanted = [
            register
            for register in self.table
            if register.access.readable
            and not register.read_clears
            and not register.when  # another name of a word that is read anyway
            and (not groups or register.group in groups)
            and (axis is None or register.axis == axis)
        ]
        readings = []
        for first in range(0, len(wanted), self.READ_AT_ONCE):
            # A turn each, not one for all: 120 questions must not keep other commands waiting.
            some = wanted[first : first + self.READ_AT_ONCE]
            async with self.queue.turn(Priority.COMMAND) as turn:
                held = await self.words(turn).read_many(some)
            for register, word in zip(some, held, strict=True):
                self._saw_word(register, word)
                readings.append(reading(register, None, self._shown(register, word)))
        return readings

    async def _read_alone(self, register: Register) -> int:
        return await read_once_more(self.queue, register.address, self.access)

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
            done = await self._write(self.words(turn), register, word, changes)
        await self._after_write(register)
        return _renamed(done, part)

    async def write_many(self, items: Sequence[WriteItem]) -> BatchResult:
        await self.check_writes(items)
        done: list[RegisterWritten] = []
        for index, item in enumerate(items):
            try:
                done.append(await self.write(item.name, item.axis, item.value, item.fields))
            except BenchError as error:
                return BatchResult(done, error, len(items) - index - 1)
        return BatchResult(done, None, 0)

    async def _write(self, words: Words, register: Register, word: int, changes: Changes | None) -> RegisterWritten:
        """Write within a turn: `changes` over what the chip holds, or the whole `word`. Whoever listens is told."""
        if changes is not None and _needs_old(register, changes):
            held = await self._held(words, register)
            word = modify(register, self._as_written(register, held), changes)
            old = held if register.access.readable else self.kept_word(register)
        else:
            old = await self._old(words, register)
            word = word if changes is None else modify(register, 0, changes)
        notes = await self._before_write(words, register, word)
        try:
            done = await self._put(words, register, word, notes)
        except BenchError as error:
            outcome = outcome_of_failure(error)
            if outcome is not None:
                self._tell(register_changed(register, old, word, words.time_s, outcome))
            raise
        new = done.raw if done.verified and register.access.readable else word
        self._tell(register_changed(register, old, new, words.time_s, outcome_of(done.verified, done.note)))
        return done

    async def _put(self, words: Words, register: Register, word: int, notes: list[str]) -> RegisterWritten:
        """Send `word`, and judge what came of it."""
        arrived = await words.write(register, word)
        self._sent(register, word)
        if not register.access.readable:
            return self._written_blind(register, word, arrived, notes)
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
        return written(reading(register, None, self._shown(register, back)), word, verified, "; ".join(notes))

    def _written_blind(self, register: Register, word: int, arrived: bool, notes: Sequence[str]) -> RegisterWritten:
        """The answer to a write to a register that cannot be read."""
        if not arrived:
            raise BadReply(self.port.name, f"what was sent to {register.name} may have arrived otherwise", b"")
        return written(reading(register, None, 0), word, None, "; ".join([*notes, register.write_note]))

    async def _judge(self, words: Words, register: Register, word: int, back: int) -> tuple[bool | None, str | None]:
        """Whether the chip took `word`: (verified, note), or (False, None) where it did not and nothing explains it."""
        expected = self._expected_back(register, word)
        flags = _bits(part for part in register.fields if part.access is Access.R_W1C)
        fixed = _bits(part for part in register.fields if not part.access.writable)
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

    # --- soft limits ----------------------------------------------------------------------------

    async def words_of(self, items: Sequence[WriteItem], matters: Callable[[int], bool]) -> list[tuple[int, int]]:
        writes: dict[int, int] = {}
        found = []
        for item in items:
            register, part = self.find(item.name, item.axis)
            if not matters(register.address) or (item.value is None) == (item.fields is None):
                continue  # what cannot be at all, the write itself refuses
            fields = {part.name: item.value} if part is not None and item.value is not None else item.fields
            if fields is None:
                assert item.value is not None
                word = word_of_value(register, item.value)
            else:
                held = writes.get(register.address)
                if held is None:
                    self.require_connected()
                    async with self.queue.turn(Priority.COMMAND) as turn:
                        held = self._as_written(register, await self._held(self.words(turn), register))
                word = modify(register, held, checked_fields(register, fields))
            writes[register.address] = word
            found.append((register.address, word))
        return found

    def allow(self, writes: Sequence[Write]) -> None:
        """Raises SoftLimit before anything of `writes`, which go out together, has gone out."""
        if self.limiter is not None:
            self.limiter.check_writes((write.register.address, write.word) for write in writes)

    def remembered_word(self, address: int) -> int | None:
        """What a register is known to hold; None where nobody knows."""
        return None

    async def learn(self, registers: Sequence[Register]) -> None:
        """Read these, for `limiter`. Raises LinkError."""
        for first in range(0, len(registers), self.READ_AT_ONCE):
            some = registers[first : first + self.READ_AT_ONCE]
            async with self.queue.turn(Priority.COMMAND) as turn:
                held = await self.words(turn).read_many(some)
            for register, word in zip(some, held, strict=True):
                self._saw_word(register, word)
                if self.limiter is not None:
                    self.limiter.saw(register.address, word, register.width)

    # --- turns ----------------------------------------------------------------------------------

    def words(self, turn: Turn) -> Words:
        """The chip's words over a turn."""
        return Words(turn, self.access)

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

    def _shown(self, register: Register, word: int) -> int:
        """What the user gets to see where the chip holds `word`."""
        return word

    def _delivered(self, register: Register) -> None:
        """Somebody has asked for this register by its name, and gets it."""

    async def _before_write(self, words: Words, register: Register, word: int) -> list[str]:
        """What to tell about a write that is about to happen. Raises WrongState or WriteRefused to prevent it."""
        return []

    async def _after_write(self, register: Register) -> None:
        """A write to `register` has happened, and its turn is over."""

    async def _old(self, words: Words, register: Register) -> int | None:
        """What the chip holds before a write: asked for where that clears nothing, else as far as it is known."""
        if register.access.readable and not register.read_clears:
            return await words.read(register)
        return self.kept_word(register)

    def kept_word(self, register: Register) -> int | None:
        """What a register that cannot be read holds, as far as is known; None where nobody knows."""
        return None

    async def _held(self, words: Words, register: Register) -> int:
        """What the chip holds, before some fields of it are written."""
        return await words.read(register) if register.access.readable else 0

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
    return bool(register.write_mask & ~_bits(part for part, _ in changes))


def _bits(parts: Iterable[Field]) -> int:
    """All bits of some fields, which may overlap where they mean one thing or another."""
    return reduce(or_, (part.mask for part in parts), 0)


def reading(register: Register, part: Field | None, word: int) -> RegisterReading:
    """A word as the API tells it; with `part` that field by its own name."""
    raw = word & register.mask
    fields = register.unpack(raw) if register.fields else {}
    if part is not None:
        return RegisterReading(part.name, register.address, register.axis, raw, fields[part.name], fields, part.unit)
    return RegisterReading(
        register.name, register.address, register.axis, raw, register.decode(raw), fields, register.unit
    )


def written(back: RegisterReading, word: int, verified: bool | None, note: str) -> RegisterWritten:
    """The read-back of a write, as the API tells it."""
    return RegisterWritten(
        back.name,
        back.address,
        back.axis,
        back.raw,
        back.value,
        back.fields,
        back.unit,
        written=word,
        verified=verified,
        note=note,
    )


def _renamed(done: RegisterWritten, part: Field | None) -> RegisterWritten:
    """As the caller named it: a field asked for by its own name answers with its own value."""
    if part is not None:
        done.name, done.value, done.unit = part.name, done.fields[part.name], part.unit
    return done
