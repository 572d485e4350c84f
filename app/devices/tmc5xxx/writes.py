"""What a write by hand does besides storing a word."""

from __future__ import annotations

from collections.abc import Sequence

from ...registers.model import Register
from ..core.register_file import RegisterRules, changes_by_itself
from ..core.register_io import RegisterIO
from ..core.results import RegisterWritten
from ..core.session import Session
from ..core.unread_registers import arrived_unread
from . import roles as r
from .events import Events
from .memory import ChipMemory
from .reader import ChipReader
from .written_motion import WrittenMotion


class Writes(RegisterRules):
    """The side effects of the registers, and who has to hear of what was read and written."""

    def __init__(
        self, session: Session, memory: ChipMemory, log: Events, reader: ChipReader, motion: WrittenMotion
    ) -> None:
        self._session = session
        self._memory = memory
        self._log = log
        self._reader = reader
        self._motion = motion
        self._guessed: Register | None = None
        """The write-only register of which fields are being written over others that nobody knows."""

    # --- reading --------------------------------------------------------------------------------

    def remembers(self, register: Register) -> bool:
        return self._memory.remembers(register)

    def saw(self, register: Register, word: int) -> None:
        self._memory.saw_word(register, word)

    async def read_alone(self, register: Register) -> int | None:
        return await self._reader.read_alone(register)

    def shown(self, register: Register, word: int) -> int:
        if self._memory.overwritten(register):  # what a stop or a rotation has put there comes back with the next move
            wanted = self._memory.wanted(register)
            return word if wanted is None else wanted
        return self._log.shown(register, word)

    def delivered(self, register: Register) -> None:
        self._log.delivered(register)

    def kept_word(self, register: Register) -> int | None:
        return self._memory.wanted(register)

    # --- writing --------------------------------------------------------------------------------

    def held_unread(self, register: Register) -> int:
        held = self._memory.word(register)
        self._guessed = register if held is None else None
        return (register.reset or 0) if held is None else held

    async def before_write(self, io: RegisterIO, register: Register, word: int) -> list[str]:
        guessed, self._guessed = self._guessed, None
        notes = self._notes(register, word)
        rows = self._memory.chip.moved_by(register)
        if rows is not None:
            held = await self._motion.read_before(io, rows)
            position, target = held.value(rows.xactual), held.value(rows.xtarget)
            positioning = held.value(rows.rampmode) == r.POSITION
            if register is rows.xactual and positioning and register.decode(word) != target:
                notes.append("while positioning the motor now drives to XTARGET")
            elif register is rows.rampmode and word == r.POSITION and not positioning and target != position:
                notes.append(f"the motor now drives to XTARGET, {target}")
        elif register is self._memory.chip.gconf and await self._turns_round(io, word):
            notes.append("a motor that moves now turns the other way at once")
        if guessed is register:
            notes.append("its other fields were not known: they are as after a reset now")
        return notes

    def sent(self, register: Register, word: int) -> None:
        self._memory.sent(register, word)
        for rows in self._memory.chip.axes:
            if register.address in rows.moving and register is self._memory.chip.table.at(register.address, write=True):
                self._session.commanded(rows.axis, register.name)
        self._log.sent(register, word)
        if self._memory.chip.moved_by(register) is not None:
            self._motion.sent()

    async def explain(self, io: RegisterIO, register: Register, word: int, back: int) -> str | None:
        for rows in self._memory.chip.axes:
            if register is rows.xactual:
                velocity = await io.value(rows.vactual)
                return f"the motor moves: it is at {register.decode(back)} now" if velocity else None
        encoder = register.name == "ENCMODE" and r.part(register, "clr_once", "clr_cont").mask
        if encoder and not (word ^ back) & register.mask & ~encoder:
            return "clr_once has returned to 0 by itself"
        return changes_by_itself(register, back)

    def written_unread(self, register: Register, word: int, notes: Sequence[str]) -> RegisterWritten:
        return arrived_unread(register, word, notes)

    async def after_write(self, register: Register) -> None:
        rows = self._memory.chip.moved_by(register)
        if rows is not None:
            await self._motion.written(rows, register)

    def _notes(self, register: Register, word: int) -> list[str]:
        """What a word does by itself."""
        for rows in self._memory.chip.axes:
            if register is rows.chopconf and not r.part(register, "toff").unpack(word):
                return ["toff is 0: the driver is off"]
            if register is rows.ramp.get("VSTOP") and word < (self._memory.word(rows.ramp["VSTART"]) or 0):
                return ["VSTOP is below VSTART: a short move may not end"]
            for rate, corner in (("D1", "V1"), ("D2", "V2")):
                if register is rows.ramp.get(rate) and word == 0:
                    return [f"positioning must not have {rate} 0, even with {corner} 0"]
        return []

    async def _turns_round(self, io: RegisterIO, word: int) -> bool:
        """Whether GCONF `word` has another shaft direction than the chip's."""
        held = await io.read(self._memory.chip.gconf)
        shafts = sum(part.mask for part in self._memory.chip.gconf.fields if part.name.startswith("shaft"))
        return bool((held ^ word) & shafts)
