"""StallGuard, CoolStep, undervoltage: what the load does to the motor and the module tells."""

from __future__ import annotations

import pytest

from app.registers.tmcl.commands import DriverErrors, ExtendedErrors, Opcode
from tests.emulators.tmcl.harness import Bench


def running(speed: int = 51_200, **parameters: int) -> Bench:
    bench = Bench()
    bench.sap(5, 200_000)
    for name, value in parameters.items():
        bench.sap(int(name.removeprefix("ap")), value)
    bench.do(Opcode.ROR, 0, 0, speed)
    bench.run(1.5)
    return bench


def _mean(bench: Bench, number: int, over_s: float = 0.5) -> float:
    seen = []
    for _ in range(int(over_s / 0.005)):
        bench.run(0.005)
        seen.append(bench.gap(number))
    return sum(seen) / len(seen)


@pytest.mark.sheet("FM-PD42-1241", "7.2")
def test_the_load_value_falls_with_the_load() -> None:
    bench = running()
    means = []
    for load in (0.0, 0.1, 0.2):
        bench.patch(load_torque_nm=load)
        bench.run(0.3)
        means.append(_mean(bench, 206))
    assert means[0] > means[1] + 50 > means[2] + 100
    # linear over a wide range: both steps alike
    assert (means[0] - means[1]) / (means[1] - means[2]) == pytest.approx(1, rel=0.35)


@pytest.mark.sheet("FM-PD42-1241", "7.2")
def test_the_threshold_moves_it() -> None:
    bench = running()
    bench.sap(174, -20)
    bench.run(0.2)
    low = _mean(bench, 206)
    bench.sap(174, 20)
    bench.run(0.2)
    assert _mean(bench, 206) > low + 100


@pytest.mark.sheet("FM-PD42-1241", "7.2")
def test_the_filter_quietens_it() -> None:
    def spread(on: int) -> float:
        bench = running(ap173=on)
        seen = []
        for _ in range(60):
            bench.run(0.02)
            seen.append(bench.gap(206))
        return max(seen) - min(seen)

    assert spread(1) < spread(0)


@pytest.mark.sheet("FM-PD42-1241", "7.2")
def test_stop_on_stall() -> None:
    bench = running(ap181=40_000)
    assert bench.gap(3) == 51_200
    assert bench.gap(207) == 0
    bench.patch(blocked=True)
    bench.run(0.5)
    assert (bench.gap(3), bench.gap(2)) == (0, 0)
    assert bench.gap(207) == ExtendedErrors.STALL
    assert bench.gap(207) == 0
    bench.patch(blocked=False)
    bench.do(Opcode.ROR, 0, 0, 51_200)
    bench.run(1.5)
    assert bench.gap(3) == 51_200
    assert bench.gap(207) == 0


@pytest.mark.sheet("FM-PD42-1241", "7.2")
@pytest.mark.parametrize(("threshold", "speed"), [(0, 51_200), (60_000, 51_200)])
def test_a_stall_stops_nothing_below_the_threshold_or_without_one(threshold: int, speed: int) -> None:
    bench = running(speed, ap181=threshold)
    bench.patch(blocked=True)
    bench.run(0.5)
    assert bench.gap(3) == speed
    assert bench.gap(207) == 0
    assert bench.state.truth.lost_fullsteps % 4 == 0
    assert bench.state.truth.lost_fullsteps > 0


@pytest.mark.sheet("FM-PD42-1241", "7.2")
def test_a_stalled_positioning_move_does_not_arrive() -> None:
    bench = Bench()
    bench.sap(5, 200_000)
    bench.sap(181, 40_000)
    bench.do(Opcode.REQUEST_EVENT, 1, 0, 1)
    bench.move(512_000)
    bench.run(1.5)
    bench.patch(blocked=True)
    bench.run(1.0)
    assert bench.gap(207) == ExtendedErrors.STALL
    assert (bench.gap(3), bench.gap(8), bench.events()) == (0, 0, [])


@pytest.mark.sheet("FM-PD42-1241", "7.3")
def test_coolstep_lowers_the_current_without_load_and_raises_it_with() -> None:
    bench = running(ap6=200, ap172=4, ap170=2, ap169=2, ap171=1, ap174=0)
    bench.run(1.0)
    idle = bench.gap(180)
    assert idle <= 13  # half of the run current of 25 steps: the lower limit
    bench.patch(load_torque_nm=0.3)
    bench.run(1.0)
    loaded = bench.gap(180)
    assert loaded > idle + 3
    bench.patch(load_torque_nm=0.0)
    bench.run(1.5)
    assert bench.gap(180) == pytest.approx(idle, abs=2)
    bench.sap(168, 1)  # a quarter
    bench.run(1.0)
    assert bench.gap(180) < idle
    bench.sap(172, 0)
    bench.run(0.5)
    assert bench.gap(180) == 25


@pytest.mark.sheet("FM-PD42-1241", "7.3")
@pytest.mark.parametrize(("number", "value"), [(182, 60_000), (22, 40_000)])
def test_coolstep_works_only_between_its_speeds(number: int, value: int) -> None:
    bench = running(ap6=200, ap172=4, ap170=2, ap169=2, **{f"ap{number}": value})
    bench.run(1.0)
    assert bench.gap(180) == 25


def test_standstill_shows_in_the_driver_flags() -> None:
    bench = Bench()
    bench.move(1000)
    bench.run(0.01)
    assert not bench.gap(208) & DriverErrors.STANDSTILL
    bench.arrive()
    bench.run(0.1)
    assert bench.gap(208) & DriverErrors.STANDSTILL


def test_undervoltage_leaves_the_motor_free() -> None:
    bench = running()
    state = bench.patch(faults={"undervoltage": True})
    assert state.supply_v < 8
    bench.run(1.0)
    # Open: how AP 208 tells it, which has no bit for it. Here as open coils, for no current can flow.
    assert bench.gap(208) & 0x60 == DriverErrors.OPEN_LOAD_A | DriverErrors.OPEN_LOAD_B
    truth = bench.state.truth
    assert (truth.current_a_a, truth.current_b_a) == pytest.approx((0, 0), abs=1e-3)
    assert truth.bridges == "open"
    assert abs(truth.speed_rad_s) < 0.5
    assert bench.gap(3) == 51_200  # the ramp has no way to know
    state = bench.patch(faults={"undervoltage": False})
    assert state.supply_v == 24
    assert bench.gap(208) & 0x60 == 0
    bench.do(Opcode.MST)
    bench.stand()
    bench.run(0.1)
    angle = bench.state.truth.rotor_fullsteps
    bench.move(bench.gap(1) + 25_600)
    bench.run(3.0)
    assert bench.state.truth.rotor_fullsteps - angle == pytest.approx(100, abs=4)


def test_a_pulled_motor_plug_and_a_hot_driver_show() -> None:
    bench = running(5000)
    bench.patch(motor={"connected": False})
    bench.run(0.1)
    assert bench.gap(208) & (DriverErrors.OPEN_LOAD_A | DriverErrors.OPEN_LOAD_B)
    bench.patch(motor={"connected": True, "temperature_c": 130.0})
    bench.run(0.1)
    assert bench.gap(208) & DriverErrors.OVERTEMPERATURE_WARNING
    bench.patch(motor={"temperature_c": 160.0})
    bench.run(0.1)
    assert bench.gap(208) & DriverErrors.OVERTEMPERATURE
    assert bench.state.truth.bridges == "open"


@pytest.mark.sheet("FM-PD42-1241", "7.2")
@pytest.mark.parametrize("threshold", [6, 7, 8, 9])
def test_a_clamped_shaft_stalls_at_the_makers_thresholds_and_a_free_one_does_not(threshold: int) -> None:
    bench = running(ap174=threshold)
    assert _mean(bench, 206) > 200
    bench.patch(blocked=True)
    bench.run(0.2)
    assert _mean(bench, 206) == 0
    bench.sap(181, 40_000)
    bench.run(0.1)
    assert bench.gap(3) == 0
