"""Where an axis was seen of late, and what its encoder said there: that tells a wrong resolution from lost steps."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

from ..calc.positions.encoder_resolution import APART_TURNS, EncoderLine, Place, encoder_line

KEPT = 32
"""Places kept of each direction."""


def _kept() -> deque[Place]:
    return deque(maxlen=KEPT)


@dataclass(slots=True)
class EncoderTrace:
    """The latest places of one encoder of an axis, those that it came to forward and those backward."""

    _forward: deque[Place] = field(default_factory=_kept)
    _backward: deque[Place] = field(default_factory=_kept)
    _latest: int | None = None

    def add(self, place: Place, turn: int) -> None:
        """Keep it, where it is another place than the latest."""
        if self._latest is not None:
            gone = place.position - self._latest
            if abs(gone) < turn * APART_TURNS:
                return
            (self._forward if gone > 0 else self._backward).append(place)
        self._latest = place.position

    def clear(self) -> None:
        """The same places have other numbers from now on."""
        self._forward.clear()
        self._backward.clear()
        self._latest = None

    def line(self, full_step: int, turn: int) -> EncoderLine | None:
        """See `encoder_line`."""
        return encoder_line(self._forward, self._backward, full_step, turn)
