"""VMAX and RAMPMODE as the user wants them, while rotation and stops write something else over them.

VMAX is the speed limit of positioning, and in velocity mode the target velocity: a rotation and a stop overwrite the
limit, and a stop at once leaves the shape of ramps behind. What was there before comes back with the next move.
"""

from __future__ import annotations

from dataclasses import dataclass

from . import roles


@dataclass(slots=True)
class Cruise:
    """`speed` is |VMAX| for positioning [1/256 pps], `shape` RAMP_PROFILE; both as nobody here has overwritten them."""

    speed: int = 0
    shape: int = roles.S_SHAPED
    _vmax: int | None = None
    """VMAX as it was written over; None where it is the user's own."""
    _mode: int | None = None

    def saw_vmax(self, vmax: int) -> None:
        """The chip holds `vmax`, with its sign."""
        if vmax != self._vmax:
            self._vmax, self.speed = None, abs(vmax)

    def saw_mode(self, mode: int) -> None:
        """The chip holds RAMPMODE `mode`."""
        if mode != self._mode:
            self._mode, self.shape = None, min(mode & 3, roles.S_SHAPED)

    def overwrite_vmax(self, vmax: int) -> None:
        """`vmax` goes out in the course of a command; what was seen before is what is wanted."""
        self._vmax = None if abs(vmax) == self.speed else vmax

    def overwrite_mode(self, mode: int) -> None:
        """`mode` goes out in the course of a command."""
        self._mode = None if min(mode & 3, roles.S_SHAPED) == self.shape else mode

    def forget(self) -> None:
        """It may be another chip, or the same after a reset."""
        self.speed, self.shape, self._vmax, self._mode = 0, roles.S_SHAPED, None, None
