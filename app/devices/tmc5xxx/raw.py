"""Single frames by hand: the status byte's names, and what of them moves an axis."""

from __future__ import annotations

from ...links import datagram40
from ...registers.model import Register
from ..core.raw_frames import RawFrames
from .samples import Samples

SINGLE = (
    "reset_flag",
    "driver_error",
    "sg2",
    "standstill",
    "velocity_reached",
    "position_reached",
    "status_stop_l",
    "status_stop_r",
)
DUAL = (
    "reset_flag",
    "driver_error1",
    "driver_error2",
    "velocity_reached1",
    "velocity_reached2",
    "status_stop_l1",
    "status_stop_l2",
)
"""Bits of the SPI status byte, from the lowest (NOTES-TMC5XXX 5)."""


class Raw(Samples, RawFrames):
    """A TMC5xxx that takes raw frames."""

    def _behind(self, frame: bytes, register: Register) -> bytes | None:
        # What a reading clears is asked for once, and something harmless brings the answer.
        return datagram40.fetch_of(self.model) if register.read_clears else frame

    def _heed_reading(self, register: Register, data: int, time_s: float) -> None:
        if register.read_clears:
            self._read_by_hand(register, data, time_s)
        super()._heed_reading(register, data, time_s)

    async def _moved_by_hand(self, register: Register) -> bool:
        rows = self._moved_by(register)
        if rows is None:
            return False
        await self._foresee_by_hand(rows)
        return True

    def _status_flags(self, status: int) -> dict[str, bool]:
        names = DUAL if self.chip.two_axes else SINGLE
        return {name: bool(status >> bit & 1) for bit, name in enumerate(names)}
