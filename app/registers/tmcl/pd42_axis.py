"""Axis parameters of the PD42-1241 (SAP, GAP). Sources: see `pd42`."""

from __future__ import annotations

from dataclasses import replace
from typing import Unpack

from ..build import RW, R
from ..model import DriverPlace, Field, Particulars, Register
from .build import Parameters

NO_RIPPLE = "the emulated chopper is a lag of first order without ripple"
MANUAL = "FM-PD42-1241"
INT32 = (-(1 << 31), (1 << 31) - 1)
_SPEED_MAX = 7_999_774
_SPEED = (0, _SPEED_MAX)
_SPEED_INTERNAL = (0, (1 << 23) - 512)
_ACCELERATION = (117, 7_629_278)
_ACCELERATION_INTERNAL = (1, 0xFFFF)
_MODES = {
    **{mode: f"mode {mode}" for mode in range(1, 9)},
    **{mode + 64: f"mode {mode}, sides swapped" for mode in range(1, 5)},
    **{mode + 128: f"mode {mode}, home inverted" for mode in range(5, 9)},
}

_motion = Parameters("motion", f"{MANUAL} 4")
_ramp = Parameters("ramp", f"{MANUAL} 7.5")
_current = Parameters("current", f"{MANUAL} 4")
_switches = Parameters("switches", f"{MANUAL} 4")
_motor = Parameters("motor", f"{MANUAL} 6.1")
_chopper = Parameters("chopper", f"{MANUAL} 4")
_stealthchop = Parameters("stealthchop", f"{MANUAL} 4")
_stallguard = Parameters("stallguard", f"{MANUAL} 7.2")
_coolstep = Parameters("coolstep", f"{MANUAL} 7.3")
_encoder = Parameters("encoder", f"{MANUAL} 6.2")
_reference_search = Parameters("reference search", f"{MANUAL} 7.1")
_step_dir = Parameters("step/dir", f"{MANUAL} 6.4")


def _speed(
    group: Parameters,
    number: int,
    name: str,
    help_: str,
    limits: tuple[int, int] = _SPEED,
    internal: tuple[int, int] = _SPEED_INTERNAL,
    **particulars: Unpack[Particulars],
) -> Register:
    row = group(number, name, RW, limits, help_, unit="pps", internal_range=internal)
    return replace(row, **particulars)


def _acceleration(number: int, name: str, help_: str) -> Register:
    row = _ramp(number, name, RW, _ACCELERATION, help_)
    return row.having(unit="pps^2", internal_range=_ACCELERATION_INTERNAL)


def _bit(lsb: int, name: str, help_: str) -> Field:
    return Field(name=name, width=1, help=help_, lsb=lsb, access=R, reset=None)


_ROWS = (
    # --- motion -----------------------------------------------------------------------------------
    _motion(
        0, "target_position", RW, INT32, "where a positioning move goes; writing it starts one, as MVP does"
    ).having(unit="microsteps", reset=0, source=f"{MANUAL} 3.6.4", volatile=True),
    _motion(
        1, "actual_position", RW, INT32, "position counter; write it only at standstill, to say where the motor is"
    ).having(unit="microsteps", reset=0, volatile=True),
    _motion(
        2,
        "target_speed",
        RW,
        (-_SPEED_MAX, _SPEED_MAX),
        "speed that ROR, ROL and MST go for; writing it turns the motor",
    ).having(
        unit="pps",
        reset=0,
        internal_range=(-_SPEED_INTERNAL[1], _SPEED_INTERNAL[1]),
        volatile=True,
        source=f"{MANUAL} 3.6.1",
    ),
    _motion(3, "actual_speed", R, (-_SPEED_MAX, _SPEED_MAX), "speed of the ramp generator").having(
        unit="pps", internal_range=(-_SPEED_INTERNAL[1], _SPEED_INTERNAL[1])
    ),
    _motion(8, "position_reached_flag", R, (0, 1), "1 while the actual position is the target"),
    _motion(29, "measured_speed", R, _SPEED, "speed as the driver sees its steps").having(
        unit="pps", internal_range=_SPEED_INTERNAL
    ),
    _motion(127, "relative_positioning_option", RW, (0, 1), "what MVP REL counts from").having(
        values={0: "last target", 1: "actual position"}, reset=0, source=f"{MANUAL} 3.6.4"
    ),
    # --- ramp -------------------------------------------------------------------------------------
    _speed(_ramp, 4, "maximum_positioning_speed", "speed of a move between its ramps (VMAX)"),
    _acceleration(
        5, "maximum_acceleration", "from V1 to the positioning speed (AMAX); in velocity mode both up and down"
    ),
    _acceleration(15, "acceleration_a1", "from VSTART to V1, in positioning alone (A1)"),
    _speed(
        _ramp,
        16,
        "velocity_v1",
        "where the first acceleration ends and the last deceleration begins; 0 makes the ramp a trapezoid",
        (0, 1_000_000),
        (0, (1 << 20) - 1),
    ).having(reset=0),
    _acceleration(17, "maximum_deceleration", "from the positioning speed to V1, in positioning alone (DMAX)"),
    _acceleration(18, "deceleration_d1", "from V1 to VSTOP, in positioning alone (D1)"),
    _speed(
        _ramp,
        19,
        "velocity_vstart",
        "speed that a motion starts with; not above VSTOP",
        (0, 249_999),
        (0, (1 << 18) - 1),
    ),
    _speed(_ramp, 20, "velocity_vstop", "speed that a motion ends with; 10 or more", (0, 249_999), (0, (1 << 18) - 1)),
    _ramp(
        21, "ramp_wait_time", RW, (0, 0xFFFF), "pause at standstill before the next move or the way back", unit="32 us"
    ),
    # --- current ----------------------------------------------------------------------------------
    _current(
        6, "maximum_current", RW, (0, 255), "current while the motor runs; the driver makes 32 steps of it"
    ).having(unit="1/255"),
    _current(7, "standby_current", RW, (0, 255), "current at standstill, after the power down delay", unit="1/255"),
    _current(
        31, "power_down_ramp", RW, (0, 15), "how long a step of the current takes on the way down to standby"
    ).having(unit="16.384 ms"),
    _current(
        178, "global_current_scaler", RW, (0, 255), "scales every current; 0 is full scale, 1..31 are not allowed"
    ).having(unit="1/256"),
    _current(
        204, "freewheeling_mode", RW, (0, 3), "what the coils do at standstill, with standby current 0 and StealthChop"
    ).having(values={0: "normal", 1: "free", 2: "short to ground", 3: "short to supply"}, reset=0),
    _current(214, "power_down_delay", RW, (0, 417), "wait at standstill before the current goes down", unit="10 ms"),
    # --- switches ---------------------------------------------------------------------------------
    _switches(9, "home_switch_state", R, (0, 1), "home input, 1 active"),
    _switches(10, "right_limit_switch_state", R, (0, 1), "right stop input, 1 active"),
    _switches(11, "left_limit_switch_state", R, (0, 1), "left stop input, 1 active"),
    _switches.switch(
        12, "right_limit_switch_disable", "1: the right switch does not stop the motor", source=f"{MANUAL} 7.1", reset=0
    ),
    _switches.switch(
        13, "left_limit_switch_disable", "1: the left switch does not stop the motor", source=f"{MANUAL} 7.1", reset=0
    ),
    _switches.switch(14, "swap_limit_switches", "1: left and right input change places", reset=0),
    _switches.switch(24, "right_limit_switch_polarity", "1 inverts the right input", reset=0),
    _switches.switch(25, "left_limit_switch_polarity", "1 inverts the left input", reset=0),
    _switches.switch(26, "soft_stop_enable", "1: slow down at a switch instead of stopping dead", reset=0),
    # --- motor ------------------------------------------------------------------------------------
    _motor(140, "microstep_resolution", RW, (0, 8), "microsteps of a full step; the encoders follow it").having(
        values={n: f"{1 << n}" for n in range(9)}, reset=8
    ),
    _motor(202, "motor_fullstep_resolution", RW, (0, 32768), "full steps of a turn of the motor").having(
        unit="full steps", reset=200
    ),
    _motor.switch(251, "reverse_shaft", "1 turns the motor the other way round", source=f"{MANUAL} 4", reset=0),
    _motor(255, "unit_mode", RW, (0, 1), "what speeds and accelerations count in").having(
        values={0: "units of the driver chip", 1: "pps"}, reset=1, source=f"{MANUAL} 7.4"
    ),
    # --- chopper ----------------------------------------------------------------------------------
    _chopper.switch(27, "high_speed_chopper_mode", "1: constant off time above the speed threshold (AP 22)", reset=0),
    _chopper.switch(28, "high_speed_fullstep_mode", "1: full steps above the speed threshold (AP 22)", reset=0),
    _chopper.switch(160, "step_interpolation_enable", "1 makes 256 microsteps of coarser ones", reset=0),
    _chopper(162, "chopper_blank_time", RW, (0, 3), "how long the comparator is blind after switching").having(
        values={0: "16 clocks", 1: "24 clocks", 2: "36 clocks", 3: "54 clocks"}
    ),
    _chopper(163, "constant_toff_mode", RW, (0, 1), "chopper mode", values={0: "SpreadCycle", 1: "constant off time"}),
    _chopper.switch(
        164, "disable_fast_decay_comparator", "1: with constant off time, fast decay ends by time alone"
    ).having(behaviour=NO_RIPPLE, reset=0),
    _chopper(
        165, "chopper_hysteresis_end", RW, (0, 15), "end of the hysteresis; with constant off time the fast decay time"
    ),
    _chopper(
        166,
        "chopper_hysteresis_start",
        RW,
        (0, 8),
        "start of the hysteresis; with constant off time the offset of the sine",
    ),
    _chopper(167, "chopper_off_time", RW, (0, 15), "slow decay, 12 + 32 n clocks; 0 switches the driver off"),
    _chopper.switch(184, "random_toff_mode", "1 varies the off time at random", behaviour=NO_RIPPLE, reset=0),
    _chopper(
        185,
        "chopper_synchronization",
        RW,
        (0, 15),
        "bits 20..23 of CHOPCONF; of the TMC5160 the passive fast decay time",
    ).having(behaviour=NO_RIPPLE),
    _speed(_chopper, 23, "minimum_speed_for_dcstep", "DcStep works above this speed (VDCMIN)"),
    _chopper(32, "dcstep_time", RW, (0, 1023), "pulse width with which DcStep measures the load"),
    _chopper(33, "dcstep_stallguard", RW, (0, 255), "how soon DcStep calls a load a stall; more is sooner"),
    # --- StealthChop ------------------------------------------------------------------------------
    _speed(_stealthchop, 186, "pwm_threshold_speed", "StealthChop works below this speed (TPWMTHRS)"),
    _stealthchop(
        187, "pwm_gradient", RW, (0, 255), "how the PWM amplitude grows with speed; 0 switches StealthChop off", reset=0
    ),
    _stealthchop(188, "pwm_amplitude", RW, (0, 255), "PWM amplitude at standstill; above 64"),
    _stealthchop(189, "pwm_scale", R, (0, 255), "PWM amplitude now"),
    _stealthchop(190, "pwm_mode", R, (0, 1), "1 while StealthChop works"),
    _stealthchop(191, "pwm_frequency", RW, (0, 3), "code of the PWM frequency; higher is faster"),
    _stealthchop.switch(192, "pwm_autoscale", "1: the driver finds the amplitude for the current itself", reset=1),
    # --- StallGuard -------------------------------------------------------------------------------
    _stallguard.switch(173, "stallguard2_filter_enable", "1: one value every four full steps, less noise", reset=0),
    _stallguard(174, "stallguard2_threshold", RW, (-64, 63), "moves the load value; less is more sensitive", reset=0),
    _speed(
        _stallguard, 181, "stop_on_stall", "above this speed a load value of 0 stops the motor; 0 switches it off"
    ).having(reset=0),
    _stallguard(206, "actual_load_value", R, (0, 1023), "StallGuard2; 0 is the highest load"),
    _stallguard(
        207, "extended_error_flags", R, (0, 3), "what stopped the motor; reading clears it, so does the next motion"
    ).having(
        _bit(0, "stallguard_stop", "StallGuard stopped the motor"),
        _bit(1, "deviation_stop", "an encoder deviation stopped the motor"),
        signed=False,
        read_clears=True,
    ),
    _stallguard(208, "driver_error_flags", R, (0, 255), "bits 24..31 of the driver's DRV_STATUS").having(
        _bit(0, "stallguard", "load value 0 now"),
        _bit(1, "overtemperature", "too hot, switched off"),
        _bit(2, "overtemperature_warning", "hot"),
        _bit(3, "short_to_ground_a", "coil A shorted to ground"),
        _bit(4, "short_to_ground_b", "coil B shorted to ground"),
        _bit(5, "open_load_a", "no current through coil A"),
        _bit(6, "open_load_b", "no current through coil B"),
        _bit(7, "standstill", "no step for some time"),
        signed=False,
        source=f"{MANUAL} 4",
    ),
    # --- CoolStep ---------------------------------------------------------------------------------
    _coolstep(
        168, "smartenergy_current_minimum", RW, (0, 1), "how far CoolStep lowers the run current (SEIMIN)"
    ).having(values={0: "1/2", 1: "1/4"}),
    _coolstep(
        169, "smartenergy_current_down_step", RW, (0, 3), "load values above the upper threshold for one step down"
    ).having(values={0: "32", 1: "8", 2: "2", 3: "1"}),
    _coolstep(170, "smartenergy_hysteresis", RW, (0, 15), "upper threshold is (AP 172 + this + 1) * 32"),
    _coolstep(
        171, "smartenergy_current_up_step", RW, (0, 3), "steps up for each load value below the lower threshold"
    ).having(values={0: "1", 1: "2", 2: "4", 3: "8"}),
    _coolstep(
        172, "smartenergy_hysteresis_start", RW, (0, 15), "lower threshold is 32 times this; 0 switches CoolStep off"
    ).having(reset=0),
    _coolstep(
        180, "smartenergy_actual_current", R, (0, 31), "current that CoolStep has chosen, (n + 1)/32 of the scale"
    ),
    _speed(_coolstep, 182, "smartenergy_threshold_speed", "CoolStep works above this speed (TCOOLTHRS)"),
    _speed(
        _coolstep,
        22,
        "speed_threshold_coolstep_fullstep",
        "above it CoolStep and StealthChop end, and full steps begin where enabled (THIGH)",
        (0, 16_777_215),
        (0, 16_777_215),
    ).having(reset=16_777_215),
    # --- encoder ----------------------------------------------------------------------------------
    _encoder(209, "encoder_position", RW, INT32, "counter of the built-in encoder, scaled to microsteps").having(
        unit="microsteps", volatile=True
    ),
    _encoder.switch(
        210, "encoder_clear_on_null", "1: the counter is cleared at the next null, then this is 0 again"
    ).having(volatile=True, reset=0),
    _encoder(
        212,
        "maximum_encoder_deviation",
        RW,
        (0, (1 << 31) - 1),
        "stops the motor where the built-in encoder differs more from the position; 0 switches it off",
    ).having(unit="microsteps", reset=0),
    _encoder(215, "absolute_encoder_value", R, (0, 1023), "angle of the shaft, of one turn", unit="1/1024 turn"),
    _encoder(
        216, "external_encoder_position", RW, INT32, "counter of the external encoder, scaled to microsteps"
    ).having(unit="microsteps", volatile=True, source=f"{MANUAL} 6.3"),
    _encoder(
        217,
        "external_encoder_resolution",
        RW,
        (0, 1_000_000),
        "counts of a turn: four times the lines; no source tells its limit",
    ).having(unit="counts", source=f"{MANUAL} 6.3"),
    _encoder(
        218,
        "external_encoder_maximum_deviation",
        RW,
        (0, (1 << 31) - 1),
        "stops the motor where the external encoder differs more from the position; 0 switches it off",
    ).having(unit="microsteps", reset=0, source=f"{MANUAL} 6.3"),
    # --- reference search -------------------------------------------------------------------------
    _reference_search(193, "reference_search_mode", RW, (1, 136), "which switch is looked for and how", values=_MODES),
    _speed(_reference_search, 194, "reference_search_speed", "speed until the switch is found for the first time"),
    _speed(_reference_search, 195, "reference_switch_speed", "speed for finding its edges"),
    _reference_search(
        196, "end_switch_distance", R, INT32, "distance between the stop switches, after modes 2 and 3"
    ).having(unit="microsteps", source=f"{MANUAL} 7.1.2"),
    _reference_search(
        197, "last_reference_position", R, INT32, "where the counter stood before the search set it to 0"
    ).having(unit="microsteps"),
    # --- step/direction ---------------------------------------------------------------------------
    _step_dir.switch(161, "double_edge_steps", "1: both edges of the step input count", reset=0),
    _step_dir.switch(254, "step_direction_mode", "1: inputs move the motor; ROR, ROL, MVP and MST do nothing", reset=0),
)

_DRIVER = {
    4: DriverPlace("VMAX"),
    5: DriverPlace("AMAX"),
    6: DriverPlace("IHOLD_IRUN", "IRUN", 8),
    7: DriverPlace("IHOLD_IRUN", "IHOLD", 8),
    15: DriverPlace("A1"),
    16: DriverPlace("V1"),
    17: DriverPlace("DMAX"),
    18: DriverPlace("D1"),
    19: DriverPlace("VSTART"),
    20: DriverPlace("VSTOP"),
    21: DriverPlace("TZEROWAIT"),
    22: DriverPlace("THIGH"),
    27: DriverPlace("CHOPCONF", "vhighchm"),
    28: DriverPlace("CHOPCONF", "vhighfs"),
    31: DriverPlace("IHOLD_IRUN", "IHOLDDELAY"),
    162: DriverPlace("CHOPCONF", "tbl"),
    163: DriverPlace("CHOPCONF", "chm"),
    165: DriverPlace("CHOPCONF", "hend"),
    166: DriverPlace("CHOPCONF", "hstrt", offset=1),
    167: DriverPlace("CHOPCONF", "toff"),
    178: DriverPlace("GLOBAL_SCALER"),
    182: DriverPlace("TCOOLTHRS"),
    185: DriverPlace("CHOPCONF", "tpfd"),
    186: DriverPlace("TPWMTHRS"),
    187: DriverPlace("PWMCONF", "PWM_GRAD"),
    188: DriverPlace("PWMCONF", "PWM_OFS"),
    191: DriverPlace("PWMCONF", "pwm_freq"),
    192: DriverPlace("PWMCONF", "pwm_autoscale"),
}
"""Registers of the TMC5160 by parameter, as names and units of both tell (AP 6 and 7: 32 steps
of 8; AP 166 counts from 1; AP 185: bits 20..23 of CHOPCONF)."""

AXIS_PARAMETERS = tuple(replace(row, driver=_DRIVER.get(row.address)) for row in _ROWS)
