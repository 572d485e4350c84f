"""What of a TMCL module is tuned by hand beside speed and acceleration: its ramp, currents, choppers, StallGuard and
CoolStep, as far as the module has them.

Not among it is what its parameters count in (unit mode, microstep resolution): all else would mean something other.
"""

from __future__ import annotations

from ..field_settings import Place
from ..scored_move.places import HandPlace

BY_HAND = tuple(
    HandPlace(name.replace("_", " "), Place(name))
    for name in (
        *("velocity_vstart", "acceleration_a1", "velocity_v1", "maximum_deceleration", "deceleration_d1"),
        *("velocity_vstop", "minimum_speed", "ramp_wait_time"),
        *("minimum_speed_for_dcstep", "dcstep_time", "dcstep_stallguard"),
        *("maximum_current", "standby_current", "boost_current", "global_current_scaler", "vsense"),
        *("power_down_ramp", "power_down_delay", "freewheeling_mode", "freewheeling_delay"),
        *("chopper_off_time", "chopper_hysteresis_start", "chopper_hysteresis_end", "chopper_hysteresis_decrement"),
        *("chopper_blank_time", "constant_toff_mode", "disable_fast_decay_comparator", "random_toff_mode"),
        *("chopper_synchronization", "step_interpolation_enable"),
        *("high_speed_chopper_mode", "high_speed_fullstep_mode", "speed_threshold_coolstep_fullstep"),
        *("pwm_threshold_speed", "pwm_gradient", "pwm_amplitude", "pwm_frequency", "pwm_autoscale"),
        *("stallguard2_threshold", "stallguard2_filter_enable", "stop_on_stall"),
        *("smartenergy_hysteresis_start", "smartenergy_hysteresis", "smartenergy_current_up_step"),
        *("smartenergy_current_down_step", "smartenergy_current_minimum", "smartenergy_threshold_speed"),
        "smartenergy_slow_run_current",
    )
)
