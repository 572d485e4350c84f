"""Where a family keeps what an identification sets, and has to know."""

from __future__ import annotations

from dataclasses import dataclass

from ..encoder_scale import EncoderPlaces
from ..ramp_settings import RampRegisters
from .coil import AmplitudePlaces


@dataclass(frozen=True, slots=True)
class IdentificationPlaces:
    """hop : a ramp that starts and stops at its full speed; encoder : None where nothing tells what a count is;
    amplitude : None where a family has no StealthChop that tunes itself"""

    hop: RampRegisters
    encoder: EncoderPlaces | None = None
    amplitude: AmplitudePlaces | None = None
