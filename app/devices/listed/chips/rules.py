"""What the registers of such a chip are known to do: nothing but what their names say of a ramp generator.

A write is read back like any other. Where no source tells whether a register can be read, a difference proves nothing:
then the answer says what it reads as, and what was written counts for the other fields of the register.
"""

from __future__ import annotations

from collections.abc import Sequence

from ....links.spi_access import SpiAccess, TaggedAccess
from ....registers.model import Access, Register
from ...core.raw_datagrams import RawRules
from ...core.register_file import RegisterRules, changes_by_itself, reading, written
from ...core.register_io import RegisterIO
from ...core.register_link import RegisterLink
from ...core.results import RegisterWritten
from ...core.session import Session
from ...core.unread_registers import arrived_unread
from .ongoing import ChipMotions
from .state import ChipState


class ChipRegisters(RegisterRules, RawRules):
    """Of registers by name, and of single frames."""

    def __init__(self, session: Session, link: RegisterLink, state: ChipState, motions: ChipMotions) -> None:
        self._session = session
        self._link = link
        self._state = state
        self._motions = motions

    # --- reading --------------------------------------------------------------------------------

    def remembers(self, register: Register) -> bool:
        return True

    def saw(self, register: Register, word: int) -> None:
        self._state.saw(register, word)

    def may_read(self, register: Register) -> bool:
        return register.access.readable and not register.read_clears

    async def read_alone(self, register: Register) -> int | None:
        """What reading may clear is never asked twice: the answer may be all that was lost."""
        if not register.read_clears:
            return None
        async with self._session.queue.turn() as turn:
            replies = await turn.exchange_many(self._link.access.read_frames((register.address,)))
        return self._link.access.words(replies)[0]

    def kept_word(self, register: Register) -> int | None:
        return self._state.unread(register)

    # --- writing --------------------------------------------------------------------------------

    def as_written(self, register: Register, held: int) -> int:
        hidden = self._state.unread(register)
        return held if hidden is None else hidden

    def sent(self, register: Register, word: int) -> None:
        self._state.sent(register, word)
        ramp = self._state.ramp_of(register)
        if ramp is not None:
            self._session.commanded(ramp.axis, register.name)

    async def explain(self, io: RegisterIO, register: Register, word: int, back: int) -> str | None:
        if register.volatile:
            return changes_by_itself(register, back)
        if register.access is not Access.UNKNOWN:
            return None
        self._state.hides(register, back)
        return (
            f"it reads {back & register.mask:#x}: whether it can be read, or written, is not known; what was written "
            "is taken for what it holds"
        )

    def written_unread(self, register: Register, word: int, notes: Sequence[str]) -> RegisterWritten:
        if register.read_clears:
            notes = [*notes, "not read back: reading it may clear it"]
        if isinstance(self._link.access, SpiAccess | TaggedAccess):
            said = [*notes, register.write_note, "nothing shows whether it arrived"]
            return written(reading(register, None, word), word, None, "; ".join(filter(None, said)))
        return arrived_unread(register, word, notes)

    async def settle(self, io: RegisterIO, register: Register, *, read_back: bool) -> None:
        ramp = self._state.ramp_of(register)
        if ramp is not None:
            self._motions.written(ramp, register, io.time_s)

    async def after_write(self, register: Register) -> None:
        """Nothing is left to be done."""

    # --- by hand --------------------------------------------------------------------------------

    def behind(self, frame: bytes, register: Register) -> bytes | None:
        # What a reading may clear is asked for once, and something harmless brings the answer.
        return self._link.access.read_frames((register.address,))[-1] if register.read_clears else frame

    def read_by_hand(self, register: Register, data: int, time_s: float) -> None:
        self._state.saw(register, data)

    def known_word(self, register: Register) -> int | None:
        return self._state.word(register)

    async def moved_by_hand(self, register: Register) -> bool:
        ramp = self._state.ramp_of(register)
        if ramp is None:
            return False
        self._motions.written(ramp, register, self._session.port.last_exchange_s)
        return True

    def status_flags(self, status: int) -> dict[str, bool]:
        """None: what the bits of the status byte mean no table tells."""
        del status
        return {}
