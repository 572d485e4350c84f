"""What the registers of the chip hold, as far as they were read or written here. Nothing is asked of the chip.

Most of what sets a motion cannot be read: it is known where it was written through this connection, or the chip was
seen to be as after a reset. A rotation and a stop write over VMAX and AMAX, which come back with the next move: what
the user wants there is kept apart from what the chip holds.
"""

from __future__ import annotations

from ...errors import BenchError
from ...registers.model import Register
from ..core.register_io import Snapshot
from ..core.register_link import RegisterLink
from ..core.results import DeviceState
from .roles import AxisRoles, ChipRoles


class ChipMemory:
    """Words by register: seen, written, as after a reset, and written over."""

    def __init__(self, link: RegisterLink, chip: ChipRoles) -> None:
        self.chip = chip
        self.table = link.table
        self.fresh = False
        """Whether what nobody has written through here is as after a reset: so it is once a reset was seen."""
        self._session = link.session
        modes = [rows.encoder_mode for rows in chip.axes if rows.encoder_mode is not None]
        self._kept = frozenset(register.address for register in chip.settings)
        """Addresses of registers that hold what was written, although this chip can read them: a command writes over
        some."""
        self._remembered = frozenset(register.address for register in (*chip.remembered, *modes))
        self._known: dict[int, int] = {}
        """Words as last seen, by address, of registers that are remembered."""
        self._unread: dict[int, int] = {}
        """Words as last written since the chip's reset, by address, of registers that cannot be read."""
        self._overwritten: dict[int, int | None] = {}
        """VMAX and AMAX as the user wants them, by address, where a command has written something else over them."""

    def rows(self, axis: int) -> AxisRoles:
        """The registers of an axis by their roles."""
        return self.chip.axes[axis]

    # --- what was seen --------------------------------------------------------------------------

    def remembers(self, register: Register) -> bool:
        """Whether `saw_word` keeps what it hears of this register."""
        return register.address in self._remembered or register.address in self._kept

    def _seen(self, register: Register) -> bool:
        """Whether it is known by what was read there last."""
        return register.access.readable and register.address not in self._kept

    def saw(self, held: Snapshot) -> None:
        """The chip was seen to hold these."""
        for register in held.registers:
            self.saw_word(register, held.word(register))

    def saw_word(self, register: Register, word: int) -> None:
        """The chip was seen to hold `word`."""
        if register.address in self._kept:
            word &= register.mask
            if word != self._unread.get(register.address):  # another master's
                self._overwritten.pop(register.address, None)
            self._unread[register.address] = word
            if self._session.limiter is not None:
                self._session.limiter.saw(register.address, word)
            return
        if register.address not in self._remembered or not register.access.readable:
            return
        self._known[register.address] = word & register.mask
        if self._session.limiter is not None:
            self._session.limiter.saw(register.address, word)
        for rows in self.chip.axes:
            if register is rows.chopconf:
                self._session.axes[rows.axis].microsteps_per_full_step = rows.microsteps(self.known(register))

    def assume(self, register: Register, word: int) -> None:
        """It was written in the course of a command, and has arrived."""
        self._known[register.address] = word

    def mark_unknown(self, register: Register) -> None:
        """It is about to be written in the course of a command."""
        self._known.pop(register.address, None)

    def known(self, register: Register) -> int | None:
        """A remembered word; None where it was not seen yet."""
        return self._known.get(register.address)

    # --- what was written -----------------------------------------------------------------------

    def sent(self, register: Register, word: int) -> None:
        """`word` was sent by the user."""
        if not self._seen(register):
            self._unread[register.address] = word
            self._overwritten.pop(register.address, None)

    def overwrite(self, register: Register, word: int) -> None:
        """`word` goes out in the course of a command: what the user wants there comes back with the next move."""
        wanted = self._overwritten.setdefault(register.address, self.word(register))
        self._unread[register.address] = word
        if word == wanted:
            del self._overwritten[register.address]

    def want(self, register: Register, word: int) -> None:
        """The user wants `word` there: the next move brings it, and nothing is sent now."""
        if self.word(register) != word:
            self._overwritten[register.address] = word

    def overwritten(self, register: Register) -> bool:
        """Whether the chip holds something else there than the user wants."""
        return register.address in self._overwritten

    def written(self, register: Register) -> int | None:
        """A register that cannot be read, as last written through here since the chip's reset."""
        return self._unread.get(register.address)

    # --- what is known --------------------------------------------------------------------------

    def word(self, register: Register) -> int | None:
        """What the chip holds as far as is known: read, written through here, or as after the reset that was seen."""
        if self._seen(register):
            return self._known.get(register.address)
        return self._unread.get(register.address, register.reset if self.fresh else None)

    def wanted(self, register: Register) -> int | None:
        """The same as the user wants it, whatever a rotation or a stop has written over it."""
        address = register.address
        return self._overwritten[address] if address in self._overwritten else self.word(register)

    def remembered_word(self, address: int) -> int | None:
        """`word` of the register that is written at `address`."""
        register = self.table.at(address, write=True)
        return None if register is None else self.word(register)

    # --- what is forgotten ----------------------------------------------------------------------

    def was_reset(self) -> None:
        """The chip was reset: what was known is true no more."""
        self._known.clear()
        self._unread.clear()
        self._overwritten.clear()
        if self._session.limiter is not None:
            self._session.limiter.reset()
        self.fresh = True

    def heard_state(self, state: DeviceState, problem: BenchError | None) -> None:
        """What can be read will be read again. What cannot stays in mind: GSTAT tells if the chip was reset."""
        del problem
        if state == "failed":
            self._known.clear()
