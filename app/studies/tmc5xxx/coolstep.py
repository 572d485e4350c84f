"""Where a TMC5xxx keeps CoolStep (DS-TMC5160 6.4.2, 14, 15; FIELDS-TMC5240)."""

from __future__ import annotations

from ..field_settings import Place
from ..least_current.cool_setting import CoolPlaces

COOLSTEP = CoolPlaces(
    lower=Place("COOLCONF", "semin"),
    width=Place("COOLCONF", "semax"),
    up=Place("COOLCONF", "seup"),
    down=Place("COOLCONF", "sedn"),
    least=Place("COOLCONF", "seimin"),
    level=Place("COOLCONF", "sgt"),
    armed=(Place("TCOOLTHRS"), Place("VCOOLTHRS")),
    stop=Place("SW_MODE", "sg_stop"),
    quiet=Place("GCONF", "en_pwm_mode"),
    measures_quiet=Place("SG4_THRS"),
)
