"""Single frames by hand: the status byte's names, and what of them moves an axis."""

from __future__ import annotations

from ...links import datagram40
from ...registers.model import Register
from ..core.raw_datagrams import RawRules
from .events import Events
from .memory import ChipMemory
from .written_motion import WrittenMotion

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


class DatagramsByHand(RawRules):
    """What single datagrams do to the chip."""

    def __init__(self, model: str, memory: ChipMemory, log: Events, motion: WrittenMotion) -> None:
        self._model = model
        self._memory = memory
        self._log = log
        self._motion = motion

    def behind(self, frame: bytes, register: Register) -> bytes | None:
        # What a reading clears is asked for once, and something harmless brings the answer.
        return datagram40.fetch_of(self._model) if register.read_clears else frame

    def read_by_hand(self, register: Register, data: int, time_s: float) -> None:
        if register.read_clears:
            self._log.read_by_hand(register, data, time_s)
        self._memory.saw_word(register, data)

    def known_word(self, register: Register) -> int | None:
        return self._memory.known(register) if register.access.readable else self._memory.wanted(register)

    async def moved_by_hand(self, register: Register) -> bool:
        rows = self._memory.chip.moved_by(register)
        if rows is None:
            return False
        await self._motion.written_by_frame(rows)
        return True

    def status_flags(self, status: int) -> dict[str, bool]:
        names = DUAL if self._memory.chip.two_axes else SINGLE
        return {name: bool(status >> bit & 1) for bit, name in enumerate(names)}
