"""What the emulated TMC5xxx keep without acting on it, and why: in one place, since rows are shared by chips."""

from __future__ import annotations

from dataclasses import replace

from ..model import Register

LAG = "the emulated chopper is a lag of first order without ripple"
RIPPLE = "the emulated chopper acts on it with the option `ripple` of the emulated chip alone"
NO_PINS = "nothing is connected to the pins of the emulated chip that show this"
NO_STEP_DIR = "the emulated motors follow the ramp generators alone"
IDEAL_PWM = "the emulated StealthChop measures its currents alike, whatever the shape of its periods"
NO_SHORTS = "nothing is ever shorted"
NO_FUSES = "the emulated chip has no fuses"
OWN_CLOCK = "the emulated clock is as exact as the bench sets it"
OWN_SCALE = "the bench sets the emulated full scale"
TWO_PHASES = "the emulated motor has two phases"
FACTORY = "for the factory alone"
TWO_PHASES_APART = "the phases of the emulated driver are a quarter of a turn apart"
NO_PHASE_SHIFT = "the emulated driver has no shift of phase between its choppers"

_CHOPPER = ("disfdcc", "rndtf", "sync", "tpfd")
_DIAGNOSTICS = (
    *("diag0_error", "diag0_otpw", "diag0_stall", "diag0_step", "diag1_stall", "diag1_dir", "diag1_index"),
    *("diag1_onstate", "diag1_steps_skipped", "diag0_int_pushpull", "diag1_poscomp_pushpull", "stop_enable"),
    *("diag0_stall_step", "diag1_stall_dir", "length_step_pulse"),
)
_STEALTH = ("pwm_symmetric", "pwm_meas_sd_enable", "pwm_dis_reg_stst")
REGISTERS = {
    "SHORT_CONF": NO_SHORTS,
    "OTP_PROG": NO_FUSES,
    "FACTORY_CONF": OWN_CLOCK,
    "TEST_SEL": FACTORY,
    "ENCM_CTRL": FACTORY,
}
"""By name; of such a register no field does anything."""
FIELDS = {
    "DRV_CONF": dict.fromkeys(
        ("BBMTIME", "BBMCLKS", "OTSELECT", "DRVSTRENGTH", "FILT_ISENSE", "SLOPE_CONTROL", "BBM_CLKS"), LAG
    ),
    "GCONF": {
        **dict.fromkeys(_DIAGNOSTICS, NO_PINS),
        **dict.fromkeys(("stepdir1_enable", "stepdir2_enable", "small_hysteresis", "multistep_filt"), NO_STEP_DIR),
        **dict.fromkeys(("test_mode", "enc_commutation"), FACTORY),
        **dict.fromkeys(("I_scale_analog", "internal_Rsense", "recalibrate"), OWN_SCALE),
        "single_driver": "each emulated driver has a motor of its own",
        "direct_mode": NO_STEP_DIR,
        "dc_sync": "the emulated motors have DcStep each for itself",
    },
    "CHOPCONF": {
        **dict.fromkeys(_CHOPPER, LAG),
        **dict.fromkeys(("hstrt", "hend"), RIPPLE),
        **dict.fromkeys(("diss2g", "diss2vs"), NO_SHORTS),
        **dict.fromkeys(("ph3sel", "hyst", "nosd3ph", "csync"), TWO_PHASES),
        "dedge": NO_STEP_DIR,
    },
    "PWMCONF": dict.fromkeys(_STEALTH, IDEAL_PWM),
    "OTW_OV_VTH": {"OVERVOLTAGE_VTH": NO_PINS},
    "MSLUTSTART": {"OFFSET_SIN90": TWO_PHASES_APART},
    "SG4_THRS": {"sg_angle_offset": NO_PHASE_SHIFT},
    "SLAVECONF": {"TEST_SEL": FACTORY},
    "OUTPUT": {"OUTPUT_PIN_POLARITY": NO_PINS},
}
"""Register, field: why."""


def with_behaviour(row: Register) -> Register:
    """`row`, told of what the emulated chips do not do."""
    reasons = FIELDS.get(row.name, {})
    fields = tuple(replace(part, behaviour=reasons[part.name]) if part.name in reasons else part for part in row.fields)
    return replace(row, fields=fields, behaviour=REGISTERS.get(row.name, row.behaviour))
