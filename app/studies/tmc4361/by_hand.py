"""What of a TMC4361 is tuned by hand beside speed, acceleration and jerk: its ramp, its current scales, what it makes
of the steps at high speed, stops by a stall, and the gains of its regulation.

Some addresses mean something else while a regulation or a mode is on, and bear that name then (DS-TMC4361 14).
Whether a regulation is on is none of it: no profile switches it on.
"""

from __future__ import annotations

from ..field_settings import Place
from ..scored_move.places import Only, fields, whole

_MODUS = Place("ENC_IN_CONF", "regulation_modus")
_CLOSED_LOOP = Only(_MODUS, frozenset({1}))
_PID = Only(_MODUS, frozenset({0, 2, 3}))
_SCALES = Place("CURRENT_CONF", "closed_loop_scale_en")
_BY_DEVIATION = Only(_SCALES, frozenset({1}))
_BY_RAMP = Only(_SCALES, frozenset({0}))
_TMC24X = Only(Place("SPI_OUT_CONF", "spi_output_format"), frozenset({8, 9}))
_PWM = Only(Place("GENERAL_CONF", "pwm_out_en"), frozenset({1}))


BY_HAND = (
    *fields("RAMPMODE", "RAMP_PROFILE"),
    *whole("VSTART", "VSTOP", "VBREAK"),
    *fields("ASTART", "ASTART"),
    *whole("DMAX", "DFINAL", "BOW2", "BOW3", "BOW4", "TZEROWAIT"),
    *fields("GENERAL_CONF", "use_astart_and_vstart", "fs_en", "dcstep_mode", "pwm_out_en"),
    *fields("SCALE_VALUES", "boost_scale_val", "drv1_scale_val", "drv2_scale_val", "hold_scale_val", only=_BY_RAMP),
    *fields("SCALE_VALUES", "cl_imin", "cl_imax", "cl_start_up", "cl_start_dn", only=_BY_DEVIATION),
    *fields("CURRENT_CONF", "hold_current_scale_en", "drive_current_scale_en", "boost_current_on_acc_en"),
    *fields("CURRENT_CONF", "boost_current_on_dec_en", "boost_current_after_start_en", "sec_drive_current_scale_en"),
    *fields("CURRENT_CONF", "freewheeling_en", "closed_loop_scale_en", "pwm_scale_en"),
    *fields("CURRENT_CONF", "pwm_ampl", only=_PWM),
    *whole("FREEWHEEL_DELAY", "DRV_SCALE_DELAY", "BOOST_TIME"),
    *whole("VDRV_SCALE_LIMIT", "UP_SCALE_DELAY", "HOLD_SCALE_DELAY", only=_BY_RAMP),
    *whole("CL_UPSCALE_DELAY", "CL_DNSCALE_DELAY", only=_BY_DEVIATION),
    *whole("PWM_FREQ", only=_PWM),
    *whole("CHOPSYNC_DIV", only=_TMC24X),
    *fields("SPI_OUT_CONF", "mixed_decay", "stall_load_limit", only=_TMC24X),
    *fields("REFERENCE_CONF", "stop_on_stall"),
    *whole("VSTALL_LIMIT"),
    *whole("FS_VEL", "DC_TIME___DC_SG___DC_BLKTIME", "PID_P", "PID_I", "PID_D", "PID_TOLERANCE", only=_PID),
    *fields("PID_I_CLIP___PID_D_CLKDIV", "PID_I_CLIP", "PID_D_CLKDIV"),
    *whole("PID_DV_CLIP", "CL_TR_TOLERANCE"),
    *fields("ENC_IN_CONF", "cl_emf_en", "cl_vlimit_en", "cl_velocity_mode_en", "cl_clr_xact", only=_CLOSED_LOOP),
    *fields("CL_ANGLES", "CL_BETA", "CL_GAMMA", only=_CLOSED_LOOP),
    *whole("CL_DELTA_P", "CL_TOLERANCE", "CL_VMAX_CALC_P", "CL_VMAX_CALC_I", only=_CLOSED_LOOP),
    *whole("CL_VMIN_EMF", "CL_VADD_EMF", only=_CLOSED_LOOP),
    *fields("ENC_VMEAN", "ENC_VMEAN_WAIT", "ENC_VMEAN_FILTER", "ENC_VMEAN_INT"),
)
