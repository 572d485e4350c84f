"""Where a TMCL module keeps its chopper (FM-PD42-1241 4, FM-TMCM-1161 6)."""

from __future__ import annotations

from ..chopper.setting import ChopperPlaces
from ..field_settings import Place
from ..tmc5xxx.chopper import CHOPPER as DRIVERS_CHOPPER
from ..tmc5xxx.chopper import SheetCalculator

CHOPPER = ChopperPlaces(
    off=Place("chopper_off_time"),
    blank=Place("chopper_blank_time"),
    start=Place("chopper_hysteresis_start"),
    end=Place("chopper_hysteresis_end"),
    blanks=DRIVERS_CHOPPER.blanks,
    # StealthChop off, DcStep, and CoolStep: it would change the current under way.
    fixed={
        Place("constant_toff_mode"): 0,
        Place("high_speed_chopper_mode"): 0,
        Place("high_speed_fullstep_mode"): 0,
        Place("smartenergy_hysteresis_start"): 0,
        Place("pwm_gradient"): 0,
        Place("minimum_speed_for_dcstep"): 0,
    },
    # Also for a TMC262: its parameters have the same numbers (FM-TMCM-1161 6).
    calculator=SheetCalculator("tmc5160"),
)
