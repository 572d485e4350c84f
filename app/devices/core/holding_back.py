"""What still goes out to a chip or module that is not the one its connection names: readings, and stops that it has."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ...errors import OtherModel, WrongState
from ...links.queue import Priority


class OnlyReading:
    """`FrameHold` of a device at whose place something else answers. `reads` tells whether a frame only reads."""

    def __init__(self, why: WrongState, reads: Callable[[bytes], bool]) -> None:
        self.why = why
        self._reads = reads

    def refuse(self, frames: Sequence[bytes], priority: Priority, by_hand: bool) -> None:
        """Raises `why` for a frame that may write. What would stop the connection's model stops another one by chance
        at most: its own stop goes another way (`Device.stop_axes`)."""
        del by_hand
        if priority is Priority.STOP and not (isinstance(self.why, OtherModel) and not self.why.same_stop):
            return
        if not all(self._reads(frame) for frame in frames):
            raise self.why

    def saw(self, frames: Sequence[bytes], replies: Sequence[bytes]) -> None:
        """Nothing is learnt by it."""
