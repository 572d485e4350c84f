"""Motion commands, ramps and the position reached event."""

from __future__ import annotations

import math

import pytest

from app.emulators.tmcl import units
from app.registers.tmcl.commands import Opcode, Status
from tests.emulators.tmcl.harness import Bench, frame

EVENT = frame("02 01 80 8A 00 00 00 01 0E")


@pytest.mark.sheet("FM-PD42-1241", "2.2")
@pytest.mark.sheet("FM-PD42-1241", "3.5.1")
@pytest.mark.parametrize(
    ("opcode", "sign"),
    [
        pytest.param(Opcode.ROR, 1, marks=pytest.mark.sheet("FM-PD42-1241", "3.6.1")),
        pytest.param(Opcode.ROL, -1, marks=pytest.mark.sheet("FM-PD42-1241", "3.6.2")),
    ],
)
def test_rotating_counts_the_way_its_name_says(opcode: int, sign: int) -> None:
    bench = Bench()
    bench.do(opcode, 0, 0, 51_200)
    assert bench.gap(2) == sign * 51_200
    bench.run(1.5)
    assert bench.gap(3) == sign * 51_200
    before, angle = bench.gap(1), bench.state.truth.rotor_rad
    bench.run(1.0)
    assert bench.gap(1) - before == pytest.approx(sign * 51_200, abs=3)
    assert bench.state.truth.rotor_rad - angle == pytest.approx(sign * 2 * math.pi, rel=0.01)


def test_a_negative_speed_turns_the_other_way() -> None:
    bench = Bench()
    bench.do(Opcode.ROR, 0, 0, -10_000)
    assert bench.gap(2) == -10_000
    bench.run(1.0)
    assert bench.gap(1) < 0


@pytest.mark.sheet("FM-PD42-1241", "3.5.1")
@pytest.mark.sheet("FM-PD42-1241", "3.6.3")
def test_stop_is_soft_and_clears_the_target_speed() -> None:
    # FM-PD42-1241 speaks of parameter 0 here, the sister module's manual of 2: the position has nothing to do with it.
    bench = Bench()
    bench.do(Opcode.ROR, 0, 0, 51_200)
    bench.run(1.5)
    bench.do(Opcode.MST)
    assert bench.gap(2) == 0
    assert bench.gap(3) > 50_000  # not at once
    assert bench.stand() == pytest.approx(51_200 / 51_200, abs=0.02)


@pytest.mark.parametrize("value", [7_999_775, -7_999_775, 2**31 - 1, -(2**31)])
@pytest.mark.parametrize("opcode", [Opcode.ROR, Opcode.ROL])
def test_a_speed_out_of_range_is_refused(opcode: int, value: int) -> None:
    bench = Bench()
    assert bench.ask(opcode, 0, 0, value).status == Status.INVALID_VALUE
    assert bench.gap(2) == 0


@pytest.mark.sheet("FM-PD42-1241", "3.5.1")
@pytest.mark.sheet("FM-PD42-1241", "3.6.4")
def test_to_a_position_and_on_from_there() -> None:
    bench = Bench()
    bench.move(90_000)
    assert (bench.gap(0), bench.gap(8)) == (90_000, 0)
    bench.arrive()
    assert (bench.gap(1), bench.gap(3)) == (90_000, 0)
    bench.do(Opcode.MVP, 1, 0, -10_000)
    assert bench.gap(0) == 80_000
    bench.arrive()
    bench.do(Opcode.SCO, 8, 0, -1000)
    bench.do(Opcode.MVP, 2, 0, 8)
    bench.arrive()
    assert bench.gap(1) == -1000


@pytest.mark.sheet("FM-PD42-1241", "3.6.4")
@pytest.mark.parametrize(("option", "target"), [(0, 51_200 + 1000), (1, 20_000)])
def test_relative_moves_count_from_the_last_target_or_the_actual_position(option: int, target: int) -> None:
    bench = Bench()
    bench.sap(127, option)
    bench.move(51_200)
    bench.until(lambda: bench.gap(1) > 19_000, step_s=0.001)
    base = bench.gap(1)
    bench.do(Opcode.MVP, 1, 0, 1000)
    assert bench.gap(0) == (target if option == 0 else base + 1000)


@pytest.mark.sheet("FM-PD42-1241", "3.6.4")
@pytest.mark.parametrize(
    ("type_", "value", "status"),
    [(3, 0, Status.WRONG_TYPE), (2, 21, Status.INVALID_VALUE), (2, -1, Status.INVALID_VALUE)],
)
def test_moves_that_cannot_be(type_: int, value: int, status: Status) -> None:
    bench = Bench()
    assert bench.ask(Opcode.MVP, type_, 0, value).status == status
    assert bench.gap(0) == 0


@pytest.mark.sheet("FM-PD42-1241", "3.6.4")
def test_a_relative_move_must_not_leave_the_range() -> None:
    bench = Bench()
    bench.sap(1, 2**31 - 100)
    assert bench.ask(Opcode.MVP, 1, 0, 200).status == Status.INVALID_VALUE
    bench.do(Opcode.MVP, 1, 0, 99)
    assert bench.gap(0) == 2**31 - 1


@pytest.mark.sheet("FM-PD42-1241", "3.6.4")
def test_positioning_can_be_interrupted() -> None:
    for opcode, speed in ((Opcode.MST, 0), (Opcode.ROR, 5000), (Opcode.ROL, -5000)):
        bench = Bench()
        bench.move(512_000)
        bench.run(1.5)
        bench.do(opcode, 0, 0, abs(speed))
        bench.run(3.0)
        assert bench.gap(3) == speed
        assert bench.gap(8) == 0


def test_a_move_goes_on_at_the_positioning_speed_after_a_rotation() -> None:
    bench = Bench()
    bench.do(Opcode.ROR, 0, 0, 5000)
    bench.run(1.0)
    bench.move(200_000)
    bench.run(2.0)
    assert bench.gap(3) == 51_200


@pytest.mark.sheet("FM-PD42-1241", "3.6.5")
def test_target_parameters_move_the_motor_too() -> None:
    bench = Bench()
    bench.sap(0, 1000)
    bench.arrive()
    assert bench.gap(1) == 1000
    bench.sap(2, -2000)
    bench.run(1.0)
    assert bench.gap(3) == -2000


def test_saying_where_the_motor_is_does_not_move_it() -> None:
    bench = Bench()
    bench.move(1000)
    bench.arrive()
    bench.sap(1, 77_000)
    assert (bench.gap(0), bench.gap(1), bench.gap(8)) == (77_000, 77_000, 1)
    bench.run(1.0)
    assert bench.gap(1) == 77_000
    assert bench.state.truth.rotor_fullsteps == pytest.approx(1000 / 256, abs=0.3)


# --- ramps ----------------------------------------------------------------------------------------


def _six_point_time_s(distance: float, v_start: float, a1: float, v1: float, a: float, v: float, *down: float) -> float:
    d, d1, v_stop = down
    legs = [(v_start, v1, a1), (v1, v, a), (v, v1, d), (v1, v_stop, d1)]
    ramps = sum(abs(after**2 - before**2) / 2 / rate for before, after, rate in legs)
    assert ramps < distance
    return sum(abs(after - before) / rate for before, after, rate in legs) + (distance - ramps) / v


@pytest.mark.sheet("FM-PD42-1241", "1.3")
@pytest.mark.sheet("FM-PD42-1241", "7.5")
def test_a_six_point_move_takes_the_time_of_its_six_points() -> None:
    bench = Bench()
    for number, value in {
        19: 1000, 15: 200_000, 16: 20_000, 5: 60_000, 4: 60_000, 17: 80_000, 18: 30_000, 20: 1000,
    }.items():  # fmt: skip
        bench.sap(number, value)
    bench.move(300_000)
    took_s = bench.until(lambda: bench.gap(8) == 1, step_s=0.0005)
    wanted_s = _six_point_time_s(300_000, 1000, 200_000, 20_000, 60_000, 60_000, 80_000, 30_000, 1000)
    assert took_s == pytest.approx(wanted_s, rel=0.003)


@pytest.mark.sheet("FM-PD42-1241", "7.5")
def test_without_v1_the_ramp_is_a_trapezoid_of_parameters_5_and_17() -> None:
    # FM-PD42-1241 lists parameter 15 here; the sister module's manual has 17, and only that makes a deceleration.
    bench = Bench()
    for number, value in {15: 1000, 16: 0, 5: 100_000, 4: 50_000, 17: 25_000, 18: 1000, 20: 100}.items():
        bench.sap(number, value)
    bench.move(100_000)
    took_s = bench.until(lambda: bench.gap(8) == 1, step_s=0.0005)
    wanted_s = 50_000 / 100_000 + 50_000 / 25_000 + (100_000 - 50_000**2 / 2 * (1 / 100_000 + 1 / 25_000)) / 50_000
    assert took_s == pytest.approx(wanted_s, rel=0.005)


@pytest.mark.sheet("FM-PD42-1241", "7.5")
def test_velocity_mode_knows_one_acceleration_alone() -> None:
    bench = Bench()
    for number, value in {15: 1000, 16: 20_000, 5: 100_000, 17: 1000, 18: 1000}.items():
        bench.sap(number, value)
    bench.do(Opcode.ROR, 0, 0, 50_000)
    assert bench.until(lambda: bench.gap(3) == 50_000, step_s=0.001) == pytest.approx(0.5, abs=0.01)
    bench.do(Opcode.MST)
    assert bench.stand() == pytest.approx(0.5, abs=0.02)


@pytest.mark.sheet("FM-PD42-1241", "1.3")
def test_a_stop_speed_of_zero_arrives_all_the_same() -> None:
    bench = Bench()
    bench.sap(20, 0)
    bench.sap(19, 0)
    bench.move(5000)
    bench.arrive(limit_s=10)
    assert bench.gap(1) == 5000


def test_the_ramp_wait_time_passes_before_the_way_back() -> None:
    times = []
    for wait in (0, 31_250):  # 1 s
        bench = Bench()
        bench.sap(21, wait)
        bench.do(Opcode.ROR, 0, 0, 5000)
        bench.run(1.0)
        bench.do(Opcode.ROL, 0, 0, 5000)
        times.append(_until_back(bench))
    assert times[1] - times[0] == pytest.approx(1.0, abs=0.01)


def _until_back(bench: Bench) -> float:
    return bench.until(lambda: bench.gap(3) == -5000, step_s=0.002)


def test_speed_changes_on_the_fly() -> None:
    bench = Bench()
    bench.move(500_000)
    bench.run(2.0)
    bench.sap(4, 20_000)
    bench.run(2.0)
    assert bench.gap(3) == 20_000
    bench.arrive()
    assert bench.gap(1) == 500_000


# --- units ----------------------------------------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "6.1")
@pytest.mark.sheet("FM-PD42-1241", "7.4")
def test_51200_pps_are_a_turn_a_second() -> None:
    bench = Bench()
    bench.do(Opcode.ROR, 0, 0, 51_200)
    bench.run(2.0)
    before = bench.state.truth.rotor_rad
    bench.run(1.0)
    assert bench.state.truth.rotor_rad - before == pytest.approx(2 * math.pi, rel=0.002)


@pytest.mark.sheet("FM-PD42-1241", "6.1")
@pytest.mark.parametrize("code", range(9))
def test_microstep_resolution_says_how_far_a_microstep_is(code: int) -> None:
    bench = Bench()
    bench.sap(140, code)
    steps = 200 << code
    bench.sap(4, steps)
    bench.sap(5, max(steps * 4, 117))
    bench.sap(17, max(steps * 4, 117))
    bench.move(steps)
    bench.arrive()
    bench.run(0.3)
    # the driver's steps lie half a step from the wave's beginning (DS-TMC5160: 128, 384, 640, 896 are its full steps)
    beside = 0 if code == 8 else 0.5 / (1 << code)
    truth = bench.state.truth
    assert truth.field_fullsteps == pytest.approx(200 + beside + 0.5 / 256)
    assert truth.rotor_fullsteps == pytest.approx(200 + beside, abs=0.04)
    assert bench.gap(209) == pytest.approx(steps, abs=max(1, steps * 0.004))


@pytest.mark.sheet("FM-PD42-1241", "7.4")
def test_in_unit_mode_0_numbers_are_the_ramp_generators_own() -> None:
    bench = Bench()
    bench.sap(4, 51_200)
    bench.sap(5, 51_200)
    bench.sap(255, 0)
    assert (bench.gap(4), bench.gap(5)) == (53_687, 440)
    bench.sap(4, 10_000)
    bench.do(Opcode.ROR, 0, 0, 53_687)
    bench.run(2.0)
    assert (bench.gap(2), bench.gap(3)) == (53_687, 53_687)
    bench.sap(255, 1)
    assert (bench.gap(3), bench.gap(4), bench.gap(5)) == (51_200, 9537, 51_200)
    assert bench.ask(Opcode.SAP, 5, 0, 116).status == Status.INVALID_VALUE
    bench.sap(255, 0)
    bench.sap(5, 1)
    assert bench.ask(Opcode.SAP, 5, 0, 65_536).status == Status.INVALID_VALUE
    assert bench.ask(Opcode.SAP, 4, 0, 2**23 - 511).status == Status.INVALID_VALUE


@pytest.mark.sheet("FM-PD42-1241", "7.4")
def test_every_speed_comes_back_as_it_was_written() -> None:
    for pps in (0, 1, 2, 999, 51_199, 7_999_000, -1, -51_200):
        assert units.velocity_from_chip(units.velocity_to_chip(pps)) == pps
    assert units.acceleration_to_chip(1) == 1
    assert units.acceleration_to_chip(7_629_278) == 65_535
    assert units.step_time(0, 256) == units.TSTEP_MAX
    assert units.measured_velocity(units.TSTEP_MAX, 256) == units.measured_velocity(0, 256) == 0


def test_measured_speed_is_that_of_the_steps() -> None:
    bench = Bench()
    for code in (8, 4):
        bench.sap(140, code)
        bench.do(Opcode.ROR, 0, 0, 3200)
        bench.run(1.0)
        assert bench.gap(29) == pytest.approx(3200, rel=0.01)
        bench.do(Opcode.MST)
        bench.stand()
        bench.run(0.5)
        assert bench.gap(29) == 0


# --- position reached event -----------------------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "3.6.35")
def test_an_event_for_the_next_move_alone() -> None:
    bench = Bench()
    assert bench.do(Opcode.REQUEST_EVENT, 0, 0, 1) == 1
    bench.run(1.0)
    assert bench.events() == []  # no move, no event
    bench.move(5000)
    assert bench.events() == []
    bench.arrive()
    [(at_s, told)] = bench.events()
    assert told == EVENT
    assert bench.clock.now() - 0.02 < at_s <= bench.clock.now()
    assert bench.events() == []
    bench.move(0)
    bench.arrive()
    assert bench.events() == []


@pytest.mark.sheet("FM-PD42-1241", "3.6.35")
def test_an_event_for_every_move() -> None:
    bench = Bench()
    bench.do(Opcode.REQUEST_EVENT, 1, 0, 1)
    for target in (5000, 0, 5000, 5000):  # the last one has nothing to do, and is there at once
        bench.move(target)
        bench.arrive()
        assert [told for _, told in bench.events()] == [EVENT]
    bench.do(Opcode.REQUEST_EVENT, 1, 0, 0)
    bench.move(0)
    bench.arrive()
    assert bench.events() == []


@pytest.mark.sheet("FM-PD42-1241", "3.6.35")
def test_a_move_that_never_arrives_is_never_told() -> None:
    bench = Bench()
    bench.do(Opcode.REQUEST_EVENT, 1, 0, 1)
    bench.move(50_000)
    bench.run(0.5)
    bench.do(Opcode.MST)
    bench.run(3.0)
    assert bench.events() == []
    bench.move(60_000)
    bench.run(0.1)
    bench.move(70_000)  # takes the place of the one before
    bench.arrive()
    assert len(bench.events()) == 1


@pytest.mark.sheet("FM-PD42-1241", "3.6.35")
@pytest.mark.parametrize(
    ("type_", "value", "status"), [(2, 1, Status.WRONG_TYPE), (1, 2, Status.INVALID_VALUE), (0, -1, 4)]
)
def test_event_requests_that_cannot_be(type_: int, value: int, status: int) -> None:
    assert Bench().ask(Opcode.REQUEST_EVENT, type_, 0, value).status == status


def test_the_event_bears_addresses_as_they_are_then() -> None:
    bench = Bench()
    bench.sgp(76, 33)
    bench.do(Opcode.REQUEST_EVENT, 1, 0, 1)
    bench.move(100)
    bench.arrive()
    assert bench.events()[0][1][:4] == bytes((33, 1, 128, 138))
