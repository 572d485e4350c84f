"""Where a TMC5xxx keeps what its StallGuard works by (DS-TMC5160 14, DS-TMC5130 14; FIELDS-TMC5240)."""

from __future__ import annotations

from ..field_settings import Place
from ..stallguard.setting import StallPlaces

STALLGUARD2 = StallPlaces(
    generation=2,
    threshold=Place("COOLCONF", "sgt"),
    filter=Place("COOLCONF", "sfilt"),
    stop=Place("SW_MODE", "sg_stop"),
    armed=("TCOOLTHRS", "VCOOLTHRS"),
    # CoolStep would change the current, and with it every value; another chopper at high speed too.
    fixed=(
        (Place("SW_MODE", "en_softstop"), 0),
        (Place("COOLCONF", "semin"), 0),
        (Place("GCONF", "en_pwm_mode"), 0),
        (Place("THIGH"), 0),
        (Place("VHIGH"), (1 << 23) - 1),
    ),
)
"""With SpreadCycle alone."""
STALLGUARD4 = StallPlaces(
    generation=4,
    threshold=Place("SG4_THRS", "SG4_THRS"),
    filter=Place("SG4_THRS", "sg4_filt_en"),
    stop=Place("SW_MODE", "sg_stop"),
    armed=("TCOOLTHRS",),
    fixed=(
        (Place("SW_MODE", "en_softstop"), 0),
        (Place("COOLCONF", "semin"), 0),
        (Place("GCONF", "en_pwm_mode"), 1),
        (Place("TPWMTHRS"), 0),
        (Place("THIGH"), 0),
    ),
)
"""With StealthChop alone, at any speed: TPWMTHRS 0."""
STALL = (STALLGUARD2, STALLGUARD4)
