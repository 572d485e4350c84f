"""Motion for as long as a client keeps it up: a rotation that ends by itself unless it is kept up.

A jog button tells when it is let go, but not when its browser, network or machine goes away.
"""

from __future__ import annotations

from ..clock import Clock
from ..devices.core.device import Device
from ..devices.core.results import Rotating
from ..errors import OutOfRange
from .procedure import Ended, Procedure

HOLD_S = (0.1, 10.0)
"""Shortest and longest time that a rotation goes on without being kept up [s]."""


def check_hold(hold_s: float) -> float:
    """`hold_s` [s] itself. Raises OutOfRange."""
    if not HOLD_S[0] <= hold_s <= HOLD_S[1]:
        raise OutOfRange("hold_s", hold_s, *HOLD_S, "seconds until the rotation ends unless kept up")
    return hold_s


class Hold(Procedure):
    """Watches over a rotation that has begun; stops the motor by its ramp when nobody keeps it up."""

    kind = "held rotation"

    def __init__(self, device: Device, axis: int, clock: Clock, rotating: Rotating, hold_s: float) -> None:
        super().__init__(device, axis, clock)
        self.rotating = rotating
        self._until_s = clock.now() + check_hold(hold_s)

    def keep(self, hold_s: float) -> Rotating:
        """Go on for `hold_s` [s] from now. Raises OutOfRange."""
        self._until_s = self.clock.now() + check_hold(hold_s)
        return self.rotating

    async def _run(self) -> None:
        while (left_s := self._until_s - self.clock.now()) > 0:
            await self.clock.sleep(left_s)
        self.message = "nobody kept it up"
        await self.device.stop(self.axis)

    def _over(self, how: Ended) -> None:
        self.message = self.message or how

    async def _give_back(self) -> None:
        """It borrows nothing."""
