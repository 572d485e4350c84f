"""Global parameters, user variables, coordinates, and what outlives a power cycle."""

from __future__ import annotations

import json
import logging
from pathlib import Path

import pytest

from app.emulators.tmcl.eeprom import Eeprom
from app.errors import WrongState
from app.registers.model import Space
from app.registers.tmcl.commands import Opcode, Status
from app.registers.tmcl.pd42 import PD42
from tests.emulators.tmcl.harness import Bench

BANK0 = [row for row in PD42 if row.space is Space.GLOBAL_0]
BANK3 = [row for row in PD42 if row.space is Space.GLOBAL_3]
CHANGES_CONTACT = {66, 76, 255}


@pytest.mark.sheet("FM-PD42-1241", "5.1")
@pytest.mark.sheet("FM-PD42-1241", "3.6.7")
@pytest.mark.sheet("FM-PD42-1241", "3.6.8")
@pytest.mark.sheet("FM-PD42-1241", "3.5.2")
@pytest.mark.parametrize("row", [row for row in BANK0 if row.access.writable], ids=lambda row: f"{row.address}")
def test_bank_0_takes_its_range_and_no_more(row) -> None:  # type: ignore[no-untyped-def]
    bench = Bench()
    if row.reset is not None:
        assert bench.ggp(row.address) == row.reset
    for value in (row.minimum - 1, row.maximum + 1):
        if value < 2**31:
            assert bench.ask(Opcode.SGP, row.address, 0, value).status == Status.INVALID_VALUE
    if row.address in CHANGES_CONTACT:
        return
    for value in (row.minimum, row.maximum):
        bench.sgp(row.address, value)
        if row.address != 133:
            assert bench.ggp(row.address) == value


@pytest.mark.parametrize("number", [128, 129, 130, 131])
def test_what_can_only_be_read(number: int) -> None:
    assert Bench().ask(Opcode.SGP, number, 0, 1).status == Status.WRONG_TYPE


@pytest.mark.sheet("FM-PD42-1241", "5.2")
def test_bank_1_is_not_there() -> None:
    for opcode in (Opcode.SGP, Opcode.GGP, Opcode.AGP, Opcode.STGP, Opcode.RSGP):
        assert Bench().ask(opcode, 0, 1).status == Status.INVALID_VALUE


@pytest.mark.parametrize(("number", "bank"), [(0, 0), (63, 0), (67, 0), (134, 0), (3, 3), (255, 3)])
def test_numbers_that_there_are_not(number: int, bank: int) -> None:
    for opcode in (Opcode.SGP, Opcode.GGP):
        assert Bench().ask(opcode, number, bank).status == Status.WRONG_TYPE


@pytest.mark.parametrize("row", BANK3, ids=lambda row: row.name)
def test_bank_3_keeps_how_interrupts_are_set_up(row) -> None:  # type: ignore[no-untyped-def]
    bench = Bench()
    bench.sgp(row.address, 3, bank=3)
    assert bench.ggp(row.address, 3) == 3
    if row.maximum < 2**31:
        assert bench.ask(Opcode.SGP, row.address, 3, 4).status == Status.INVALID_VALUE
    else:  # periods fill all 32 bits
        bench.sgp(row.address, -1, bank=3)
        assert bench.ggp(row.address, 3) == -1
    bench.power_cycle()
    assert bench.ggp(row.address, 3) == 0


@pytest.mark.sheet("FM-PD42-1241", "5.3")
@pytest.mark.sheet("FM-PD42-1241", "3.5.2")
@pytest.mark.sheet("FM-PD42-1241", "3.6.9")
@pytest.mark.sheet("FM-PD42-1241", "3.6.10")
def test_user_variables_are_stored_on_request_and_restored_at_power_on() -> None:
    bench = Bench()
    for number, value in ((0, 5), (55, -(2**31)), (56, 7), (255, 2**31 - 1)):
        bench.sgp(number, value, bank=2)
        assert bench.ggp(number, 2) == value
    bench.do(Opcode.STGP, 0, 2)
    bench.do(Opcode.STGP, 55, 2)
    for opcode in (Opcode.STGP, Opcode.RSGP):
        assert bench.ask(opcode, 56, 2).status == Status.WRONG_TYPE
    bench.sgp(0, 99, bank=2)
    bench.do(Opcode.RSGP, 0, 2)
    assert bench.ggp(0, 2) == 5
    bench.sgp(1, 11, bank=2)
    bench.power_cycle()
    assert [bench.ggp(number, 2) for number in (0, 1, 55, 56, 255)] == [5, 0, -(2**31), 0, 0]


@pytest.mark.sheet("FM-PD42-1241", "5.3")
def test_user_variables_may_begin_at_zero_instead() -> None:
    bench = Bench()
    bench.sgp(7, 70, bank=2)
    bench.do(Opcode.STGP, 7, 2)
    bench.sgp(85, 1)
    bench.power_cycle()
    assert bench.ggp(7, 2) == 0
    bench.do(Opcode.RSGP, 7, 2)
    assert bench.ggp(7, 2) == 70


@pytest.mark.sheet("FM-PD42-1241", "5.1")
@pytest.mark.sheet("FM-PD42-1241", "3.6.7")
def test_bank_0_is_stored_as_it_is_written() -> None:
    bench = Bench()
    bench.sgp(68, 1234)
    bench.sgp(255, 0)
    for opcode in (Opcode.STGP, Opcode.RSGP):  # nothing left to do, which is no error
        bench.do(opcode, 68, 0)
        assert bench.ask(opcode, 128, 0).status == Status.WRONG_TYPE
    bench.power_cycle()
    assert bench.ggp(68) == 1234


@pytest.mark.sheet("FM-PD42-1241", "5.1")
def test_a_baud_rate_is_in_force_after_the_next_power_on() -> None:
    bench = Bench()
    assert bench.state.baud == 9600
    for code, baud in ((7, 115_200), (11, 1_000_000)):
        before = bench.state.baud
        bench.sgp(65, code)
        assert bench.state.baud == before
        bench.power_cycle()
        assert bench.state.baud == baud


# --- coordinates ----------------------------------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "3.6.22")
@pytest.mark.sheet("FM-PD42-1241", "3.6.23")
def test_coordinates() -> None:
    bench = Bench()
    for number in range(21):
        bench.do(Opcode.SCO, number, 0, 1000 - number)
        assert bench.do(Opcode.GCO, number) == 1000 - number
    for opcode in (Opcode.SCO, Opcode.GCO, Opcode.CCO, Opcode.ACO):
        assert bench.ask(opcode, 21).status == Status.WRONG_TYPE
    bench.power_cycle()  # in RAM alone, by default
    assert bench.do(Opcode.GCO, 1) == 0


@pytest.mark.sheet("FM-PD42-1241", "3.6.22")
@pytest.mark.sheet("FM-PD42-1241", "3.6.23")
def test_coordinates_copied_by_hand() -> None:
    bench = Bench()
    for number in range(4):
        bench.do(Opcode.SCO, number, 0, 10 + number)
    bench.do(Opcode.SCO, 2, 255, 0)
    bench.power_cycle()
    assert bench.do(Opcode.GCO, 2, 255) == 12
    assert [bench.do(Opcode.GCO, number) for number in range(4)] == [0, 0, 12, 0]
    for number in range(4):
        bench.do(Opcode.SCO, number, 0, 20 + number)
    bench.do(Opcode.SCO, 0, 255, 0)
    bench.power_cycle()
    bench.do(Opcode.GCO, 0, 255)
    assert [bench.do(Opcode.GCO, number) for number in range(4)] == [0, 21, 22, 23]


@pytest.mark.sheet("FM-PD42-1241", "3.6.22")
@pytest.mark.sheet("FM-PD42-1241", "3.6.24")
@pytest.mark.sheet("FM-PD42-1241", "3.6.25")
@pytest.mark.parametrize("kept", [False, True])
def test_coordinates_kept_by_themselves(kept: bool) -> None:
    bench = Bench()
    bench.sgp(84, int(kept))
    for number in range(3):
        bench.do(Opcode.SCO, number, 0, 30 + number)
    bench.do(Opcode.CALC, 9, 0, -77)
    bench.do(Opcode.ACO, 0)
    bench.do(Opcode.ACO, 3)
    bench.sap(1, 7000)
    bench.do(Opcode.CCO, 4)
    bench.power_cycle()
    stored = [0, 31, 32, -77, 7000] if kept else [0] * 5  # number 0 is RAM alone
    assert [bench.do(Opcode.GCO, number) for number in range(5)] == stored


@pytest.mark.sheet("FM-PD42-1241", "3.6.24")
def test_capturing_the_actual_position() -> None:
    bench = Bench()
    bench.move(7000)
    bench.arrive()
    assert bench.do(Opcode.CCO, 3) == 7000
    assert bench.do(Opcode.GCO, 3) == 7000


@pytest.mark.sheet("FM-PD42-1241", "3.6.25")
def test_the_accumulator_as_a_coordinate() -> None:
    # One sentence of FM-PD42-1241 speaks of the actual position here; name and example mean the accumulator.
    bench = Bench()
    bench.do(Opcode.CALC, 9, 0, -77)
    bench.do(Opcode.ACO, 1)
    assert bench.do(Opcode.GCO, 1) == -77


# --- the EEPROM's file ----------------------------------------------------------------------------


def _fill(bench: Bench) -> None:
    bench.sgp(75, 5)
    bench.sgp(3, 33, bank=2)
    bench.do(Opcode.STGP, 3, 2)
    bench.do(Opcode.SCO, 4, 0, 44)
    bench.do(Opcode.SCO, 4, 255, 0)
    bench.do(Opcode.ENTER_DOWNLOAD)
    bench.ask(Opcode.MST, 0, 0, 0)
    bench.do(Opcode.EXIT_DOWNLOAD)


def _contents(bench: Bench) -> tuple[int, int, int, int]:
    bench.do(Opcode.GCO, 4, 255)
    commands = bench.state.application.commands
    return bench.ggp(75), bench.ggp(3, 2), bench.do(Opcode.GCO, 4), commands


def test_another_module_with_the_same_file_remembers(tmp_path: Path) -> None:
    path = tmp_path / "new" / "eeprom.json"
    first = Bench(eeprom=path)
    _fill(first)
    assert first.state.eeprom_path == str(path)
    assert _contents(Bench(eeprom=path)) == (5, 33, 44, 1)
    assert [entry.name for entry in path.parent.iterdir()] == ["eeprom.json"]


def test_factory_settings_by_command(tmp_path: Path) -> None:
    path = tmp_path / "eeprom.json"
    bench = Bench({"address": 9}, eeprom=path)
    _fill(bench)
    assert bench.ask(Opcode.FACTORY_DEFAULT, 0, 0, 1233).status == Status.INVALID_VALUE
    assert _contents(bench) == (5, 33, 44, 1)
    with pytest.raises(TimeoutError):
        bench.ask(Opcode.FACTORY_DEFAULT, 0, 0, 1234)
    bench.address = 1  # as any new module
    assert _contents(bench) == (0, 0, 0, 0)
    again = Bench(eeprom=path)
    assert _contents(again) == (0, 0, 0, 0)


def test_factory_settings_by_hand() -> None:
    bench = Bench()
    _fill(bench)
    bench.sap(4, 1)
    bench.patch(factory_default=True)
    assert _contents(bench) == (0, 0, 0, 0)
    assert bench.gap(4) == 51_200


def test_a_reset_is_a_power_cycle() -> None:
    bench = Bench()
    _fill(bench)
    bench.do(Opcode.ROR, 0, 0, 10_000)
    bench.run(1.0)
    assert bench.ask(Opcode.RESET_MODULE, 0, 0, 1).status == Status.INVALID_VALUE
    with pytest.raises(TimeoutError):
        bench.ask(Opcode.RESET_MODULE, 0, 0, 1234)
    assert (bench.gap(1), bench.gap(3), bench.gap(4)) == (0, 0, 51_200)
    assert _contents(bench) == (5, 33, 44, 1)
    bench.run(0.5)
    assert bench.gap(1) == 0


@pytest.mark.parametrize(
    "text",
    ["", "[]", "{", '{"format": 2}', '{"format": 1, "globals": [], "variables": {}, "coordinates": {}, "program": {}}',
     '{"format": 1, "globals": {"x": 1}, "variables": {}, "coordinates": {}, "program": {}}',
     '{"format": 1, "globals": {"68": 5}, "variables": {}, "coordinates": {}, "program": {"0": "00"}}'],
)  # fmt: skip
def test_a_broken_file_counts_as_erased(tmp_path: Path, text: str, caplog: pytest.LogCaptureFixture) -> None:
    path = tmp_path / "eeprom.json"
    path.write_text(text)
    with caplog.at_level(logging.WARNING):
        bench = Bench(eeprom=path)
    assert "cannot be read" in caplog.text
    assert bench.ggp(68) == 0
    bench.sgp(68, 9)
    assert Bench(eeprom=path).ggp(68) == 9


def test_values_in_a_file_that_cannot_be_are_left_out(tmp_path: Path) -> None:
    path = tmp_path / "eeprom.json"
    kept = {"format": 1, "globals": {"66": 4711, "68": 12, "99": 1}, "variables": {}, "coordinates": {"30": 1}}
    path.write_text(json.dumps({**kept, "program": {}}))
    bench = Bench(eeprom=path)
    assert bench.ggp(66) == 1
    assert bench.ggp(68) == 12
    assert bench.ask(Opcode.GGP, 99).status == Status.WRONG_TYPE


def test_an_eeprom_that_cannot_be_written_is_locked(tmp_path: Path) -> None:
    path = tmp_path / "eeprom.json"
    path.mkdir()  # nothing can take its place
    bench = Bench(eeprom=path)
    assert bench.ask(Opcode.SGP, 68, 0, 9).status == Status.EEPROM_LOCKED
    with pytest.raises(WrongState, match="cannot be written"):
        bench.patch(factory_default=True)


def test_no_half_written_file_is_left(tmp_path: Path) -> None:
    path = tmp_path / "eeprom.json"
    memory = Eeprom(path)
    memory.variables[1] = 10
    memory.save()
    before = path.read_text()
    path.with_name("eeprom.json.new").write_text("half")  # a process that died while writing
    assert Eeprom(path).variables == {1: 10}
    assert path.read_text() == before


def test_power_cycles_leave_motor_and_stage_where_they_are() -> None:
    bench = Bench()
    bench.move(2560)
    bench.arrive()
    bench.run(0.5)
    before = bench.state.truth.rotor_fullsteps
    bench.patch(power_cycle=True, load_torque_nm=0.01)
    bench.run(0.5)
    assert bench.gap(1) == 0
    # The field begins anew at the top of its table: it may pull the rotor by up to two full steps.
    assert bench.state.truth.rotor_fullsteps == pytest.approx(before, abs=2.1)


# --- counters that run by themselves --------------------------------------------------------------


def test_the_tick_timer_counts_milliseconds() -> None:
    bench = Bench()
    assert bench.ggp(132) == 0
    bench.run(1.5)
    assert bench.ggp(132) == 1500
    bench.sgp(132, 1_000_000)
    bench.run(0.25)
    assert bench.ggp(132) == 1_000_250
    bench.sgp(132, 2**31 - 1)
    bench.run(0.001)
    assert bench.ggp(132) == 0
    bench.power_cycle()
    assert bench.ggp(132) == 0


def test_random_numbers_follow_their_seed() -> None:
    def three(seed: int) -> list[int]:
        bench = Bench()
        bench.sgp(133, seed)
        return [bench.ggp(133) for _ in range(3)]

    assert three(5) == three(5) != three(6)
    assert len(set(three(0))) == 3
    assert all(0 <= number < 2**31 for seed in (0, 1, 2**31 - 1) for number in three(seed))
