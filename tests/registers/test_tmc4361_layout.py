"""Bits of the TMC4361's configuration words, written down a second time from the fact sheets.

Our copy of the data sheet ends before its register chapter, so nothing printed holds these; two independent
transcriptions that agree are what there is. Written as there: bit, or highest:lowest, then the name.
"""

from __future__ import annotations

import re

import pytest

from app.registers.tmc4361.table import TMC4361

LAYOUTS = [
    pytest.param(
        "GENERAL_CONF",
        """0 use_astart_and_vstart, 1 direct_acc_val_en, 2 direct_bow_val_en, 3 step_inactive_pol, 4 toggle_step,
        5 pol_dir_out, 7:6 sdin_mode, 8 pol_dir_in, 9 sd_indirect_control, 11:10 serial_enc_in_mode,
        12 diff_enc_in_disable, 14:13 stdby_clk_pin_assignment, 15 intr_pol, 16 invert_pol_target_reached,
        17 clk_gating_en, 18 clk_gating_stdby_en, 19 fs_en, 20 fs_sdout, 22:21 dcstep_mode, 23 pwm_out_en,
        24 serial_enc_out_enable, 25 serial_enc_out_diff_disable, 26 automatic_direct_sdin_switch_off,
        27 circular_cnt_as_xlatch, 28 reverse_motor_dir, 29 intr_tr_pu_pd_en, 30 intr_as_wired_and,
        31 tr_as_wired_and""",
        marks=pytest.mark.sheet("DS-TMC4361", "17.1"),
    ),
    pytest.param(
        "REFERENCE_CONF",
        """0 stop_left_en, 1 stop_right_en, 2 pol_stop_left, 3 pol_stop_right, 4 invert_stop_direction, 5 soft_stop_en,
        6 virtual_left_limit_en, 7 virtual_right_limit_en, 9:8 virt_stop_mode, 10 latch_x_on_inactive_l,
        11 latch_x_on_active_l, 12 latch_x_on_inactive_r, 13 latch_x_on_active_r, 14 stop_left_is_home,
        15 stop_right_is_home, 19:16 home_event, 20 start_home_tracking, 21 clr_pos_at_target, 22 circular_movement_en,
        24:23 pos_comp_output, 25 pos_comp_source, 26 stop_on_stall, 27 drv_after_stall, 29:28 modified_pos_compare,
        30 automatic_cover, 31 circular_enc_en""",
        marks=pytest.mark.sheet("DS-TMC4361", "17.2"),
    ),
    pytest.param(
        "START_CONF",
        """0 start_en[0], 1 start_en[1], 2 start_en[2], 3 start_en[3], 4 start_en[4], 5 trigger_events[0],
        6 trigger_events[1], 7 trigger_events[2], 8 trigger_events[3], 9 pol_start_signal, 10 immediate_start_in,
        11 busy_state_en, 12 pipeline_en[0], 13 pipeline_en[1], 14 pipeline_en[2], 15 pipeline_en[3],
        17:16 shadow_option, 18 cyclic_shadow_regs, 23:20 shadow_miss_cnt, 24 xpipe_rewrite_reg[0],
        25 xpipe_rewrite_reg[1], 26 xpipe_rewrite_reg[2], 27 xpipe_rewrite_reg[3], 28 xpipe_rewrite_reg[4],
        29 xpipe_rewrite_reg[5], 30 xpipe_rewrite_reg[6], 31 xpipe_rewrite_reg[7]""",
        marks=pytest.mark.sheet("DS-TMC4361", "17.3"),
    ),
    pytest.param(
        "INPUT_FILT_CONF",
        """2:0 sr_enc_in, 6:4 filt_l_enc_in, 7 sd_filt0, 10:8 sr_ref, 14:12 filt_l_ref, 15 sd_filt1, 18:16 sr_s,
        22:20 filt_l_s, 23 sd_filt2, 26:24 sr_enc_out, 30:28 filt_l_enc_out, 31 sd_filt3""",
        marks=pytest.mark.sheet("DS-TMC4361", "17.4"),
    ),
    pytest.param(
        "SPI_OUT_CONF",
        """3:0 spi_output_format, 19:13 cover_data_length, 23:20 spi_out_low_time, 27:24 spi_out_high_time,
        31:28 spi_out_block_time""",
        marks=pytest.mark.sheet("DS-TMC4361", "17.5"),
    ),
    pytest.param(
        "CURRENT_CONF",
        """0 hold_current_scale_en, 1 drive_current_scale_en, 2 boost_current_on_acc_en, 3 boost_current_on_dec_en,
        4 boost_current_after_start_en, 5 sec_drive_current_scale_en, 6 freewheeling_en, 7 closed_loop_scale_en,
        8 pwm_scale_en, 31:16 pwm_ampl""",
        marks=pytest.mark.sheet("DS-TMC4361", "17.6"),
    ),
    pytest.param(
        "SCALE_VALUES",
        "7:0 boost_scale_val, 15:8 drv1_scale_val, 23:16 drv2_scale_val, 31:24 hold_scale_val",
        marks=pytest.mark.sheet("DS-TMC4361", "17.7"),
    ),
    pytest.param(
        "ENC_IN_CONF",
        """0 enc_sel_decimal, 1 clear_on_n, 2 clr_latch_cont_on_n, 3 clr_latch_once_on_n, 4 pol_n,
        6:5 n_chan_sensitivity, 7 pol_a_for_n, 8 pol_b_for_n, 9 ignore_ab, 10 latch_enc_on_n, 11 latch_x_on_n,
        12 multi_turn_in_en, 13 multi_turn_in_signed, 14 multi_turn_out_en, 15 use_usteps_instead_of_xrange,
        16 calc_multi_turn_behav, 17 ssi_multi_cycle_data, 18 ssi_gray_code_en, 19 left_aligned_data,
        20 spi_data_on_cs, 21 spi_low_before_cs, 23:22 regulation_modus, 24 cl_calibration_en, 25 cl_emf_en,
        26 cl_clr_xact, 27 cl_vlimit_en, 28 cl_velocity_mode_en, 29 invert_enc_dir, 30 enc_out_gray""",
        marks=pytest.mark.sheet("DS-TMC4361", "17.8"),
    ),
    pytest.param(
        "ENC_IN_DATA",
        """4:0 single_turn_res, 9:5 multi_turn_res, 11:10 status_bit_cnt, 23:16 serial_addr_bits,
        31:24 serial_data_bits""",
        marks=pytest.mark.sheet("DS-TMC4361", "17.9"),
    ),
    pytest.param(
        "ENC_OUT_DATA",
        "4:0 single_turn_res_out, 9:5 multi_turn_res_out",
        marks=pytest.mark.sheet("DS-TMC4361", "17.10"),
    ),
    pytest.param(
        "STEP_CONF",
        "3:0 mstep_per_fs, 15:4 fs_per_rev, 17 OT, 18 OTPW, 21 OLA, 22 OLB",
        marks=pytest.mark.sheet("DS-TMC4361", "17.11"),
    ),
    pytest.param("FREEZE", "23:0 DFREEZE, 31:24 IFREEZE", marks=pytest.mark.sheet("DS-TMC4361", "17.17")),
    pytest.param(
        "RESET_CLK_GATING", "2:0 CLK_GATING_REG, 31:8 RESET_REG", marks=pytest.mark.sheet("DS-TMC4361", "17.18")
    ),
    pytest.param("CL_ANGLES", "8:0 CL_BETA, 23:16 CL_GAMMA", marks=pytest.mark.sheet("DS-TMC4361", "17.19")),
    pytest.param(
        "PID_I_CLIP___PID_D_CLKDIV",
        "14:0 PID_I_CLIP, 23:16 PID_D_CLKDIV",
        marks=pytest.mark.sheet("DS-TMC4361", "17.19"),
    ),
    pytest.param(
        "ENC_VMEAN",
        "7:0 ENC_VMEAN_WAIT, 11:8 ENC_VMEAN_FILTER, 31:16 ENC_VMEAN_INT",
        marks=pytest.mark.sheet("DS-TMC4361", "17.20"),
    ),
    pytest.param(
        "MSLUTSEL",
        "1:0 W0, 3:2 W1, 5:4 W2, 7:6 W3, 15:8 X1, 23:16 X2, 31:24 X3",
        marks=pytest.mark.sheet("DS-TMC4361", "17.22"),
    ),
]


@pytest.mark.parametrize(("name", "layout"), LAYOUTS)
def test_bits_are_where_the_facts_have_them(name: str, layout: str) -> None:
    """Without the second meanings, which overlap."""
    wanted = {}
    for highest, lowest, field in re.findall(r"(\d+)(?::(\d+))? ([^\s,]+)", layout):
        lsb = int(lowest or highest)
        wanted[field] = (lsb, int(highest) - lsb + 1)
    assert {part.name: (part.lsb, part.width) for part in TMC4361.get(name, 0).fields if not part.when} == wanted


@pytest.mark.sheet("DS-TMC4361", "17.21")
def test_shadow_registers_hold_what_each_option_says() -> None:
    """Option 0 is one set over all registers; 1 two sets of an S-ramp; 2 and 3 two sets of a trapezoid."""
    trapezoid = ["VMAX", "AMAX", "DMAX", "ASTART", "DFINAL", "VBREAK"]
    s_ramp = ["VMAX", "AMAX", "DMAX", "BOW1", "BOW2", "BOW3", "BOW4"]
    options = {
        0: [*trapezoid, "VSTART", "VSTOP", "BOW1", "BOW2", "BOW3", "BOW4", "RAMPMODE"],
        1: [*s_ramp, *s_ramp],
        2: [*trapezoid, "VSTART", *trapezoid, "VSTART"],
        3: [*trapezoid, "VSTOP", *trapezoid, "VSTOP"],
    }
    for option, names in options.items():
        for number, name in enumerate(names):
            register = TMC4361.get(f"SH_REG{number}", 0)
            part = register.field_named(f"SH_REG{number}_{name}")
            assert part is not None, (option, number, name)
            holds = {
                "": True,
                "shadow_option is not 0": option != 0,
                "shadow_option is not 1": option != 1,
                "shadow_option = 0 or 2": option in (0, 2),
                "shadow_option = 2 or 3": option in (2, 3),
            }.get(part.when, part.when == f"shadow_option = {option}")
            assert holds, (option, part.name, part.when)
            of = TMC4361.get(name, 0)
            assert (part.signed, part.lsb) == (of.signed, 0)
            assert part.width >= min(of.width, 31) or name == "ASTART"  # whose sign has no shadow
