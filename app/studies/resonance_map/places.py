"""What a family has of settings that move ripple beside its current: its choppers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ..field_settings import Place


@dataclass(frozen=True, slots=True)
class RipplePlaces:
    """quiet : the bit that is set for StealthChop
    stealthchop, spreadcycle : what is set for one of both at every speed
    """

    quiet: Place
    stealthchop: Sequence[tuple[Place, int]]
    spreadcycle: Sequence[tuple[Place, int]]
