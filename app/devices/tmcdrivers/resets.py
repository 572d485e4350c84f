"""GSTAT.reset: seen by the driver, cleared so that it can be seen again, and kept for whoever reads GSTAT by name.

Of chips whose reading clears GSTAT all of it is kept.
"""

from __future__ import annotations

from ...registers.model import Register
from ..core.register_io import RegisterIO
from .memory import DriverMemory
from .roles import part


class Resets:
    """How often the chip was reset."""

    def __init__(self, memory: DriverMemory) -> None:
        self.seen = 0
        """How often a reset was seen, that of the chip's power-on included where nobody had taken notice of it."""
        self._memory = memory
        self._row = memory.rows.gstat
        self._bit = part(self._row, "reset").mask
        self._owed = 0
        """What the driver has cleared and its user has not."""

    async def check(self, io: RegisterIO, gstat: int) -> None:
        """GSTAT was read: take notice of a reset. Raises LinkError."""
        self.heard(gstat)
        if self._row.read_clears:
            self._owed |= gstat & self._row.mask
        elif gstat & self._bit:
            self._owed |= self._bit
            await io.write(self._row, self._bit)

    def heard(self, gstat: int) -> None:
        """The same of a reading that its user gets."""
        if gstat & self._bit:
            self.seen += 1
            self._memory.was_reset()

    def delivered(self, register: Register) -> None:
        """Its user gets what reading has cleared."""
        if register is self._row and register.read_clears:
            self._owed = 0

    def shown(self, register: Register, word: int) -> int:
        """`word` with what the driver has cleared of it."""
        return word | self._owed if register is self._row else word

    def sent(self, register: Register, word: int) -> None:
        """Its user has written the 1s of `word`."""
        if register is self._row:
            self._owed &= ~word
