"""What is wrong with a module at present."""

from __future__ import annotations

import random
from dataclasses import dataclass

from app.emulators.pd42.options import FaultsChange
from app.emulators.pd42.state import FaultsState

UNDERVOLTAGE_V = 6.0
"""Motor supply while the fault is on [V]: below the 8 V that the driver chip needs."""


@dataclass(slots=True)
class Faults:
    """On the wire, and `undervoltage` of the supply. A serial line looks at them for every frame."""

    silence: bool = False
    late_reply_s: float = 0.0
    bit_error_rate: float = 0.0
    half_frame_rate: float = 0.0
    unplugged: bool = False
    undervoltage: bool = False

    def change(self, change: FaultsChange) -> None:
        """Take what `change` names."""
        for name, value in change.model_dump(exclude_none=True).items():
            setattr(self, name, value)

    def describe(self) -> FaultsState:
        return FaultsState(
            silence=self.silence,
            late_reply_s=self.late_reply_s,
            bit_error_rate=self.bit_error_rate,
            half_frame_rate=self.half_frame_rate,
            unplugged=self.unplugged,
            undervoltage=self.undervoltage,
        )

    def spoil(self, reply: bytes, noise: random.Random) -> bytes:
        """What arrives of `reply`: flipped bits, and perhaps only its beginning."""
        if self.bit_error_rate:
            mask = sum(1 << bit for bit in range(8 * len(reply)) if noise.random() < self.bit_error_rate)
            reply = (int.from_bytes(reply, "big") ^ mask).to_bytes(len(reply), "big")
        if self.half_frame_rate and noise.random() < self.half_frame_rate:
            reply = reply[: noise.randrange(1, len(reply))]
        return reply
