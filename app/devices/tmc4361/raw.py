"""Single datagrams by hand: the status byte's names, and what of them moves the axis."""

from __future__ import annotations

from ...registers.model import Register
from ...registers.tmc4361.bits import event_names, selected_events
from ..core.raw_datagrams import RawRules
from . import roles
from .memory import ChipMemory
from .writes import Writes


class DatagramsByHand(RawRules):
    """What single frames do to one TMC4361."""

    def __init__(self, memory: ChipMemory, writes: Writes) -> None:
        self._memory = memory
        self._writes = writes

    def read_by_hand(self, register: Register, data: int, time_s: float) -> None:
        del time_s
        self._writes.saw(register, data)

    def known_word(self, register: Register) -> int | None:
        return self._memory.known(register) if register.access.readable else self._memory.kept_word(register)

    async def moved_by_hand(self, register: Register) -> bool:
        if register.address not in roles.MOVING:
            return False
        await self._writes.predict_by_hand()
        return True

    def status_flags(self, status: int) -> dict[str, bool]:
        """The status byte's bits by the events that SPI_STATUS_SELECTION shows there; none before that was seen."""
        selection = self._memory.known(roles.SPI_STATUS_SELECTION)
        if selection is None:
            return {}
        return {
            name: bool(status >> place & 1)
            for place, bit in enumerate(selected_events(selection))
            for name in event_names(1 << bit)
        }
