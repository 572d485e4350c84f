"""A chip as far as it was seen and written through this connection. Nothing here asks it anything."""

from __future__ import annotations

from ....calc.units.mechanics import Mechanics
from ....errors import BenchError
from ....registers.listed.ramp import Ramp, ramps_of
from ....registers.model import Access, Register, RegisterTable
from ...core.results import DeviceState
from ...core.session import Session


class ChipState:
    """Words by register: as read, and as written where a reading does not show them.

    A register of which no source tells whether it can be read is taken for one that can, until a reading after a write
    shows another word than was written: from then on what was written counts, as long as the reading stays the same.
    """

    def __init__(self, session: Session, table: RegisterTable) -> None:
        self.table = table
        self.ramps = ramps_of(table)
        self._session = session
        self._seen: dict[int, int] = {}
        self._sent: dict[int, int] = {}
        """Words that went out, by address, of registers that no reading has shown since."""
        self._by_hand: dict[int, int] = {}
        """Words that a caller has written, by address, and nobody has read since."""
        self._reads_as: dict[int, int] = {}
        """What a register that hides what was written reads as."""
        self._taken: set[int] = set()
        """Addresses of registers that were written by hand, and read so afterwards."""
        self._unproven: set[int] = set()
        """Addresses that a command has written over, and nobody has read since."""
        self._wanted: dict[int, int | None] = {}
        """What the user wants in a register that a rotation or a stop has written over; None where nobody knows."""

    def ramp_of(self, register: Register) -> Ramp | None:
        """The ramp generator that a write to `register` may set in motion; None of most."""
        if register.axis is None:
            return next((ramp for ramp in self.ramps if register in ramp.moving), None)
        return self.ramps[register.axis] if self.moves(register) else None

    def moves(self, register: Register) -> bool:
        """Whether a write to `register` may set an axis in motion, as far as names tell."""
        return any(register in ramp.moving for ramp in self.ramps)

    # --- what happened --------------------------------------------------------------------------

    def saw(self, register: Register, word: int) -> None:
        """The chip was seen to hold `word`."""
        address, word = register.address, word & register.mask
        if address in self._unproven and register.access is Access.UNKNOWN and word != self._sent.get(address):
            self._reads_as[address] = word
        self._unproven.discard(address)
        hides = self._reads_as.get(address)
        if hides is not None and word != hides:
            del self._reads_as[address]  # another master's, or it can be read after all
            hides = None
        if hides is None:
            if word == self._by_hand.pop(address, None):
                self._taken.add(address)
            if word != self.word(register):
                self._wanted.pop(address, None)
            self._sent.pop(address, None)
            self._seen[address] = word
        if self._session.limiter is not None:
            self._session.limiter.saw(address, self._sent.get(address, word), register.width)

    def sent(self, register: Register, word: int) -> None:
        """`word` was sent by the user."""
        self._sent[register.address] = word
        self._by_hand[register.address] = word & register.mask
        self._wanted.pop(register.address, None)

    def hides(self, register: Register, back: int) -> None:
        """A reading after the latest write has shown `back` instead of what was written."""
        self._reads_as[register.address] = back & register.mask

    def overwrite(self, register: Register, word: int) -> None:
        """`word` goes out in the course of a command: what the user wants there comes back with the next move."""
        wanted = self._wanted.setdefault(register.address, self.word(register))
        self._sent[register.address] = word
        self._unproven.add(register.address)
        if word == wanted:
            del self._wanted[register.address]

    # --- what is known --------------------------------------------------------------------------

    def word(self, register: Register) -> int | None:
        """What the chip holds as far as is known."""
        return self._sent.get(register.address, self._seen.get(register.address))

    def unread(self, register: Register) -> int | None:
        """What was written to a register that does not show it when it is read; None of all others."""
        shows = register.access.readable and register.address not in self._reads_as
        return None if shows else self._sent.get(register.address)

    def wanted(self, register: Register) -> int | None:
        """What it holds, as the user wants it; None where nobody knows."""
        address = register.address
        return self._wanted[address] if address in self._wanted else self.word(register)

    def overwritten(self, register: Register) -> bool:
        """Whether the chip holds something else there than the user wants."""
        return register.address in self._wanted

    def has_taken(self, register: Register) -> bool:
        """Whether a write of it by hand was read back."""
        return register.address in self._taken

    def known(self, address: int) -> int | None:
        """`word` by address, for soft limits."""
        register = self.table.at(address, write=True)
        return None if register is None else self.word(register)

    def on_state(self, state: DeviceState, problem: BenchError | None) -> None:
        """`Session.state_hooks`: where the link failed, it may be another chip, or this one after a reset."""
        del problem
        if state == "failed":
            self._taken.clear()
            for words in (self._by_hand, self._seen, self._sent, self._reads_as, self._wanted, self._unproven):
                words.clear()

    def mechanics(self, axis: int) -> Mechanics:
        """Conversions of an axis: what a count is no table tells, so it is taken for a microstep of 256."""
        settings = self._session.axes[axis].settings
        return Mechanics(
            settings.full_steps_per_rev, 256, settings.gear_ratio, travel_mm_per_rev=settings.travel_mm_per_rev
        )
