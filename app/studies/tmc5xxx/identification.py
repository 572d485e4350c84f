"""Where a TMC5xxx keeps what an identification sets and has to know (DS-TMC5160 6.1, 6.3, 12.1)."""

from __future__ import annotations

from ..current_settings import CurrentPlaces
from ..encoder_scale import EncoderPlaces
from ..ramp_settings import ACCELERATION, SPEED, RampRegisters

# It starts and stops at full speed: a step for the load, as fast as the chip can make one.
HOP = RampRegisters(
    {SPEED: ("VMAX", "VSTART", "VSTOP"), ACCELERATION: ("AMAX", "DMAX")}, off={"V1": 0, "V2": 0}, brake=("DMAX",)
)
CURRENT = CurrentPlaces("IHOLD_IRUN", "irun", "ihold", steps=32)
ENCODER = EncoderPlaces("ENC_CONST", "ENCMODE", "enc_sel_decimal")
