"""A chip on a serial line without TMCL: its raw frames, as a bridge without a protocol of its own passes them on."""

from __future__ import annotations

from ..server import Served
from .faults import LineFaults


class RawChip:
    """A chip as a `LineModule`. Its own faults are those of its bus; the line has those of the cable."""

    reply_pause_s = 0.0

    def __init__(self, chip: Served) -> None:
        self._chip = chip
        self.clock = chip.clock
        self.faults = LineFaults()

    def receive(self, frame: bytes, at_s: float | None = None) -> bytes | None:
        """The chip's answer; None while it gives none."""
        try:
            return self._chip.exchange(frame, at_s)
        except (TimeoutError, ConnectionError):
            return None

    def unsolicited(self, at_s: float | None = None) -> list[tuple[float, bytes]]:
        """A chip speaks only when it is asked."""
        del at_s
        return []

    def catch_up(self, slice_s: float) -> bool:
        """As the chip's."""
        return self._chip.catch_up(slice_s)
