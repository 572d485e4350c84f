"""Where a family keeps what an identification sets, and has to know."""

from __future__ import annotations

from dataclasses import dataclass

from ..current_settings import CurrentPlaces
from ..encoder_scale import EncoderPlaces
from ..ramp_settings import RampRegisters


@dataclass(frozen=True, slots=True)
class IdentificationPlaces:
    """hop : a ramp that starts and stops at its full speed"""

    hop: RampRegisters
    current: CurrentPlaces
    encoder: EncoderPlaces
