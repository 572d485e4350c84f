"""What is wrong with a module at present."""

from __future__ import annotations

import random
from dataclasses import asdict, dataclass

from ..core.base import ChipFaults
from ..core.noise import cut, flip
from .state import FaultsState

UNDERVOLTAGE_V = 6.0
"""Motor supply while the fault is on [V]: below the 8 V that the driver chip needs."""


@dataclass(slots=True)
class Faults(ChipFaults):
    """On the wire, and `undervoltage` of the supply. A serial line looks at them for every frame."""

    late_reply_s: float = 0.0
    half_frame_rate: float = 0.0
    undervoltage: bool = False

    def describe(self) -> FaultsState:
        return FaultsState(**asdict(self))

    def spoil(self, reply: bytes, noise: random.Random) -> bytes:
        """What arrives of `reply`: flipped bits, and perhaps only its beginning."""
        return cut(flip(reply, self.bit_error_rate, noise), self.half_frame_rate, noise)
