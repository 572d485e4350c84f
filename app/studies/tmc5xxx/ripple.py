"""Where a TMC5xxx keeps which chopper drives the coils, which moves ripple (DS-TMC5160 6.4)."""

from __future__ import annotations

from ..field_settings import Place
from ..resonance_map.places import RipplePlaces

QUIET = Place("GCONF", "en_pwm_mode")
RIPPLE = RipplePlaces(
    quiet=QUIET,
    stealthchop=((QUIET, 1), (Place("TPWMTHRS"), 0), (Place("THIGH"), 0), (Place("VHIGH"), (1 << 23) - 1)),
    spreadcycle=((QUIET, 0), (Place("THIGH"), 0), (Place("VHIGH"), (1 << 23) - 1)),
)
