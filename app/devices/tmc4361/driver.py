"""The TMC4361: one axis with S-ramps, an encoder and closed loop."""

from __future__ import annotations

from ...registers.model import Register, to_raw
from . import rows
from .tables import Tables


class Tmc4361(Tables):
    """Driver of one TMC4361."""

    def as_set(self, register: Register, word: int) -> int:
        """`word`, read from `register`, as its user has set it: a stop or a rotation may have written over it."""
        if register is rows.VMAX:
            return to_raw(self.cruise.speed, register.width)
        if register is rows.RAMPMODE:
            return word & ~rows.SHAPE.mask | self.cruise.shape << rows.SHAPE.lsb
        return word
