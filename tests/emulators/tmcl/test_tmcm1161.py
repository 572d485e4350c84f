"""The emulated TMCM-1161: speeds by dividers, a counter of 24 bits, a prescaled encoder, parameters kept by STAP."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.links.tmcl import version_string
from app.registers.model import Space
from app.registers.tmcl.commands import Opcode, Status
from app.registers.tmcl.modules import MODULES
from tests.emulators.tmcl.harness import Bench as AnyBench

MODEL = "tmcm-1161"
ROWS = MODULES[MODEL].rows(Space.AXIS)
HALF = 1 << 23
CLOCK_HZ = 16e6


class Bench(AnyBench):
    def __init__(self, eeprom: Path | None = None, **options: object) -> None:
        super().__init__(options, eeprom, MODEL)

    def speed_pps(self, speed: int) -> float:
        """By the formula that the sheets of module and chip print: f v / (2^pulse_div 2048 32)."""
        return CLOCK_HZ * speed / ((1 << self.gap(154)) * 2048 * 32)


def test_it_says_who_it_is() -> None:
    b = Bench()
    assert b.do(Opcode.GET_VERSION, 1) == 1161 << 16 | 1 << 8 | 46
    assert version_string(b.module.exchange(bytes.fromhex("01 88 00 00 00 00 00 00 89"))) == "1161V146"
    assert b.state.model == MODEL


def test_every_parameter_of_its_table_can_be_read_and_no_other() -> None:
    b = Bench()
    assert [number for number in range(256) if b.ask(Opcode.GAP, number).status == Status.OK] == sorted(ROWS)
    for number, row in ROWS.items():
        assert row.minimum <= b.gap(number) <= row.maximum, row.name


@pytest.mark.parametrize("number", [number for number, row in ROWS.items() if row.access.writable])
def test_what_is_written_is_read_and_what_is_beyond_is_refused(number: int) -> None:
    b, row = Bench(), ROWS[number]
    for value in (row.minimum - 1, row.maximum + 1):
        if -(1 << 31) <= value < 1 << 31:
            assert b.ask(Opcode.SAP, number, 0, value).status == Status.INVALID_VALUE
    for value in {row.minimum, row.maximum, b.gap(number)}:
        if row.values and value not in row.values:
            continue
        b.sap(number, value)
        if number != 138 or value != 1:  # the soft mode is played as positioning
            assert b.gap(number) == value


@pytest.mark.parametrize(("speed", "pulse_div"), [(1678, 3), (2047, 0), (500, 5), (2047, 8), (-1000, 4)])
def test_it_turns_at_what_speed_and_divider_make(speed: int, pulse_div: int) -> None:
    b = Bench()
    b.sap(154, pulse_div)
    b.sap(153, 0)
    b.sap(5, 2047)
    b.do(Opcode.ROR, 0, 0, speed)
    b.until(lambda: b.gap(3) == speed)
    before = b.gap(1)
    b.run(1.0)
    assert (b.gap(1) - before + HALF) % (2 * HALF) - HALF == pytest.approx(b.speed_pps(speed), rel=1e-3, abs=2)


@pytest.mark.parametrize(("a_max", "ramp_div", "pulse_div"), [(100, 7, 3), (1000, 9, 4), (2047, 7, 3)])
def test_it_accelerates_by_what_both_dividers_make(a_max: int, ramp_div: int, pulse_div: int) -> None:
    """f^2 a / 2^(pulse_div + ramp_div + 29), as the sheets print it."""
    b = Bench()
    for number, value in ((154, pulse_div), (153, ramp_div), (5, a_max), (130, 0)):
        b.sap(number, value)
    rate = CLOCK_HZ**2 * a_max / 2 ** (pulse_div + ramp_div + 29)
    b.do(Opcode.ROR, 0, 0, 2047)
    assert b.gap(135) == 0 or b.gap(135) == a_max
    b.run(0.02)
    assert b.gap(135) == a_max
    took_s = b.until(lambda: b.gap(3) == 2047, step_s=0.001) + 0.02
    assert took_s == pytest.approx(b.speed_pps(2047) / rate, rel=0.02, abs=0.002)
    assert b.gap(135) == 0


def test_a_divider_counts_at_once_in_what_is_under_way() -> None:
    b = Bench()
    b.move(4_000_000)
    b.until(lambda: b.gap(3) == 1678)
    b.sap(154, 4)
    b.until(lambda: b.gap(3) == 1678, limit_s=5)
    before = b.gap(1)
    b.run(1.0)
    assert b.gap(1) - before == pytest.approx(CLOCK_HZ * 1678 / 2**20, rel=0.01)


def test_it_moves_and_says_what_drives_it() -> None:
    b = Bench()
    b.move(30_000)
    assert b.gap(138) == 0
    b.arrive()
    assert (b.gap(1), b.gap(0)) == (30_000, 30_000)
    assert b.gap(209) == pytest.approx(30_000, abs=300), "a motor turned"
    b.do(Opcode.MVP, 1, 0, -10_000)  # from the position, by its manual
    b.arrive()
    assert b.gap(1) == 20_000
    b.do(Opcode.ROL, 0, 0, 300)
    b.run(0.5)
    assert (b.gap(138), b.gap(3)) == (2, -300)
    b.sap(138, 0)
    b.arrive()
    assert b.gap(1) == 20_000, "back to the latest target"


def test_the_counter_has_24_bits_and_wraps() -> None:
    b = Bench()
    b.sap(1, HALF - 1_000)
    b.do(Opcode.ROR, 0, 0, 1_678)
    b.until(lambda: b.gap(1) < 0)
    b.do(Opcode.MST)
    b.stand()
    b.move(HALF - 500)
    assert b.arrive() < 10, "the shorter way, back over the end"
    assert b.gap(1) == HALF - 500
    assert b.ask(Opcode.MVP, 0, 0, HALF).status == Status.INVALID_VALUE
    assert b.ask(Opcode.MVP, 1, 0, 600).status == Status.INVALID_VALUE


@pytest.mark.sheet("FM-TMCM-1161", "6.2")
@pytest.mark.parametrize(("resolution", "prescaler"), [(8, 25600), (7, 12800), (4, 1600), (1, 200)])
def test_the_prescaler_makes_microsteps_of_the_encoder(resolution: int, prescaler: int) -> None:
    b = Bench()
    b.sap(140, resolution)
    b.sap(210, prescaler)
    turn = 200 << resolution
    b.sap(154, min(11, 3 + 8 - resolution))
    b.move(turn)
    b.arrive()
    b.run(0.5)
    assert b.gap(209) == pytest.approx(turn, abs=turn * 0.006 + 1)


def test_global_parameters_turn_shaft_and_switches() -> None:
    b = Bench(stage={"left_at_fullsteps": -50.0, "right_at_fullsteps": 4000.0})
    b.move(2_560)
    b.arrive()
    assert b.state.truth.rotor_fullsteps == pytest.approx(10, abs=1)
    b.sgp(90, 1)
    b.move(0)
    b.arrive()
    assert b.state.truth.rotor_fullsteps == pytest.approx(20, abs=1), "the other way round"
    assert (b.gap(10), b.gap(11)) == (0, 0)
    b.sgp(79, 1)
    assert (b.gap(10), b.gap(11)) == (1, 1)


def test_stap_keeps_over_power_and_rsap_brings_back(tmp_path: Path) -> None:
    eeprom = tmp_path / "eeprom.json"
    b = Bench(eeprom)
    delivered = b.gap(4)
    b.sap(4, 777)
    b.do(Opcode.STAP, 4)
    b.sap(4, 5)
    b.do(Opcode.RSAP, 4)
    assert b.gap(4) == 777
    b.sap(5, 99)
    b.power_cycle()
    assert (b.gap(4), b.gap(5)) == (777, 110), "what was not stored is as delivered"
    assert Bench(eeprom).gap(4) == 777
    for number in (0, 1, 8, 138, 3, 255):
        assert b.ask(Opcode.STAP, number).status == Status.WRONG_TYPE
    b.patch(factory_default=True)
    assert b.gap(4) == delivered


def test_its_sibling_knows_neither_of_both() -> None:
    b = AnyBench()
    assert b.ask(Opcode.STAP, 4).status == b.ask(Opcode.RSAP, 4).status == Status.INVALID_COMMAND


def test_it_stops_where_it_stalls_and_where_the_encoder_lags() -> None:
    b = Bench()
    b.sap(212, 3_000)
    b.patch(blocked=True)
    b.move(100_000)
    b.stand()
    b.until(lambda: b.gap(3) == 0 and abs(b.gap(1) - b.gap(209)) > 3_000, limit_s=5)
    assert b.gap(207) == 2


@pytest.mark.parametrize("mode", [1, 65, 2, 3, 4, 5, 7])
def test_it_searches_its_reference_as_its_sibling_does(mode: int) -> None:
    stage = {"left_at_fullsteps": -100, "right_at_fullsteps": 100, "home_from_fullsteps": 30, "home_to_fullsteps": 40}
    b = Bench(stage=stage)
    b.sap(193, mode)
    b.sap(194, 1_310)
    b.sap(195, 131)
    b.do(Opcode.RFS, 0)
    b.until(lambda: b.do(Opcode.RFS, 2) == 0)
    b.stand()
    assert b.gap(1) == pytest.approx(0, abs=2)
    zero = {65: 100, 5: 35, 7: 35}.get(mode, -100)
    assert b.state.stage.position_fullsteps == pytest.approx(zero, abs=2)


def test_currents_of_the_firmware_boost_slow_run_and_none_at_rest() -> None:
    """Parameters 200, 183 with 182, and 204."""
    bench = Bench()
    for number, value in {6: 128, 7: 32, 200: 240, 183: 64, 182: 800, 204: 50, 214: 10, 172: 0}.items():
        bench.sap(number, value)

    def scale() -> int:
        return bench.state.truth.current_scale

    bench.do(Opcode.ROR, 0, 0, 400)
    bench.run(0.1)
    assert scale() == 240 // 8, "while it speeds up"
    bench.until(lambda: bench.gap(135) == 0)
    bench.run(0.1)
    assert scale() == 64 // 8, "below the threshold speed"
    bench.do(Opcode.ROR, 0, 0, 1200)
    bench.run(0.1)
    bench.until(lambda: bench.gap(135) == 0)
    bench.run(0.1)
    assert scale() == 128 // 8
    bench.do(Opcode.MST)
    bench.stand()
    bench.run(0.4)
    assert (scale(), bench.state.truth.bridges) == (32 // 8, "regulated")
    bench.run(0.6)
    assert bench.state.truth.bridges == "open"
    bench.patch(load_torque_nm=0.05)
    bench.run(0.2)
    assert abs(bench.state.truth.speed_rad_s) > 20
