"""The TMC4361: one axis with S-ramps, an encoder and closed loop."""

from __future__ import annotations

from app.devices.tmc4361 import rows
from app.devices.tmc4361.tables import Tables
from app.registers.model import Register, to_raw


class Tmc4361(Tables):
    """Driver of one TMC4361."""

    def as_set(self, register: Register, word: int) -> int:
        """`word`, read from `register`, as its user has set it: a stop or a rotation may have written over it."""
        if register is rows.VMAX:
            return to_raw(self.cruise.speed, register.width)
        if register is rows.RAMPMODE:
            return word & ~rows.SHAPE.mask | self.cruise.shape << rows.SHAPE.lsb
        return word
