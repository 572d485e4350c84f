"""Where a TMC5xxx keeps what an identification sets and has to know (DS-TMC5160 6.1, 6.3, 7, 12.1)."""

from __future__ import annotations

from ..encoder_scale import EncoderPlaces
from ..field_settings import Place
from ..identification.coil import AmplitudePlaces
from ..ramp_settings import ACCELERATION, SPEED, RampRegisters

# It starts and stops at full speed: a step for the load, as fast as the chip can make one.
HOP = RampRegisters(
    {SPEED: ("VMAX", "VSTART", "VSTOP"), ACCELERATION: ("AMAX", "DMAX")}, off={"V1": 0, "V2": 0}, brake=("DMAX",)
)
ENCODER = EncoderPlaces("ENC_CONST", "ENCMODE", "enc_sel_decimal")
# It begins with what PWMCONF held while pwm_autoscale was last 0 (7.4); the greatest PWM_REG follows in a turn.
_BEGIN = {
    Place("GCONF", "en_pwm_mode"): 1,
    Place("TPWMTHRS"): 0,
    Place("TCOOLTHRS"): 0,
    Place("THIGH"): 0,
    Place("PWMCONF", "pwm_autoscale"): 0,
    Place("PWMCONF", "pwm_autograd"): 0,
    Place("PWMCONF", "PWM_OFS"): 30,
    Place("PWMCONF", "PWM_GRAD"): 0,
    Place("PWMCONF", "PWM_REG"): 8,
    Place("PWMCONF", "PWM_LIM"): 12,
    Place("PWMCONF", "pwm_freq"): 0,
    Place("CHOPCONF", "tbl"): 1,
}
AMPLITUDE = AmplitudePlaces(
    before=_BEGIN,
    tuned={**_BEGIN, Place("PWMCONF", "pwm_autoscale"): 1},
    at_rest="PWM_OFS_AUTO",
    now="PWM_SCALE_SUM",
    # 374 = 256 sqrt(2) 256 / 248, of an RMS voltage (7.4).
    full_scale_v=248 / 256 / 256,
    # 24 clocks (tbl 1) of 1024 / 2 (pwm_freq 0): what is shorter is not measured (7.3.1).
    least_duty=24 * 2 / 1024,
)
