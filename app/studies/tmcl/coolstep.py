"""Where a TMCL module keeps CoolStep (FM-PD42-1241 7.3)."""

from __future__ import annotations

from ..field_settings import Place
from ..least_current.cool_setting import CoolPlaces

COOLSTEP = CoolPlaces(
    lower=Place("smartenergy_hysteresis_start"),
    width=Place("smartenergy_hysteresis"),
    up=Place("smartenergy_current_up_step"),
    down=Place("smartenergy_current_down_step"),
    least=Place("smartenergy_current_minimum"),
    level=Place("stallguard2_threshold"),
    armed=(Place("smartenergy_threshold_speed"),),
    stop=Place("stop_on_stall"),
    quiet=Place("pwm_gradient"),
)
