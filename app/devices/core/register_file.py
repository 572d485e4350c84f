"""Reading and writing the registers of a chip: every write that can be is read back and judged.

What a family knows beyond its table (which writes act, which values change on their own) it says by its
`RegisterRules`; how words travel (datagrams of 32 or 40 bits, an evaluation board) is in `RegisterLink`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import replace
from functools import reduce
from operator import or_
from typing import Protocol

from ...errors import BadReply, BenchError, UsageError, WriteRefused, WrongState
from ...registers.model import Access, Field, Register
from .capabilities import Registers
from .changes import outcome_of, outcome_of_failure, register_changed
from .lookup import Changes, Lookup, checked_fields, modify, word_of_value
from .register_io import RegisterIO
from .register_link import RegisterLink
from .results import RegisterReading, RegisterWritten, WriteItem

READ_AT_ONCE = 16
"""How many registers one turn may ask for where they travel in one chain."""


class RegisterRules(Protocol):
    """What a family knows of its registers beyond the table. What is not overridden is so for a plain register."""

    def remembers(self, register: Register) -> bool:
        """Whether `saw` wants to hear of every word of this register."""
        del register
        return False

    def saw(self, register: Register, word: int) -> None:
        """The chip was seen to hold `word`."""

    def sent(self, register: Register, word: int) -> None:
        """`word` was sent to `register` by the user."""

    def shown(self, register: Register, word: int) -> int:
        """What the user gets to see where the chip holds `word`."""
        del register
        return word

    def delivered(self, register: Register) -> None:
        """A caller has asked for this register by its name, and gets it."""
        del register

    async def read_alone(self, register: Register) -> int | None:
        """The word of a register that is read in a way of its own; None for the ordinary way. Raises LinkError."""
        del register
        return None

    async def before_write(self, io: RegisterIO, register: Register, word: int) -> list[str]:
        """What to tell about a write that is about to happen. Raises WrongState or WriteRefused to prevent it."""
        del io, register, word
        return []

    async def settle(self, io: RegisterIO, register: Register, *, read_back: bool) -> None:
        """Find out, within the turn of a write to `register`, what the axis does now. With `read_back` it has just been
        seen what the register holds. The write is done and judged: raises nothing."""
        del io, register, read_back

    async def after_write(self, register: Register) -> None:
        """A write to `register` has happened, and its turn is over."""

    def may_read(self, register: Register) -> bool:
        """Whether a write may read it: before, to change some fields of it, and after, to see what came of it."""
        return register.access.readable

    def kept_word(self, register: Register) -> int | None:
        """What a register that cannot be read holds, as far as is known; None where nobody knows."""
        del register
        return None

    def held_unread(self, register: Register) -> int:
        """What fields are written over in a register that cannot be read."""
        kept = self.kept_word(register)
        return 0 if kept is None else kept

    def as_written(self, register: Register, held: int) -> int:
        """The word that, written, would make the chip hold `held`."""
        del register
        return held

    def expected_back(self, register: Register, word: int) -> int:
        """What a read gives after `word` was written."""
        del register
        return word

    async def explain(self, io: RegisterIO, register: Register, word: int, back: int) -> str | None:
        """Why `back` differs from `word` though the chip took the write; None where nothing explains it."""
        del io, word
        return changes_by_itself(register, back)

    def written_unread(self, register: Register, word: int, notes: Sequence[str]) -> RegisterWritten:
        """The answer to a write that arrived as far as the link shows, to a register that cannot be read."""
        return written(reading(register, None, 0), word, None, "; ".join([*notes, register.write_note]))


def changes_by_itself(register: Register, back: int) -> str | None:
    """What explains any difference in a register that the chip changes; None for others."""
    if not register.volatile:
        return None
    return f"the chip changes this register by itself; it holds {register.decode(back)} now"


class RegisterFile(Registers):
    """The registers of a chip, by name.

    read_at_once : how many registers `read_all` asks for in one turn: a stop has to wait for no more
    """

    def __init__(self, link: RegisterLink, rules: RegisterRules, axes: int, read_at_once: int = 1) -> None:
        self.link = link
        self.find = Lookup(link.table, axes)
        self.read_at_once = read_at_once
        self._session = link.session
        self._rules = rules

    # --- reading --------------------------------------------------------------------------------

    async def read(self, name: str, axis: int | None = None) -> RegisterReading:
        register, part = self.find(name, axis)
        if not register.access.readable:
            raise WrongState(f"{register.name} is write only")
        self._session.require_connected()
        word = await self._rules.read_alone(register)
        if word is None:
            word = await self.link.read_once(register)
        if self._rules.remembers(register):
            self._rules.saw(register, word)
        shown = self._rules.shown(register, word)
        self._rules.delivered(register)
        return reading(register, part, shown)

    def clears_when_read(self, name: str, axis: int | None = None) -> bool:
        return self.find(name, axis)[0].read_clears

    async def read_all(self, axis: int | None = None, groups: Collection[str] = ()) -> list[RegisterReading]:
        if axis is not None:
            self._session.axis(axis)
        self._session.require_connected()
        wanted = [
            register
            for register in self.link.table
            if register.access.readable
            and not register.read_clears
            and not register.when  # another name of a word that is read anyway
            and (not groups or register.group in groups)
            and (axis is None or register.axis == axis)
        ]
        readings = []
        for first in range(0, len(wanted), self.read_at_once):
            # A turn each, not one for all: 120 questions must not keep other commands waiting.
            some = wanted[first : first + self.read_at_once]
            async with self.link.turn() as turn:
                held = await self.link.io(turn).read_many(some)
            for register, word in zip(some, held, strict=True):
                self._rules.saw(register, word)
                readings.append(reading(register, None, self._rules.shown(register, word)))
        return readings

    def kept(self, axis: int | None = None, groups: Collection[str] = ()) -> list[RegisterReading]:
        found = []
        for register in self.link.table:
            if register.access.readable or (groups and register.group not in groups):
                continue
            word = self._rules.kept_word(register) if axis is None or register.axis == axis else None
            if word is not None:
                found.append(replace(reading(register, None, word), kept=True))
        return found

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
        self._session.require_connected()
        async with self.link.command(register.axis) as turn:
            io = self.link.io(turn)
            done = await self._write(io, register, word, changes)
            await self._rules.settle(io, register, read_back=self._rules.may_read(register))
        await self._rules.after_write(register)
        return _renamed(done, part)

    async def _write(self, io: RegisterIO, register: Register, word: int, changes: Changes | None) -> RegisterWritten:
        """Write within a turn: `changes` over what the chip holds, or the whole `word`. Whoever listens is told."""
        if changes is not None and _needs_old(register, changes):
            held = await self._held(io, register)
            word = modify(register, self._rules.as_written(register, held), changes)
            old = held if self._rules.may_read(register) else self._rules.kept_word(register)
        else:
            old = await self._old(io, register)
            word = word if changes is None else modify(register, 0, changes)
        notes = await self._rules.before_write(io, register, word)
        try:
            done = await self._put(io, register, word, notes)
        except BenchError as error:
            outcome = outcome_of_failure(error)
            if outcome is not None:
                self._session.tell(register_changed(register, old, word, io.time_s, outcome))
            raise
        new = done.raw if done.verified and self._rules.may_read(register) else word
        self._session.tell(register_changed(register, old, new, io.time_s, outcome_of(done.verified, done.note)))
        return done

    async def _put(self, io: RegisterIO, register: Register, word: int, notes: list[str]) -> RegisterWritten:
        """Send `word`, and judge what came of it."""
        arrived = await io.write(register, word)
        self._rules.sent(register, word)
        if not self._rules.may_read(register):
            if not arrived:
                raise BadReply(
                    self._session.port.name, f"what was sent to {register.name} may have arrived otherwise", b""
                )
            return self._rules.written_unread(register, word, notes)
        back = await io.read(register)
        verified, note = await self._judge(io, register, word, back)
        if note is None:
            # One flipped bit on the way back looks like a refused write. Asking again moves nothing.
            back = await io.read(register)
            verified, note = await self._judge(io, register, word, back)
            if note is None:
                self._rules.saw(register, back)
                raise WriteRefused(register.name, word, back & register.mask, register.write_note)
            notes.append("the first read-back differed, the second did not")
        self._rules.saw(register, back)
        if note:
            notes.append(note)
        return written(reading(register, None, self._rules.shown(register, back)), word, verified, "; ".join(notes))

    async def _judge(self, io: RegisterIO, register: Register, word: int, back: int) -> tuple[bool | None, str | None]:
        """Whether the chip took `word`: (verified, note), or (False, None) where it did not and nothing explains it."""
        expected = self._rules.expected_back(register, word)
        flags = _bits(part for part in register.fields if part.access is Access.R_W1C)
        fixed = _bits(part for part in register.fields if not part.access.writable)
        differs = (expected ^ back) & register.mask & ~flags & ~fixed
        if differs:
            explained = await self._rules.explain(io, register, word, back)
            return (None, explained) if explained is not None else (False, None)
        again = [part.name for part in register.fields if part.access is Access.R_W1C and word & back & part.mask]
        if again:
            return None, f"{', '.join(again)} came up again"
        kept = [part.name for part in register.fields if not part.access.writable and (word ^ back) & part.mask]
        if kept and word & fixed:
            return True, f"{', '.join(kept)}: read only, not changed"
        return True, ""

    # --- soft limits ----------------------------------------------------------------------------

    async def check_writes(self, items: Sequence[WriteItem]) -> None:
        limiter = self._session.limiter
        if limiter is not None:
            limiter.check_writes(await self._words_of(items, limiter.affects_limits))

    async def _words_of(
        self, items: Sequence[WriteItem], affects_limits: Callable[[int], bool]
    ) -> list[tuple[int, int]]:
        """(address, word) that these writes would send, of what matters to limits; what they change is read."""
        writes: dict[int, int] = {}
        found = []
        for item in items:
            register, part = self.find(item.name, item.axis)
            if not affects_limits(register.address) or (item.value is None) == (item.fields is None):
                continue  # what cannot be at all, the write itself refuses
            fields = {part.name: item.value} if part is not None and item.value is not None else item.fields
            if fields is None:
                assert item.value is not None
                word = word_of_value(register, item.value)
            else:
                held = writes.get(register.address)
                if held is None:
                    self._session.require_connected()
                    async with self.link.turn() as turn:
                        held = self._rules.as_written(register, await self._held(self.link.io(turn), register))
                word = modify(register, held, checked_fields(register, fields))
            writes[register.address] = word
            found.append((register.address, word))
        return found

    async def learn(self, registers: Sequence[Register]) -> None:
        """Read these, for the soft limits. Raises LinkError."""
        for first in range(0, len(registers), self.read_at_once):
            some = registers[first : first + self.read_at_once]
            async with self.link.turn() as turn:
                held = await self.link.io(turn).read_many(some)
            for register, word in zip(some, held, strict=True):
                self._rules.saw(register, word)
                if self._session.limiter is not None:
                    self._session.limiter.saw(register.address, word, register.width)

    # --- inside ---------------------------------------------------------------------------------

    async def _old(self, io: RegisterIO, register: Register) -> int | None:
        """What the chip holds before a write: asked for where that clears nothing, else as far as it is known."""
        if register.access.readable and not register.read_clears:
            return await io.read(register)
        return self._rules.kept_word(register)

    async def _held(self, io: RegisterIO, register: Register) -> int:
        """What the chip holds, before some fields of it are written."""
        return await io.read(register) if self._rules.may_read(register) else self._rules.held_unread(register)


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
