"""Both encoders, their scaling, and the deviations that stop the motor."""

from __future__ import annotations

import pytest

from app.registers.tmcl.commands import ExtendedErrors, Opcode
from tests.emulators.tmcl.harness import FULLSTEP, Bench

TURN = 200 * FULLSTEP


@pytest.mark.sheet("FM-PD42-1241", "6.2")
@pytest.mark.parametrize("turns", [1, -2])
def test_the_built_in_encoder_counts_microsteps(turns: int) -> None:
    bench = Bench()
    bench.move(turns * TURN)
    bench.arrive()
    bench.run(0.5)
    # Ends where it began in its turn, so its eccentricity does not show: detent and one count (50 microsteps) do.
    assert bench.gap(209) == pytest.approx(turns * TURN, abs=100)
    assert bench.gap(209) % 50 == 0


@pytest.mark.sheet("FM-PD42-1241", "6.2")
def test_its_counter_can_be_set() -> None:
    bench = Bench()
    for value in (2**31 - 1, -(2**31), 1000):
        bench.sap(209, value)
        assert bench.gap(209) == value
    bench.move(TURN)
    bench.arrive()
    assert bench.gap(209) == pytest.approx(1000 + TURN, abs=100)
    assert bench.gap(1) == TURN


@pytest.mark.sheet("FM-PD42-1241", "6.2")
def test_the_absolute_value_is_the_place_in_the_turn() -> None:
    bench = Bench()
    at_first = bench.gap(215)
    bench.sap(209, 77)
    assert bench.gap(215) == at_first
    seen = set()
    bench.do(Opcode.ROR, 0, 0, TURN)
    for _ in range(400):
        bench.run(0.01)
        seen.add(bench.gap(215))
    assert min(seen) < 20
    assert max(seen) > 1003
    assert all(0 <= value <= 1023 for value in seen)


@pytest.mark.sheet("FM-PD42-1241", "6.2")
def test_clear_on_null_happens_once() -> None:
    bench = Bench()
    bench.sap(210, 1)
    assert bench.gap(210) == 1
    bench.do(Opcode.ROR, 0, 0, TURN)
    bench.until(lambda: bench.gap(210) == 0, limit_s=5, step_s=0.001)
    assert bench.gap(209) == pytest.approx(0, abs=200)
    assert bench.gap(215) in {0, 1, 2, 3, 1021, 1022, 1023}
    bench.run(1.5)
    assert bench.gap(209) > TURN  # the next null means nothing


@pytest.mark.sheet("FM-PD42-1241", "6.2")
@pytest.mark.parametrize("code", [4, 6])
def test_both_encoders_follow_the_microstep_resolution(code: int) -> None:
    bench = Bench()
    steps = 200 << code
    bench.sap(140, code)
    bench.sap(5, 4 * steps)
    bench.sap(17, 4 * steps)
    bench.sap(4, steps)
    bench.move(steps)
    bench.arrive()
    bench.run(0.3)
    assert bench.gap(209) == pytest.approx(steps, abs=steps / 200)
    assert bench.gap(216) == pytest.approx(steps, abs=steps / 200)


def test_changing_the_resolution_leaves_all_counters_as_they_are() -> None:
    # Open: whether the position counter is scaled too. Here no counter is, so no deviation arises.
    bench = Bench()
    bench.move(10_000)
    bench.arrive()
    bench.run(0.3)
    before = [bench.gap(number) for number in (1, 209, 216)]
    bench.sap(140, 4)
    bench.run(0.1)
    assert [bench.gap(number) for number in (1, 209, 216)] == pytest.approx(before, abs=4)


@pytest.mark.sheet("FM-PD42-1241", "6.3")
@pytest.mark.parametrize("lines", [250, 1000, 5000])
def test_the_external_encoder_is_scaled_by_its_resolution(lines: int) -> None:
    bench = Bench({"encoders": {"external_lines": lines}})
    bench.sap(217, 4 * lines)  # counts are four times the lines
    bench.move(TURN)
    bench.arrive()
    bench.run(0.3)
    assert bench.gap(216) == pytest.approx(TURN, abs=TURN / 400)
    bench.sap(216, -5)
    assert bench.gap(216) == -5


@pytest.mark.sheet("FM-PD42-1241", "6.3")
def test_without_a_resolution_a_count_is_a_microstep() -> None:
    bench = Bench({"encoders": {"external_lines": 1000}})
    bench.sap(217, 0)
    bench.move(TURN)
    bench.arrive()
    bench.run(0.3)
    assert bench.gap(216) == pytest.approx(4000, abs=20)


@pytest.mark.parametrize(
    ("limit", "position"),
    [
        pytest.param(212, 209, marks=pytest.mark.sheet("FM-PD42-1241", "6.2")),
        pytest.param(218, 216, marks=pytest.mark.sheet("FM-PD42-1241", "6.3")),
    ],
)
def test_too_large_a_deviation_stops_the_motor(limit: int, position: int) -> None:
    bench = Bench()
    bench.sap(limit, 2000)
    bench.move(10 * TURN)
    bench.run(1.5)
    assert bench.gap(207) == 0
    bench.patch(blocked=True)
    bench.run(0.3)
    assert (bench.gap(3), bench.gap(2)) == (0, 0)
    assert 2000 <= bench.gap(1) - bench.gap(position) < 2600
    assert bench.gap(8) == 0
    assert bench.gap(207) == ExtendedErrors.DEVIATION
    assert bench.gap(207) == 0  # reading has cleared it
    bench.run(1.0)
    assert bench.gap(3) == 0
    bench.patch(blocked=False)
    bench.sap(position, bench.gap(1))
    bench.move(11 * TURN)
    bench.run(1.0)
    assert bench.gap(3) > 0
    assert bench.gap(207) == 0


@pytest.mark.sheet("FM-PD42-1241", "6.2")
def test_a_deviation_that_stays_stops_every_motion() -> None:
    bench = Bench()
    bench.sap(209, 100_000)
    bench.sap(212, 2000)
    bench.run(0.01)
    assert bench.gap(207) == ExtendedErrors.DEVIATION
    bench.do(Opcode.ROR, 0, 0, 10_000)
    bench.run(0.5)
    assert bench.gap(3) == 0
    assert bench.gap(207) == ExtendedErrors.DEVIATION
    bench.sap(212, 0)
    bench.do(Opcode.ROR, 0, 0, 10_000)
    bench.run(1.0)
    assert bench.gap(3) == 10_000


@pytest.mark.sheet("FM-PD42-1241", "6.2")
def test_a_motion_command_forgets_what_stopped_the_motor() -> None:
    for opcode in (Opcode.ROR, Opcode.MST, Opcode.MVP):
        bench = Bench()
        bench.sap(212, 2000)
        bench.patch(encoder={"slip_fullsteps": 20.0})
        bench.run(0.01)
        bench.sap(212, 0)
        bench.do(opcode)
        assert bench.gap(207) == 0


@pytest.mark.sheet("FM-PD42-1241", "6.2")
def test_no_limit_no_stop() -> None:
    bench = Bench()
    bench.patch(encoder={"slip_fullsteps": 150.0})
    bench.do(Opcode.ROR, 0, 0, 10_000)
    bench.run(1.0)
    assert bench.gap(3) == 10_000
    assert abs(bench.gap(1) - bench.gap(209)) > 100 * FULLSTEP


def test_slip_is_one_shot_and_adds_up() -> None:
    bench = Bench()
    for _ in range(2):
        bench.patch(encoder={"slip_fullsteps": 4.0, "external_slip_fullsteps": -2.0})
    state = bench.state
    assert (state.encoder.slip_fullsteps, state.encoder.external_slip_fullsteps) == (8.0, -4.0)


def test_eccentricity_shows_once_a_turn() -> None:
    def deviation(eccentricity: float) -> float:
        bench = Bench({"encoders": {"second_harmonic_deg": 0.0}})
        bench.patch(encoder={"eccentricity_deg": eccentricity})
        bench.run(0.1)
        bench.sap(209, bench.gap(1))
        seen = []
        bench.do(Opcode.ROR, 0, 0, 12_800)
        for _ in range(80):
            bench.run(0.1)
            seen.append(bench.gap(1) - bench.gap(209))
        return max(seen) - min(seen)

    assert deviation(2.0) - deviation(0.0) == pytest.approx(2 * 2.0 / 360 * TURN, rel=0.25)
