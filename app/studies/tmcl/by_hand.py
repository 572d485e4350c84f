"""What of a TMCL module is tuned by hand beside speed and acceleration: SixPoint, currents, choppers, StallGuard."""

from __future__ import annotations

from ..field_settings import Place
from ..scored_move.places import HandPlace

BY_HAND = tuple(
    HandPlace(name.replace("_", " "), Place(name))
    for name in (
        *("velocity_vstart", "acceleration_a1", "velocity_v1", "maximum_deceleration", "deceleration_d1"),
        *("velocity_vstop", "maximum_current", "standby_current", "global_current_scaler", "chopper_off_time"),
        *("chopper_hysteresis_start", "chopper_hysteresis_end", "chopper_blank_time", "pwm_threshold_speed"),
        *("pwm_gradient", "pwm_amplitude", "stallguard2_threshold", "stallguard2_filter_enable", "stop_on_stall"),
    )
)
