"""Every axis parameter: range, access, and that what was written is read."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.emulators.tmcl.sixpoint import SixPointParameters
from app.registers.model import Register, Space
from app.registers.tmcl.commands import Opcode, Status, reference_modes
from app.registers.tmcl.modules import MODULES
from tests.emulators.tmcl.harness import Bench

pytestmark = pytest.mark.sheet("FM-PD42-1241", "4")

MOVING = {0, 2}
ROWS = MODULES["pd42-1241"].rows(Space.AXIS)
DEFAULTS = SixPointParameters.defaults_of(ROWS)
WRITABLE = [row for row in ROWS.values() if row.access.writable]
READ_ONLY = [row for row in ROWS.values() if not row.access.writable]


def _name(row: Register) -> str:
    return f"{row.address} {row.name}"


def test_all_84_are_there() -> None:
    assert len(ROWS) == 84
    bench = Bench()
    assert [number for number in range(256) if bench.ask(Opcode.GAP, number).status == 100] == sorted(ROWS)


@pytest.mark.sheet("FM-PD42-1241", "3.6.5")
@pytest.mark.sheet("FM-PD42-1241", "3.6.6")
@pytest.mark.sheet("FM-PD42-1241", "2.3")
@pytest.mark.sheet("FM-PD42-1241", "3.5.2")
@pytest.mark.parametrize("row", WRITABLE, ids=_name)
def test_limits(row: Register) -> None:
    # Open in all sources: whether the module clips or refuses. Here it refuses, and keeps what it had.
    bench = Bench()
    for value in {row.minimum, row.maximum}:
        bench.sap(row.address, value)
        if row.address != 210:  # which the encoder clears
            assert bench.gap(row.address) == value
    kept = bench.gap(row.address)
    for value in (row.minimum - 1, row.maximum + 1):
        if -(2**31) <= value < 2**31:
            assert bench.ask(Opcode.SAP, row.address, 0, value).status == Status.INVALID_VALUE
            assert bench.gap(row.address) == kept


@pytest.mark.parametrize("row", READ_ONLY, ids=_name)
def test_what_can_only_be_read(row: Register) -> None:
    # Open: the status of such a write. Here 3, as for a parameter that there is not.
    bench = Bench()
    assert bench.ask(Opcode.SAP, row.address, 0, 1).status == Status.WRONG_TYPE
    assert row.minimum <= bench.gap(row.address) <= row.maximum


@pytest.mark.parametrize("row", [row for row in ROWS.values() if row.address not in MOVING], ids=_name)
def test_power_on_brings_the_defaults(row: Register) -> None:
    bench = Bench()
    if row.address in DEFAULTS and row.access.writable and row.address not in (209, 216):
        assert bench.gap(row.address) == DEFAULTS[row.address]
        bench.ask(Opcode.SAP, row.address, 0, row.maximum)
        bench.power_cycle()
        assert bench.gap(row.address) == DEFAULTS[row.address]


@pytest.mark.sheet("FM-PD42-1241", "3.6.5")
def test_axis_parameters_are_lost_without_power() -> None:
    bench = Bench()
    bench.sap(4, 12_345)
    bench.power_cycle()
    assert bench.gap(4) == 51_200


@settings(max_examples=200, deadline=None)
@given(st.sampled_from(WRITABLE), st.integers(-(2**31), 2**31 - 1), st.booleans())
def test_what_was_taken_is_read_and_what_was_not_changes_nothing(row: Register, value: int, in_pps: bool) -> None:
    bench = Bench()
    bench.sap(255, int(in_pps))
    before = bench.gap(row.address)
    status = bench.ask(Opcode.SAP, row.address, 0, value).status
    assert status in (Status.OK, Status.INVALID_VALUE)
    low, high = row.range or (0, 0)
    if not in_pps and row.internal_range is not None:
        low, high = row.internal_range
    if status == Status.OK:
        assert low <= value <= high
        assert bench.gap(row.address) == value
    else:
        assert bench.gap(row.address) == before
    bench.run(0.01)


@pytest.mark.parametrize("mode", [0, 9, 64, 69, 128, 129, 137])
def test_search_modes_that_there_are_not(mode: int) -> None:
    assert Bench().ask(Opcode.SAP, 193, 0, mode).status == Status.INVALID_VALUE


def test_search_modes_that_there_are() -> None:
    bench = Bench()
    for mode in reference_modes():
        bench.sap(193, mode)
        assert bench.gap(193) == mode


@pytest.mark.parametrize("value", [1, 31])
def test_the_current_scaler_has_a_gap(value: int) -> None:
    assert Bench().ask(Opcode.SAP, 178, 0, value).status == Status.INVALID_VALUE


def test_run_and_standby_current_in_32_steps() -> None:
    bench = Bench()
    bench.sap(6, 255)
    bench.sap(7, 64)
    bench.sap(214, 10)
    bench.sap(31, 1)
    bench.do(Opcode.ROR, 0, 0, 5000)
    bench.run(0.5)
    assert bench.gap(180) == 31
    bench.do(Opcode.MST)
    bench.stand()
    bench.run(0.06)
    assert bench.gap(180) == 31  # the delay of 100 ms has not passed
    bench.run(2.0)
    assert bench.gap(180) == 8
    bench.sap(178, 128)
    bench.do(Opcode.ROR, 0, 0, 5000)
    bench.run(0.5)
    truth = bench.state.truth
    assert (truth.current_a_a**2 + truth.current_b_a**2) ** 0.5 == pytest.approx(4.2 / 2, rel=0.03)


def test_without_off_time_the_driver_is_off() -> None:
    bench = Bench()
    bench.sap(167, 0)
    bench.move(10_000)
    bench.arrive()
    state = bench.state
    assert state.truth.current_a_a == pytest.approx(0, abs=1e-6)
    assert abs(state.truth.rotor_fullsteps) < 2


@pytest.mark.parametrize(("gradient", "threshold", "works"), [(0, 100_000, 0), (15, 100_000, 1), (15, 1000, 0)])
def test_stealthchop_works_below_its_speed(gradient: int, threshold: int, works: int) -> None:
    bench = Bench()
    bench.sap(187, gradient)
    bench.sap(186, threshold)
    bench.sap(182, 7_999_774)
    bench.do(Opcode.ROR, 0, 0, 20_000)
    bench.run(1.0)
    assert bench.gap(190) == works
    assert (bench.gap(189) > 0) == bool(works)


def test_a_free_motor_at_standstill() -> None:
    bench = Bench()
    for number, value in {187: 15, 186: 7_999_774, 182: 7_999_774, 7: 0, 204: 1, 214: 1, 31: 0}.items():
        bench.sap(number, value)
    bench.move(1000)
    bench.arrive()
    bench.run(0.5)
    assert bench.state.truth.bridges == "open"


def test_turning_the_shaft_round_turns_motor_and_encoders() -> None:
    bench = Bench()
    bench.sap(251, 1)
    bench.move(25_600)
    bench.arrive()
    bench.run(0.2)
    assert bench.state.truth.rotor_fullsteps == pytest.approx(-100, abs=0.5)
    assert bench.gap(209) == pytest.approx(25_600, abs=200)


def test_tuning_parameters_reach_the_driver_chip() -> None:
    bench = Bench()
    for number, value in {
        162: 1,
        163: 1,
        164: 1,
        165: 11,
        166: 4,
        167: 3,
        184: 1,
        185: 9,
        27: 1,
        28: 1,
        161: 1,
    }.items():
        bench.sap(number, value)
    read = bench.module._drive.read
    chopper = read("CHOPCONF")
    assert chopper & 0xF == 3
    assert chopper >> 4 & 7 | (chopper >> 11 & 1) << 3 == 11
    assert chopper >> 7 & 0xF == 4
    assert [chopper >> bit & 1 for bit in (12, 13, 14, 18, 19, 29)] == [1] * 6
    assert (chopper >> 15 & 3, chopper >> 20 & 0xF) == (1, 9)
    for number, value in {168: 1, 169: 2, 170: 7, 171: 3, 172: 5, 173: 1, 174: -3}.items():
        bench.sap(number, value)
    assert read("COOLCONF") == 5 | 3 << 5 | 7 << 8 | 2 << 13 | 1 << 15 | 0x7D << 16 | 1 << 24
    bench.sap(32, 100)
    bench.sap(33, 7)
    assert read("DCCTRL") == 100 | 7 << 16
    bench.sap(22, 50_000)
    assert read("THIGH") == pytest.approx(16e6 / 50_000, abs=1)
    bench.sap(140, 4)
    assert read("THIGH") == pytest.approx(16e6 / 50_000 / 16, abs=1)
