"""What of a TMC5xxx is tuned by hand beside speed and acceleration: its ramp, currents, choppers, StallGuard, CoolStep.

Not among it is how many microsteps a full step has: positions would count otherwise.
"""

from __future__ import annotations

from ..field_settings import Place
from ..scored_move.places import HandPlace, fields, whole

BY_HAND = (
    *whole("VSTART", "A1", "V1", "A2", "V2", "TVMAX", "DMAX", "D2", "D1", "VSTOP", "TZEROWAIT"),
    *whole("VDCMIN"),
    *fields("DCCTRL", "DC_TIME", "DC_SG"),
    HandPlace("run current scale", Place("IHOLD_IRUN", "irun")),
    HandPlace("hold current scale", Place("IHOLD_IRUN", "ihold")),
    *fields("IHOLD_IRUN", "IHOLDDELAY", "IRUNDELAY"),
    *whole("TPOWERDOWN", "GLOBAL_SCALER"),
    *fields("DRV_CONF", "CURRENT_RANGE"),
    HandPlace("TOFF", Place("CHOPCONF", "toff")),
    HandPlace("HSTRT", Place("CHOPCONF", "hstrt")),
    HandPlace("HEND", Place("CHOPCONF", "hend")),
    HandPlace("TBL", Place("CHOPCONF", "tbl")),
    *fields("CHOPCONF", "chm", "fd3", "disfdcc", "rndtf", "tpfd", "sync", "vsense", "intpol", "intpol16"),
    *fields("CHOPCONF", "vhighfs", "vhighchm"),
    *whole("THIGH", "VHIGH"),
    HandPlace("StealthChop", Place("GCONF", "en_pwm_mode")),
    HandPlace("TPWMTHRS", Place("TPWMTHRS")),
    HandPlace("PWM_OFS", Place("PWMCONF", "pwm_ofs")),
    HandPlace("PWM_GRAD", Place("PWMCONF", "pwm_grad")),
    *fields("PWMCONF", "PWM_AMPL", "pwm_freq", "pwm_autoscale", "pwm_autograd", "PWM_REG", "PWM_LIM", "freewheel"),
    HandPlace("SGT", Place("COOLCONF", "sgt")),
    HandPlace("SFILT", Place("COOLCONF", "sfilt")),
    HandPlace("SG4_THRS", Place("SG4_THRS", "SG4_THRS")),
    *fields("SG4_THRS", "sg4_filt_en", "sg_angle_offset"),
    HandPlace("TCOOLTHRS", Place("TCOOLTHRS")),
    *whole("VCOOLTHRS"),
    *fields("SW_MODE", "sg_stop"),
    *(HandPlace(name.upper(), Place("COOLCONF", name)) for name in ("semin", "semax", "seup", "sedn", "seimin")),
)
