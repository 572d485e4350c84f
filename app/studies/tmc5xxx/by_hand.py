"""What of a TMC5xxx is tuned by hand beside speed and acceleration: SixPoint, currents, choppers, StallGuard."""

from __future__ import annotations

from ..field_settings import Place
from ..scored_move.places import HandPlace

BY_HAND = (
    HandPlace("VSTART", Place("VSTART")),
    HandPlace("A1", Place("A1")),
    HandPlace("V1", Place("V1")),
    HandPlace("DMAX", Place("DMAX")),
    HandPlace("D1", Place("D1")),
    HandPlace("VSTOP", Place("VSTOP")),
    HandPlace("run current scale", Place("IHOLD_IRUN", "irun")),
    HandPlace("hold current scale", Place("IHOLD_IRUN", "ihold")),
    HandPlace("TOFF", Place("CHOPCONF", "toff")),
    HandPlace("HSTRT", Place("CHOPCONF", "hstrt")),
    HandPlace("HEND", Place("CHOPCONF", "hend")),
    HandPlace("TBL", Place("CHOPCONF", "tbl")),
    HandPlace("StealthChop", Place("GCONF", "en_pwm_mode")),
    HandPlace("TPWMTHRS", Place("TPWMTHRS")),
    HandPlace("PWM_OFS", Place("PWMCONF", "pwm_ofs")),
    HandPlace("PWM_GRAD", Place("PWMCONF", "pwm_grad")),
    HandPlace("SGT", Place("COOLCONF", "sgt")),
    HandPlace("SFILT", Place("COOLCONF", "sfilt")),
    HandPlace("SG4_THRS", Place("SG4_THRS", "SG4_THRS")),
    HandPlace("TCOOLTHRS", Place("TCOOLTHRS")),
)
