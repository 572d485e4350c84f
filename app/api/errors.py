"""Errors that only the edge raises; the others are in links/errors.py."""

from __future__ import annotations

from app.calc.mslut import Refusal
from app.links.errors import UsageError


class UnencodableWave(UsageError):
    """A wave that no register values make: the place, the reason, and how far the nearest encodable one is."""

    def __init__(self, refusal: Refusal, distance_max: float) -> None:
        super().__init__(f"entry {refusal.index} of the wave cannot be encoded: {refusal.detail}")
        self.index = refusal.index
        self.reason = refusal.reason
        self.distance_max = distance_max
        self.way_out = (
            "POST /calc/microstep-table answers the nearest encodable wave, "
            f"which is at most {distance_max:.1f} counts away"
        )
