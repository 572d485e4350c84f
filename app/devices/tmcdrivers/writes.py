"""What a write by hand does besides storing a word, and what single datagrams do."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...errors import WrongState
from ...links import datagram40
from ...registers.model import Register
from ..core.raw_datagrams import RawRules
from ..core.register_file import RegisterRules
from ..core.register_io import RegisterIO
from ..core.register_link import RegisterLink
from ..core.results import RegisterWritten
from ..core.unread_registers import arrived_unread
from .memory import DriverMemory
from .resets import Resets
from .roles import part

BURNS = "this burns a bit into the chip's memory, which nobody can take back: it is not written by name"
BY_HAND = "if you mean it, send the datagram by hand (page Console); nothing else of the chip needs it"
STATUS = ("reset_flag", "driver_error", "sg2", "standstill")
"""Bits of the SPI status byte, from the lowest."""


@dataclass(frozen=True, slots=True)
class Writes(RegisterRules):
    """The side effects of the registers, and who has to hear of what was read and written."""

    link: RegisterLink
    memory: DriverMemory
    resets: Resets

    def remembers(self, register: Register) -> bool:
        return self.memory.remembers(register)

    def saw(self, register: Register, word: int) -> None:
        self.memory.saw_word(register, word)

    def shown(self, register: Register, word: int) -> int:
        return self.resets.shown(register, word)

    def delivered(self, register: Register) -> None:
        self.resets.delivered(register)

    async def read_alone(self, register: Register) -> int | None:
        if not register.read_clears:
            return None
        # Never asked twice: the answer may be all that was lost.
        async with self.link.turn() as turn:
            replies = await turn.exchange_many(self.link.access.read_frames((register.address,)))
        word = self.link.access.words(replies)[0]
        self.resets.heard(word)
        return word

    def kept_word(self, register: Register) -> int | None:
        return self.memory.word(register)

    def held_unread(self, register: Register) -> int:
        held = self.memory.word(register)
        return (register.reset or 0) if held is None else held

    async def before_write(self, io: RegisterIO, register: Register, word: int) -> list[str]:
        del io
        rows = self.memory.rows
        notes = []
        burns = register.field_named("OTPMAGIC")
        if burns is not None and burns.unpack(word) in burns.values:
            raise WrongState(BURNS, BY_HAND)
        if register is rows.vactual and register.decode(word):
            notes.append("the motor turns at once, without a ramp, and no more by STEP")
        if register is rows.chopconf and not part(register, "toff").unpack(word):
            notes.append("toff is 0: the driver is off")
        if not register.access.readable and register.fields and self.memory.word(register) is None:
            notes.append("what it held was not known: fields that were not given are as after a reset now")
        return notes

    def sent(self, register: Register, word: int) -> None:
        self.memory.sent(register, word)
        self.resets.sent(register, word)
        if register is self.memory.rows.vactual:
            self.link.session.commanded(0, register.name)

    async def after_write(self, register: Register) -> None:
        """Nothing is expected of a motor that nobody predicts."""

    def written_unread(self, register: Register, word: int, notes: Sequence[str]) -> RegisterWritten:
        return arrived_unread(register, word, notes)


@dataclass(frozen=True, slots=True)
class DatagramsByHand(RawRules):
    """What single datagrams do to the chip."""

    memory: DriverMemory
    resets: Resets

    def behind(self, frame: bytes, register: Register) -> bytes | None:
        # What a reading clears is asked for once, and something harmless brings the answer.
        return datagram40.fetch_of(self.memory.rows.model.name) if register.read_clears else frame

    def read_by_hand(self, register: Register, data: int, time_s: float) -> None:
        del time_s
        if register.read_clears:
            self.resets.heard(data)
        self.memory.saw_word(register, data)

    def known_word(self, register: Register) -> int | None:
        return self.memory.word(register)

    async def moved_by_hand(self, register: Register) -> bool:
        return register is self.memory.rows.vactual

    def status_flags(self, status: int) -> dict[str, bool]:
        return {name: bool(status >> bit & 1) for bit, name in enumerate(STATUS)}
