"""StallGuard2 and CoolStep."""

from __future__ import annotations

from itertools import pairwise

import pytest

from app.emulators.drive import Drive, EventKind
from app.emulators.drive.options import LoadValueOptions, MotorOptions
from tests.emulators.drive.rig import ONE_TURN_A_SECOND, bit, energised, load_value, until, wait, write

SG_STOP = 1 << 10
ALL_SPEEDS = 0xFFFFF


def turning(turns: float = 2.0, **registers: int) -> Drive:
    return turning_one(LoadValueOptions(), turns, **registers)


def turning_one(told: LoadValueOptions, turns: float, **registers: int) -> Drive:
    drive = energised(motor=MotorOptions(load_value=told))
    write(drive, {"VMAX": round(turns * ONE_TURN_A_SECOND), "RAMPMODE": 1} | registers)
    wait(drive, 1.0)
    return drive


def mean_load(drive: Drive, values: int = 40) -> float:
    total = 0
    for _ in range(values):
        wait(drive, 0.01)
        total += load_value(drive)
    return total / values


def coolconf(semin: int = 0, semax: int = 0, seup: int = 0, sedn: int = 0, seimin: int = 0, sgt: int = 0) -> int:
    return semin | seup << 5 | semax << 8 | sedn << 13 | seimin << 15 | (sgt & 0x7F) << 16


def test_the_value_falls_about_linearly_with_the_load() -> None:
    drive = turning()
    values = []
    for load_nm in (0.0, 0.07, 0.14, 0.21):
        drive.plant.load_torque_nm = load_nm
        wait(drive, 0.3)
        values.append(mean_load(drive))
    falls = [a - b for a, b in pairwise(values)]
    assert values[0] > 300
    assert min(falls) > 60
    assert max(falls) < 1.3 * min(falls)
    assert drive.plant_state.lost_fullsteps == 0


def test_the_value_rises_with_speed_until_the_supply_is_not_enough() -> None:
    values = [mean_load(turning(turns)) for turns in (0.25, 0.5, 1.0, 3.0)]
    assert values == sorted(values)
    drive = turning(14.0)
    wait(drive, 3.0)
    assert drive.plant_state.lost_fullsteps == 0
    assert mean_load(drive) < values[-1]


@pytest.mark.parametrize("sgt", [-10, 10])
def test_the_threshold_shifts_the_value(sgt: int) -> None:
    drive = turning()
    before = mean_load(drive)
    drive.write("COOLCONF", coolconf(sgt=sgt))
    wait(drive, 0.1)
    assert mean_load(drive) - before == pytest.approx(8 * sgt, abs=6)


def test_the_filter_makes_a_new_value_every_four_full_steps_and_halves_the_noise() -> None:
    steps, spread = [], []
    for sfilt in (0, 1):
        drive = turning(1.0, COOLCONF=sfilt << 24)
        values = []
        for _ in range(800):  # two values every full step of 5 ms
            wait(drive, 0.0025)
            values.append(load_value(drive))
        changes = sum(a != b for a, b in pairwise(values))
        steps.append(changes)
        spread.append(max(values) - min(values))
    assert 330 < steps[0] <= 400
    assert 60 < steps[1] <= 100
    assert spread[1] < 0.85 * spread[0]


def scatter(drive: Drive, values: int = 200) -> float:
    """How far values are apart, of one every full step at a turn a second or more."""
    seen = []
    for _ in range(values):
        wait(drive, 0.005)
        seen.append(load_value(drive))
    return max(seen) - min(seen)


def test_the_noise_of_a_motor_grows_with_its_speed() -> None:
    told = LoadValueOptions(noise=5.0, noise_with_speed=100.0)
    slow, fast = (scatter(turning_one(told, turns)) for turns in (0.5, 3.0))
    assert slow == pytest.approx(2 * (5 + 10), rel=0.25)
    assert fast == pytest.approx(2 * (5 + 60), rel=0.25)


def test_poles_that_are_unlike_move_single_values_and_not_the_mean_of_four() -> None:
    uneven = LoadValueOptions(noise=1.0, pole_tolerance=60.0)
    assert scatter(turning_one(uneven, 1.0)) > 100
    assert scatter(turning_one(uneven, 1.0, COOLCONF=1 << 24)) < 15


def test_no_value_and_no_stall_at_standstill_or_in_stealthchop() -> None:
    drive = turning()
    drive.write("VMAX", 0)
    until(drive, EventKind.STANDSTILL)
    assert load_value(drive) == 0
    assert not bit(drive.read("DRV_STATUS"), 24)
    drive = turning(GCONF=0x4)
    assert load_value(drive) == 0
    assert not bit(drive.read("DRV_STATUS"), 24)


def test_a_stall_stops_the_motor_until_the_event_is_cleared() -> None:
    drive = turning(SW_MODE=SG_STOP, TCOOLTHRS=ALL_SPEEDS)
    assert drive.read("VACTUAL") == 2 * ONE_TURN_A_SECOND
    drive.plant.blocked = True
    event = until(drive, EventKind.STALL_STOP | EventKind.STOPPED, 0.2)
    assert event.kinds == EventKind.STALL_STOP | EventKind.STOPPED
    assert drive.read("VACTUAL") == 0
    assert bit(drive.read("RAMP_STAT"), 6)
    wait(drive, 0.5)
    assert drive.read("XACTUAL") == event.position
    drive.plant.blocked = False
    drive.write("RAMP_STAT", 1 << 6)
    wait(drive, 1.0)
    assert drive.read("VACTUAL") == 2 * ONE_TURN_A_SECOND


@pytest.mark.parametrize("by_register", [True, False])
def test_below_the_threshold_speed_a_stall_stops_nothing(by_register: bool) -> None:
    for turns, stops in ((0.5, False), (2.0, True)):
        drive = energised()
        drive.write("SW_MODE", SG_STOP)
        if by_register:
            drive.write("TCOOLTHRS", 2**24 // ONE_TURN_A_SECOND)
        else:
            drive.stall_stop_velocity = ONE_TURN_A_SECOND
        write(drive, {"VMAX": round(turns * ONE_TURN_A_SECOND), "RAMPMODE": 1})
        wait(drive, 1.0)
        drive.plant.blocked = True
        wait(drive, 1.0)
        assert bit(drive.read("RAMP_STAT"), 6) is stops
        assert (drive.read("VACTUAL") == 0) is stops


def test_without_sg_stop_a_stall_is_only_told() -> None:
    drive = turning(TCOOLTHRS=ALL_SPEEDS)
    drive.plant.blocked = True
    seen = False
    for _ in range(100):
        wait(drive, 0.005)
        seen = seen or (bit(drive.read("DRV_STATUS"), 24) and bit(drive.read("RAMP_STAT"), 13))
    assert seen
    assert drive.read("VACTUAL") == 2 * ONE_TURN_A_SECOND


@pytest.mark.parametrize(("seimin", "lowest", "friction_nm"), [(0, 5, 0.115), (1, 2, 0.06)])
def test_coolstep_takes_current_away_and_gives_it_back(seimin: int, lowest: int, friction_nm: float) -> None:
    drive = turning(TCOOLTHRS=ALL_SPEEDS, COOLCONF=coolconf(semin=3, semax=1, seup=1, sedn=2, seimin=seimin))
    wait(drive, 3.0)
    assert drive.plant_state.current_scale == lowest
    assert drive.read("DRV_STATUS") >> 16 & 31 == lowest
    drive.plant.extra_friction_nm = friction_nm
    wait(drive, 0.5)
    assert lowest < drive.plant_state.current_scale <= 11
    assert drive.plant_state.lost_fullsteps == 0
    drive.write("COOLCONF", 0)
    wait(drive, 0.01)
    assert drive.plant_state.current_scale == 11


def test_coolstep_steps_down_as_slowly_as_sedn_says() -> None:
    times = []
    for sedn in (2, 3):  # two readings a step, then one
        drive = turning(TCOOLTHRS=ALL_SPEEDS, COOLCONF=coolconf(semin=1, semax=0, sedn=sedn))
        drive.write("COOLCONF", coolconf(semin=1, semax=0, sedn=sedn))  # at full current again
        start = drive.clocks
        while drive.plant_state.current_scale > 5:
            drive.advance(drive.clocks + 4000)
        times.append(drive.clocks - start)
    assert times[0] == pytest.approx(2 * times[1], rel=0.25)


@pytest.mark.parametrize("registers", [{"TCOOLTHRS": 100}, {"TCOOLTHRS": ALL_SPEEDS, "THIGH": ALL_SPEEDS}])
def test_coolstep_works_between_its_two_thresholds_only(registers: dict[str, int]) -> None:
    drive = turning(COOLCONF=coolconf(semin=1, sedn=3), **registers)
    wait(drive, 1.0)
    assert drive.plant_state.current_scale == 11
