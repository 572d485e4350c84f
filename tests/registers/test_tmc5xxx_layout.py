"""Bits of the TMC5xxx's words, written down a second time from the fact sheets.

Written as there: bit, or highest:lowest, then the name; a minus behind it: signed. Second meanings of bits, which
TMC5xxx have with another chopper, motor or pin SD_MODE, are among them.
"""

from __future__ import annotations

import re

import pytest

from app.registers.tmc5xxx.table import TABLES

LAYOUTS = [
    (
        "5031",
        "GCONF",
        """
        3 poscmp_enable, 7 test_mode, 8 shaft1, 9 shaft2, 10 lock_gconf
    """,
    ),
    (
        "5031 5062 5072",
        "GSTAT",
        """
        0 reset, 1 drv_err1, 2 drv_err2, 3 uv_cp
    """,
    ),
    (
        "5031",
        "TEST_SEL",
        """
        3:0 TEST_SEL
    """,
    ),
    (
        "5031",
        "INPUT",
        """
        7 DRV_ENN, 31:24 VERSION
    """,
    ),
    (
        "5031 5062 5072 5130 5160",
        "IHOLD_IRUN",
        """
        4:0 IHOLD, 12:8 IRUN, 19:16 IHOLDDELAY
    """,
    ),
    (
        "5031",
        "SW_MODE",
        """
        0 stop_l_enable, 1 stop_r_enable, 2 pol_stop_l, 3 pol_stop_r, 4 swap_lr, 5 latch_l_active, 6
        latch_l_inactive, 7 latch_r_active, 8 latch_r_inactive, 10 sg_stop, 11 en_softstop
    """,
    ),
    (
        "5031 5062 5072 5130 5160",
        "RAMP_STAT",
        """
        0 status_stop_l, 1 status_stop_r, 2 status_latch_l, 3 status_latch_r, 4 event_stop_l, 5 event_stop_r, 6
        event_stop_sg, 7 event_pos_reached, 8 velocity_reached, 9 position_reached, 10 vzero, 11
        t_zerowait_active, 12 second_move, 13 status_sg
    """,
    ),
    (
        "5031 5062 5072 5130 5160",
        "MSLUTSEL",
        """
        1:0 W0, 3:2 W1, 5:4 W2, 7:6 W3, 15:8 X1, 23:16 X2, 31:24 X3
    """,
    ),
    (
        "5031 5062",
        "MSLUTSTART",
        """
        7:0 START_SIN, 23:16 START_SIN90_120
    """,
    ),
    (
        "5031 5062 5072 5130 5160",
        "MSCURACT",
        """
        8:0 CUR_B-, 24:16 CUR_A-
    """,
    ),
    (
        "5031",
        "CHOPCONF",
        """
        3:0 toff, 6:4 hstrt, 6:4 tfd_2_0, 10:7 hend, 10:7 offset, 11 fd3, 12 disfdcc, 13 rndtf, 14 chm, 16:15 tbl,
        17 vsense, 18 vhighfs, 19 vhighchm, 23:20 sync, 30 diss2g
    """,
    ),
    (
        "5031 5062 5072 5130 5160",
        "COOLCONF",
        """
        3:0 semin, 6:5 seup, 11:8 semax, 14:13 sedn, 15 seimin, 22:16 sgt-, 24 sfilt
    """,
    ),
    (
        "5031 5062 5072 5130",
        "DRV_STATUS",
        """
        9:0 SG_RESULT, 15 fsactive, 20:16 CS_ACTUAL, 24 StallGuard, 25 ot, 26 otpw, 27 s2ga, 28 s2gb, 29 ola, 30
        olb, 31 stst
    """,
    ),
    (
        "5062",
        "GCONF",
        """
        3 poscmp_enable, 4 enc1_refsel, 5 enc2_enable, 6 enc2_refsel, 7 test_mode, 8 shaft1, 9 shaft2, 10
        lock_gconf
    """,
    ),
    (
        "5062",
        "SLAVECONF",
        """
        3:0 TEST_SEL, 7:4 SENDDELAY
    """,
    ),
    (
        "5062",
        "INPUT",
        """
        0 io0_in, 1 io1_in, 2 io2_in, 3 io3_in, 4 iop_in, 5 ion_in, 7 DRV_ENN, 31:24 VERSION
    """,
    ),
    (
        "5062",
        "OUTPUT",
        """
        0 io0_out, 1 io1_out, 2 io2_out, 3 io3_out, 8 ioddr0, 9 ioddr1, 10 ioddr2, 11 ioddr3
    """,
    ),
    (
        "5062 5072 5130 5160",
        "SW_MODE",
        """
        0 stop_l_enable, 1 stop_r_enable, 2 pol_stop_l, 3 pol_stop_r, 4 swap_lr, 5 latch_l_active, 6
        latch_l_inactive, 7 latch_r_active, 8 latch_r_inactive, 9 en_latch_encoder, 10 sg_stop, 11 en_softstop
    """,
    ),
    (
        "5062 5130 5160",
        "ENCMODE",
        """
        0 pol_A, 1 pol_B, 2 pol_N, 3 ignore_AB, 4 clr_cont, 5 clr_once, 6 pos_edge, 7 neg_edge, 8 clr_enc_x, 9
        latch_x_act, 10 enc_sel_decimal
    """,
    ),
    (
        "5062 5072 5130 5160",
        "ENC_CONST",
        """
        15:0 FRACTIONAL, 31:16 INTEGER-
    """,
    ),
    (
        "5062 5072 5130",
        "ENC_STATUS",
        """
        0 n_event
    """,
    ),
    (
        "5062",
        "CHOPCONF",
        """
        3:0 toff, 6:4 hstrt, 6:4 tfd_2_0, 10:7 hend, 10:7 offset, 11 fd3, 12 disfdcc, 13 rndtf, 14 chm, 16:15 tbl,
        17 vsense, 18 vhighfs, 19 vhighchm, 23:20 sync, 27:24 mres, 28 intpol16, 30 diss2g, 31 ph3sel, 9:4 hyst,
        10 nosd3ph, 12 csync
    """,
    ),
    (
        "5062 5072",
        "DCCTRL",
        """
        7:0 DC_TIME, 15:8 DC_SG
    """,
    ),
    (
        "5072",
        "GCONF",
        """
        0 single_driver, 1 stepdir1_enable, 2 stepdir2_enable, 3 poscmp_enable, 4 enc1_refsel, 5 enc2_enable, 6
        enc2_refsel, 7 test_mode, 8 shaft1, 9 shaft2, 10 lock_gconf, 11 dc_sync
    """,
    ),
    (
        "5072 5130 5160",
        "NODECONF",
        """
        7:0 NODEADDR, 11:8 SENDDELAY
    """,
    ),
    (
        "5072",
        "INPUT",
        """
        0 io0_in, 1 io1_in, 2 io2_in, 3 io3_in, 4 iop_in, 5 ion_in, 6 nextaddr_in, 7 drv_enn_in, 8 sw_comp_in,
        31:24 VERSION
    """,
    ),
    (
        "5072",
        "OUTPUT",
        """
        0 io0_out, 1 io1_out, 2 io2_out, 8 ioddr0, 9 ioddr1, 10 ioddr2
    """,
    ),
    (
        "5072",
        "PWMCONF",
        """
        7:0 PWM_AMPL, 15:8 PWM_GRAD, 17:16 pwm_freq, 18 pwm_autoscale, 21:20 freewheel
    """,
    ),
    (
        "5072",
        "ENCMODE",
        """
        0 pol_A, 1 pol_B, 2 pol_N, 3 ignore_AB, 4 clr_cont, 5 clr_once, 6 pos_edge, 7 neg_edge, 8 clr_enc_x, 9
        latch_x_act, 10 enc_sel_decimal, 11 latch_now
    """,
    ),
    (
        "5072 5130 5160",
        "MSLUTSTART",
        """
        7:0 START_SIN, 23:16 START_SIN90
    """,
    ),
    (
        "5072",
        "CHOPCONF",
        """
        3:0 toff, 6:4 hstrt, 6:4 tfd_2_0, 10:7 hend, 10:7 offset, 11 fd3, 12 disfdcc, 13 rndtf, 14 chm, 16:15 tbl,
        17 vsense, 18 vhighfs, 19 vhighchm, 27:24 mres, 28 intpol16, 29 dedge, 30 diss2g
    """,
    ),
    (
        "5130",
        "GCONF",
        """
        0 I_scale_analog, 1 internal_Rsense, 2 en_pwm_mode, 3 enc_commutation, 4 shaft, 5 diag0_error, 6
        diag0_otpw, 7 diag0_stall, 7 diag0_step, 8 diag1_stall, 8 diag1_dir, 9 diag1_index, 10 diag1_onstate, 11
        diag1_steps_skipped, 12 diag0_int_pushpull, 13 diag1_poscomp_pushpull, 14 small_hysteresis, 15
        stop_enable, 16 direct_mode, 17 test_mode
    """,
    ),
    (
        "5130 5160",
        "GSTAT",
        """
        0 reset, 1 drv_err, 2 uv_cp
    """,
    ),
    (
        "5130",
        "IOIN",
        """
        0 REFL_STEP, 1 REFR_DIR, 2 ENCB_DCEN_CFG4, 3 ENCA_DCIN_CFG5, 4 DRV_ENN_CFG6, 5 ENC_N_DCO, 6 SD_MODE, 7
        SWCOMP_IN, 31:24 VERSION
    """,
    ),
    (
        "5130 5160",
        "OUTPUT",
        """
        0 OUTPUT_PIN_POLARITY
    """,
    ),
    (
        "5130",
        "CHOPCONF",
        """
        3:0 toff, 6:4 hstrt, 6:4 tfd_2_0, 10:7 hend, 10:7 offset, 11 fd3, 12 disfdcc, 13 rndtf, 14 chm, 16:15 tbl,
        17 vsense, 18 vhighfs, 19 vhighchm, 23:20 sync, 27:24 mres, 28 intpol, 29 dedge, 30 diss2g
    """,
    ),
    (
        "5130 5160",
        "DCCTRL",
        """
        9:0 DC_TIME, 23:16 DC_SG
    """,
    ),
    (
        "5130",
        "PWMCONF",
        """
        7:0 PWM_AMPL, 15:8 PWM_GRAD, 17:16 pwm_freq, 18 pwm_autoscale, 19 pwm_symmetric, 21:20 freewheel
    """,
    ),
    (
        "5130",
        "ENCM_CTRL",
        """
        0 inv, 1 maxspeed
    """,
    ),
    (
        "5160",
        "GCONF",
        """
        0 recalibrate, 1 faststandstill, 2 en_pwm_mode, 3 multistep_filt, 4 shaft, 5 diag0_error, 6 diag0_otpw, 7
        diag0_stall, 7 diag0_step, 8 diag1_stall, 8 diag1_dir, 9 diag1_index, 10 diag1_onstate, 11
        diag1_steps_skipped, 12 diag0_int_pushpull, 13 diag1_poscomp_pushpull, 14 small_hysteresis, 15
        stop_enable, 16 direct_mode, 17 test_mode
    """,
    ),
    (
        "5160",
        "IOIN",
        """
        0 REFL_STEP, 1 REFR_DIR, 2 ENCB_DCEN_CFG4, 3 ENCA_DCIN_CFG5, 4 DRV_ENN, 5 ENC_N_DCO_CFG6, 6 SD_MODE, 7
        SWCOMP_IN, 31:24 VERSION
    """,
    ),
    (
        "5160",
        "OTP_PROG",
        """
        2:0 OTPBIT, 5:4 OTPBYTE, 15:8 OTPMAGIC
    """,
    ),
    (
        "5160",
        "OTP_READ",
        """
        4:0 OTP_FCLKTRIM, 5 otp_S2_LEVEL, 6 otp_BBM, 7 otp_TBL
    """,
    ),
    (
        "5160",
        "FACTORY_CONF",
        """
        4:0 FCLKTRIM
    """,
    ),
    (
        "5160",
        "SHORT_CONF",
        """
        3:0 S2VS_LEVEL, 11:8 S2G_LEVEL, 17:16 SHORTFILTER, 18 shortdelay
    """,
    ),
    (
        "5160",
        "DRV_CONF",
        """
        4:0 BBMTIME, 11:8 BBMCLKS, 17:16 OTSELECT, 19:18 DRVSTRENGTH, 21:20 FILT_ISENSE
    """,
    ),
    (
        "5160",
        "OFFSET_READ",
        """
        7:0 OFFSET_READ_B-, 15:8 OFFSET_READ_A-
    """,
    ),
    (
        "5160",
        "ENC_STATUS",
        """
        0 n_event, 1 deviation_warn
    """,
    ),
    (
        "5160",
        "CHOPCONF",
        """
        3:0 toff, 6:4 hstrt, 6:4 tfd_2_0, 10:7 hend, 10:7 offset, 11 fd3, 12 disfdcc, 14 chm, 16:15 tbl, 18
        vhighfs, 19 vhighchm, 23:20 tpfd, 27:24 mres, 28 intpol, 29 dedge, 30 diss2g, 31 diss2vs
    """,
    ),
    (
        "5160",
        "DRV_STATUS",
        """
        9:0 SG_RESULT, 12 s2vsa, 13 s2vsb, 14 stealth, 15 fsactive, 20:16 CS_ACTUAL, 24 StallGuard, 25 ot, 26
        otpw, 27 s2ga, 28 s2gb, 29 ola, 30 olb, 31 stst
    """,
    ),
    (
        "5160",
        "PWMCONF",
        """
        7:0 PWM_OFS, 15:8 PWM_GRAD, 17:16 pwm_freq, 18 pwm_autoscale, 19 pwm_autograd, 21:20 freewheel, 27:24
        PWM_REG, 31:28 PWM_LIM
    """,
    ),
    (
        "5160",
        "PWM_SCALE",
        """
        7:0 PWM_SCALE_SUM, 24:16 PWM_SCALE_AUTO-
    """,
    ),
    (
        "5160",
        "PWM_AUTO",
        """
        7:0 PWM_OFS_AUTO, 23:16 PWM_GRAD_AUTO
    """,
    ),
]


@pytest.mark.parametrize(
    ("model", "name", "layout"),
    [(f"tmc{number}", name, layout) for numbers, name, layout in LAYOUTS for number in numbers.split()],
)
def test_bits_are_where_the_facts_have_them(model: str, name: str, layout: str) -> None:
    wanted = {}
    for highest, lowest, field, minus in re.findall(r"(\d+)(?::(\d+))?\s+([^\s,-]+)(-?)", layout):
        lsb = int(lowest or highest)
        wanted[field] = (lsb, int(highest) - lsb + 1, bool(minus))
    parts = TABLES[model].get(name, 0).fields
    assert {part.name: (part.lsb, part.width, part.signed) for part in parts} == wanted


@pytest.mark.parametrize("model", ["tmc5031", "tmc5062", "tmc5072", "tmc5130", "tmc5160"])
def test_no_word_with_parts_is_left_out(model: str) -> None:
    told = {name for numbers, name, _ in LAYOUTS if model.removeprefix("tmc") in numbers.split()}
    assert told == {row.name for row in TABLES[model] if row.fields}


@pytest.mark.parametrize("model", list(TABLES))
def test_a_bit_says_what_0_and_1_mean(model: str) -> None:
    for row in TABLES[model]:
        for part in row.fields:
            assert part.width > 1 or len(part.values) == 2 or part.name == "fd3", (row.name, part.name)
