"""The parameters of the TMCM-1161 against the published lists, and what sets it apart from its sibling."""

from __future__ import annotations

import pytest
from pytrinamic.modules import TMCM1161

from app.registers.model import Access, Space
from app.registers.tmc428.roles import ACCELERATION_UNIT, VELOCITY_UNIT
from app.registers.tmcl.modules import MODULES

MODULE = MODULES["tmcm-1161"]


def _numbers(listed: type) -> set[int]:
    return {number for name, number in vars(listed).items() if not name.startswith("_")}


def test_its_parameters_are_those_that_the_maker_lists() -> None:
    assert set(MODULE.rows(Space.AXIS)) == _numbers(TMCM1161._MotorTypeA.AP)
    assert set(MODULE.rows(Space.GLOBAL_0)) == _numbers(TMCM1161.GP0)
    assert set(MODULE.rows(Space.GLOBAL_3)) == _numbers(TMCM1161.GP3)
    assert set(MODULE.rows(Space.GLOBAL_2)) == set(range(256))
    assert set(MODULE.rows(Space.OUTPUT)) == {TMCM1161.IO.OUT0, TMCM1161.IO.OUT1}
    assert set(MODULE.rows(Space.DIGITAL_IN)) == {0, 1, 2, 3}


@pytest.mark.parametrize(
    ("numbers", "limits"),
    [
        ((0, 1, 209), (-(1 << 23), (1 << 23) - 1)),
        ((2, 3), (-2047, 2047)),
        ((4, 5, 130, 181, 182, 194, 195), (0, 2047)),
        ((6, 7, 183), (0, 255)),
        ((138,), (0, 2)),
        ((140,), (0, 8)),
        ((141,), (0, 4095)),
        ((153, 154), (0, 13)),
        ((165,), (-3, 12)),
        ((174,), (-64, 63)),
        ((206,), (0, 1023)),
        ((204, 210, 212), (0, 65535)),
        ((214,), (1, 65535)),
    ],
)
def test_ranges_are_those_of_pysteprockers_table(numbers: tuple[int, ...], limits: tuple[int, int]) -> None:
    rows = MODULE.rows(Space.AXIS)
    assert {number: (rows[number].minimum, rows[number].maximum) for number in numbers} == dict.fromkeys(
        numbers, limits
    )


def test_speeds_count_in_the_units_of_a_tmc429() -> None:
    rows = MODULE.rows(Space.AXIS)
    assert {number for number, row in rows.items() if row.unit == VELOCITY_UNIT} == {2, 3, 4, 130, 181, 182, 194, 195}
    assert {number for number, row in rows.items() if row.unit == ACCELERATION_UNIT} == {5, 135}
    assert not any(row.internal_range or row.unit.startswith("pps") for row in MODULE.table), "no unit mode here"


@pytest.mark.sheet("FM-TMCM-1161", "6.2")
def test_the_encoder_comes_scaled_to_the_microsteps_that_it_comes_with() -> None:
    rows = MODULE.rows(Space.AXIS)
    prescaler, microsteps = rows[210].reset, rows[140].reset
    assert (prescaler, microsteps) == (25600, 8)
    assert 25600 / 512 * 1024 == 200 * 2**8, "microsteps of a turn"


def test_what_is_stored_on_request_is_no_state() -> None:
    stored = [row for row in MODULE.rows(Space.AXIS).values() if row.stored]
    assert {row.stored for row in stored} == {"on request"}
    assert all(row.access is Access.RW and not row.volatile for row in stored)
    assert {4, 5, 6, 7, 140, 153, 154} <= {row.address for row in stored}
    assert not any(row.stored for row in MODULES["pd42-1241"].rows(Space.AXIS).values()), "it has no STAP"


def test_modules_are_told_apart_by_their_numbers() -> None:
    assert {module.number: name for name, module in MODULES.items()} == {1241: "pd42-1241", 1161: "tmcm-1161"}
    assert MODULE.version == (1, 46)
