"""Resets of a chip that has no flag which tells of one.

What tells of one is the ramp parameters: a chip that runs has a speed limit and an acceleration, and after power-on it
has neither. So ramp parameters that read as after power-on, and did not before, are a reset; as they are where they
read so at the first poll of a connection, since nobody who has set a chip up for moving leaves it like that.
"""

from __future__ import annotations

from ...registers.model import Register
from .memory import RampMemory


class Resets:
    """What is remembered of the ramp parameters, judged axis by axis."""

    def __init__(self, memory: RampMemory) -> None:
        axes = len(memory.rows)
        self._memory = memory
        self._unset: list[bool | None] = [None] * axes
        """Whether its ramp parameters were seen last as after power-on; None before it was seen."""
        self._untold = [False] * axes
        """Whether a reset was seen that `take` has not told of."""
        self._count = [0] * axes

    def rows(self, axis: int) -> tuple[Register, ...]:
        """The registers that nobody leaves as after power-on who lets the axis move."""
        rows = self._memory.rows[axis]
        return rows.v_max, rows.a_max, rows.proportionality, rows.dividers

    def judge(self, axis: int) -> None:
        """See in what is remembered of the ramp parameters whether the chip was reset."""
        unset = all(self._memory.known(register.address) == register.reset for register in self.rows(axis))
        if unset and self._unset[axis] is not True:
            self._untold[axis] = True
            self._count[axis] += 1
        self._unset[axis] = unset

    def count(self, axis: int) -> int:
        """How often a reset was seen."""
        return self._count[axis]

    def take(self, axis: int) -> bool:
        """Whether there was a reset since this was asked last."""
        untold, self._untold[axis] = self._untold[axis], False
        return untold
