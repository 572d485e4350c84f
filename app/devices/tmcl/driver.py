"""The PD42-1241: motor, driver and encoder in one, spoken to in TMCL."""

from __future__ import annotations

from ...registers.model import Register
from . import rows
from .samples import Samples


class Pd42(Samples):
    """Positions are the module's microsteps (AP 140 of them a full step); its one axis is number 0.

    Of an axis's settings in the connection, gear ratio and travel count, as do the full steps of a
    turn where the module itself has none (AP 202); `driver_microsteps` does not: AP 140 says that.
    """

    def as_set(self, register: Register, word: int) -> int:
        """`word`, read from `register`, as its user has set it: an immediate stop borrows the acceleration."""
        return self._borrowed if register is rows.MAX_ACCELERATION and self._borrowed is not None else word
