"""Where a TMCL module keeps what its StallGuard works by (FM-PD42-1241 7.2)."""

from __future__ import annotations

from ..field_settings import Place
from ..stallguard.setting import StallPlaces

STALL = (
    StallPlaces(
        generation=2,
        threshold=Place("stallguard2_threshold"),
        filter=Place("stallguard2_filter_enable"),
        armed=("stop_on_stall",),
        # CoolStep would change the current, and with it every value; with StealthChop there is none.
        fixed=((Place("smartenergy_hysteresis_start"), 0), (Place("pwm_gradient"), 0)),
    ),
)
