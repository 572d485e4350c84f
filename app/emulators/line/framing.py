"""How the bytes on a line are cut into frames, and how a line finds its feet again after half ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from ...links.datagram_uart import SYNC, WRITE_BIT, UartForm, is_sound
from ...links.tmcl import FRAME_BYTES

GAP_S = 0.010
"""A pause inside a frame after which the module forgets what it has of it [s].

The manual names no time, only published firmware shows that there is one. Ten milliseconds are longer than what an
operating system puts between two bytes of one write, and shorter than what a client waits before it asks again.
"""
PAUSE_BITS = 63
"""Between the start bits of two bytes of a datagram; longer ends it (TMC5160A data sheet 1.14, 5.1.1)."""
IDLE_BITS = 12
"""Of silence, before a chip that met an error listens again (likewise)."""
BAUD_UNSAID = 28_800
"""Whose bit times count where the line takes no time: slow enough for clients that write byte by byte."""
_SYNC_MASK = 0x0F
"""The upper nibble of the first byte is reserved and may be anything."""


class Framing(Protocol):
    """What a line asks of the kind of frames on it."""

    @property
    def events(self) -> bool:
        """Whether modules may speak unasked, after the command of TMCL that wishes for it."""
        ...

    @property
    def half_duplex(self) -> bool:
        """Whether questions and answers share one wire: who speaks into an answer spoils both."""
        ...

    def length(self, begun: bytes) -> int:
        """How long the frame is that begins with `begun`, which is not empty; what is behind it does not matter.

        Where that is not yet known, how much of it tells more; -1 where no frame begins so.
        """
        ...

    def is_sound(self, frame: bytes) -> bool:
        """Whether whoever hears `frame` goes on listening; else everybody waits for silence."""
        ...

    def gap_s(self, baud: int | None) -> float:
        """A pause inside a frame that ends it [s]."""
        ...

    def idle_s(self, baud: int | None) -> float:
        """The silence that ends what is not sound [s]."""
        ...


@dataclass(frozen=True)
class Fixed:
    """Frames of one length, whatever is in them. `pause_s` [s] as `GAP_S`."""

    frame_bytes: int
    pause_s: float = GAP_S
    events: bool = False
    half_duplex: bool = False

    def length(self, begun: bytes) -> int:
        del begun
        return self.frame_bytes

    def is_sound(self, frame: bytes) -> bool:
        del frame
        return True

    def gap_s(self, baud: int | None) -> float:
        del baud
        return self.pause_s

    def idle_s(self, baud: int | None) -> float:
        del baud
        return 0.0


TMCL = Fixed(FRAME_BYTES, events=True)


class UartDatagrams:
    """Datagrams of chips on a single wire, of `form` whatever the node."""

    events = False
    half_duplex = True

    def __init__(self, form: UartForm) -> None:
        self._place = form.read_bytes - 2
        """Of the register, whose upper bit writes."""
        self._read_bytes = form.read_bytes
        self._write_bytes = form.write_bytes

    def length(self, begun: bytes) -> int:
        if begun[0] & _SYNC_MASK != SYNC:
            return -1
        if len(begun) <= self._place:
            return self._place + 1
        return self._write_bytes if begun[self._place] & WRITE_BIT else self._read_bytes

    def is_sound(self, frame: bytes) -> bool:
        return is_sound(frame)

    def gap_s(self, baud: int | None) -> float:
        return PAUSE_BITS / (baud or BAUD_UNSAID)

    def idle_s(self, baud: int | None) -> float:
        return IDLE_BITS / (baud or BAUD_UNSAID)
