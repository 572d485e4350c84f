"""What the registers of the driver hold, as far as they were read or written here. Nothing is asked of the chip.

VACTUAL, currents and thresholds cannot be read: they are known where they were written through this connection, or the
chip was seen to be as after a reset.
"""

from __future__ import annotations

from ...calc.units.mechanics import Mechanics
from ...calc.units.tmc5xxx import velocity_unit_pps
from ...errors import BenchError
from ...registers.model import Register
from ..core.register_io import Snapshot
from ..core.register_link import RegisterLink
from ..core.results import DeviceState
from .roles import FINEST, DriverRoles


class DriverMemory:
    """Words by register: seen, written, as after a reset."""

    def __init__(self, link: RegisterLink, rows: DriverRoles) -> None:
        self.rows = rows
        self.table = link.table
        self.fresh = False
        """Whether what nobody has written through here is as after a reset: so it is once a reset was seen."""
        self._session = link.session
        self._known: dict[int, int] = {}
        """Words as last seen, by address, of registers that can be read."""
        self._unread: dict[int, int] = {}
        """Words as last written since the chip's reset, of those that cannot."""

    def remembers(self, register: Register) -> bool:
        """Whether `saw_word` keeps what it hears of this register."""
        return register.access.readable and register.access.writable and not register.volatile

    def saw(self, held: Snapshot) -> None:
        """The chip was seen to hold these."""
        for register in held.registers:
            self.saw_word(register, held.word(register))
        rows = self.rows
        words = [held.words.get(row.address) for row in (rows.gconf, rows.chopconf, rows.inputs)]
        gconf, chopconf, inputs = words
        if gconf is not None and chopconf is not None and inputs is not None:
            self._session.axes[0].microsteps_per_full_step = rows.microsteps(gconf, chopconf, inputs)

    def saw_word(self, register: Register, word: int) -> None:
        """The chip was seen to hold `word`."""
        if self.remembers(register):
            self._known[register.address] = word & register.mask
            if self._session.limiter is not None:
                self._session.limiter.saw(register.address, word)

    def sent(self, register: Register, word: int) -> None:
        """`word` went out."""
        if not register.access.readable:
            self._unread[register.address] = word & register.mask

    def written(self, register: Register) -> int | None:
        """What was written through here since the chip's reset; of a register that can be read what it was seen to
        hold."""
        return (self._known if register.access.readable else self._unread).get(register.address)

    def word(self, register: Register) -> int | None:
        """What the chip holds as far as is known: read, written through here, or as after the reset that was seen."""
        found = self.written(register)
        return register.reset if found is None and self.fresh and not register.access.readable else found

    def remembered_word(self, address: int) -> int | None:
        """`word` of the register that is written at `address`."""
        register = self.table.at(address, write=True)
        return None if register is None else self.word(register)

    @property
    def velocity(self) -> int | None:
        """VACTUAL, signed; None where nobody knows it, 0 for a driver without."""
        row = self.rows.vactual
        if row is None:
            return 0
        word = self.word(row)
        return None if word is None else row.decode(word)

    @property
    def microsteps(self) -> int:
        """Microsteps a full step; the finest where nobody knows."""
        return self._session.axes[0].microsteps_per_full_step or FINEST

    @property
    def mechanics(self) -> Mechanics:
        """Conversions of the axis."""
        return self._session.axes[0].settings.mechanics(self.microsteps)

    @property
    def velocity_unit_pps(self) -> float:
        """What VACTUAL counts in [microsteps/s]."""
        return velocity_unit_pps(self._session.clock_hz)

    def was_reset(self) -> None:
        """The chip was reset: what was known is true no more."""
        self._known.clear()
        self._unread.clear()
        if self._session.limiter is not None:
            self._session.limiter.reset()
        self.fresh = True

    def heard_state(self, state: DeviceState, problem: BenchError | None) -> None:
        """What can be read will be read again. What cannot stays in mind: GSTAT tells if the chip was reset."""
        del problem
        if state == "failed":
            self._known.clear()
