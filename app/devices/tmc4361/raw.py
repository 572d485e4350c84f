"""Single datagrams by hand: the status byte's names, and what of them moves the axis."""

from __future__ import annotations

from ...registers.model import Register
from ...registers.tmc4361.bits import event_names, selected_events
from ..core.raw_frames import RawFrames
from . import rows
from .samples import Samples


class Raw(Samples, RawFrames):
    """A TMC4361 that takes raw frames."""

    async def _moved_by_hand(self, register: Register) -> bool:
        if register.address not in rows.MOVING:
            return False
        await self._foresee_by_hand()
        return True

    def _status_flags(self, status: int) -> dict[str, bool]:
        """The status byte's bits by the events that SPI_STATUS_SELECTION shows there; none before that was seen."""
        selection = self.known(rows.SPI_STATUS_SELECTION)
        if selection is None:
            return {}
        return {
            name: bool(status >> place & 1)
            for place, bit in enumerate(selected_events(selection))
            for name in event_names(1 << bit)
        }
