"""The registers of the TMC429 against the map on page 21 of its data sheet (Rev. 2.06), written down a second time."""

from __future__ import annotations

import re

from app.registers.tmc428.tmc428 import TMC428
from app.registers.tmc428.tmc429 import TMC429

# Low four bits of the address, name, bits.
AXIS = """
    0 x_target 24; 1 x_actual 24; 2 v_min 11; 3 v_max 11; 4 v_target 12; 5 v_actual 12; 6 a_max 11; 7 a_actual 12;
    8 is_agtat_is_aleat_is_v0_a_threshold 23; 9 pmul_pdiv 16; a lp_ref_conf_rm 17; b interrupt_mask_interrupt_flags 16;
    c pulse_div_ramp_div_usrs 16; d dx_ref_tolerance 12; e x_latched 24; f ustep_count_429 8
"""
COMMON = """
    30 datagram_low_word 24; 31 datagram_high_word 24; 32 cover_pos_cover_len 24; 33 cover_datagram 24;
    34 if_configuration_429 9; 35 pos_comp_429 24; 36 pos_comp_int_429 9; 38 power_down 24; 39 type_version_429 24;
    3e l3_r3_l2_r2_l1_r1 6; 3f stepper_motor_global_parameter_register 22
"""


def listed(text: str) -> list[str]:
    return [" ".join(entry.split()) for entry in text.split(";")]


def test_every_register_of_every_motor() -> None:
    for axis in range(3):
        rows = [row for row in TMC429 if row.axis == axis]
        assert [f"{row.address & 0xF:x} {row.name} {row.width}" for row in rows] == listed(AXIS)
        assert {row.address >> 4 for row in rows} == {axis}


def test_every_common_register() -> None:
    rows = [row for row in TMC429 if row.axis is None and row.address < 0x40]
    assert [f"{row.address:02x} {row.name} {row.width}" for row in rows] == listed(COMMON)


def test_the_bits_of_the_interface() -> None:
    row = TMC429.get("if_configuration_429")
    names = ["inv_ref", "sdo_int", "step_half", "inv_stp", "inv_dir", "en_sd", "pos_comp_sel", "en_refr"]
    assert [(part.name, part.lsb) for part in row.fields] == list(zip(names, (0, 1, 2, 3, 4, 5, 6, 8), strict=True))
    assert row.unpack(0x80)["pos_comp_sel"] == 2
    assert TMC429.get("pos_comp_int_429").unpack(0x101) == {"I": 1, "M": 1}
    assert TMC429.get("type_version_429").reset == 0x429101
    pulse = TMC429.get("stepper_motor_global_parameter_register").field_named("STPDIV_429")
    assert pulse is not None
    assert (pulse.lsb, pulse.width, pulse.reset, pulse.when) == (8, 4, 15, "en_sd = 1")


def test_the_rest_is_the_tmc428_that_it_takes_the_place_of() -> None:
    for row in TMC428:
        same = TMC429.get(row.name, row.axis)
        assert (same.address, same.width, same.access, same.reset) == (row.address, row.width, row.access, row.reset)
        assert [part for part in same.fields if not part.when] == list(row.fields)
    assert all(re.match(r"DS-TMC429 \d", row.source) for row in TMC429)
