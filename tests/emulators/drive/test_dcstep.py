"""DcStep: under load the motor slows down and loses no step."""

from __future__ import annotations

import pytest

from app.emulators.drive import Drive, EventKind, MotorOptions
from tests.emulators.drive.rig import CHOPPER_ON, ONE_TURN_A_SECOND, bit, energised, until, wait, write

TURN = 51_200
VHIGHCHM = 1 << 19
FAST, LEAST = 8, 3
"""Turns a second."""
DC_TIME = 60
"""A coil at rest takes some 30 clocks a cycle, the blank time is 36."""
DC_SG = 4


def drive_at(load_nm: float, dc_step: bool = True, dc_time: int = DC_TIME, dc_sg: int = 0, **registers: int) -> Drive:
    """At full speed, the load put on after it got there."""
    drive = energised(motor=MotorOptions(detent_torque_nm=0.0))
    write(drive, {"CHOPCONF": CHOPPER_ON | VHIGHCHM, "AMAX": 4000, "VMAX": FAST * ONE_TURN_A_SECOND, "RAMPMODE": 1})
    if dc_step:
        write(drive, {"VDCMIN": LEAST * ONE_TURN_A_SECOND, "DCCTRL": dc_time | dc_sg << 16})
    write(drive, registers)
    wait(drive, 2.0)
    drive.plant.load_torque_nm = load_nm
    wait(drive, 0.5)
    return drive


def turns_a_second(drive: Drive, seconds: float = 0.5) -> float:
    before = drive.read("XACTUAL")
    wait(drive, seconds)
    return (drive.read("XACTUAL") - before) / TURN / seconds


def test_the_velocity_falls_with_the_load_and_no_step_is_lost() -> None:
    reached = []
    for load_nm in (0.05, 0.22, 0.24, 0.26):
        drive = drive_at(load_nm)
        reached.append(turns_a_second(drive))
        assert drive.plant_state.lost_fullsteps == 0
        assert bit(drive.read("DRV_STATUS"), 15)
        speed = drive.read("VACTUAL") / ONE_TURN_A_SECOND
        assert speed == pytest.approx(reached[-1], rel=0.1), "VACTUAL tells the speed that it has"
    assert reached[0] == pytest.approx(FAST, rel=0.01)
    assert reached[0] > reached[1] > reached[2] > reached[3] > LEAST
    assert drive_at(0.25, dc_step=False).plant_state.lost_fullsteps > 0, "without it this load is too much"


def test_it_gets_fast_again_when_the_load_is_gone_and_ends_on_its_target() -> None:
    drive = drive_at(0.25)
    assert turns_a_second(drive) < 0.8 * FAST
    drive.plant.load_torque_nm = 0.0
    wait(drive, 1.0)
    assert turns_a_second(drive) == pytest.approx(FAST, rel=0.01)
    target = drive.read("XACTUAL") + 40 * TURN
    write(drive, {"XTARGET": target, "RAMPMODE": 0, "D1": 2000})
    wait(drive, 1.0)
    drive.plant.load_torque_nm = 0.24
    until(drive, EventKind.POSITION_REACHED)
    wait(drive, 0.5)
    assert drive.read("XACTUAL") == target
    assert drive.plant_state.lost_fullsteps == 0


@pytest.mark.parametrize("dc_time", [0, 35])
def test_a_time_below_the_blank_time_never_commutates_before_it_must(dc_time: int) -> None:
    drive = drive_at(0.0, dc_time=dc_time)
    assert turns_a_second(drive) == pytest.approx(LEAST, rel=0.02)


def test_a_longer_time_makes_the_next_step_earlier() -> None:
    reached = [turns_a_second(drive_at(0.24, dc_time=dc_time)) for dc_time in (40, 50, 60)]
    assert reached == sorted(reached)
    assert reached[-1] > 1.05 * reached[0]


@pytest.mark.parametrize(("dc_sg", "found"), [(0, False), (DC_SG, True)])
@pytest.mark.parametrize("stops", [False, True])
def test_a_motor_that_does_not_follow_is_found_by_dc_sg(dc_sg: int, found: bool, stops: bool) -> None:
    drive = drive_at(0.22, dc_sg=dc_sg, TCOOLTHRS=0xFFFFF, SW_MODE=int(stops) << 10)
    assert not bit(drive.read("DRV_STATUS"), 24), "load is no stall"
    assert drive.read("VACTUAL") > 0
    drive.plant.blocked = True
    wait(drive, 0.2)
    assert (drive.read("VACTUAL") == 0) is (found and stops)
    assert bit(drive.read("RAMP_STAT"), 6) is (found and stops)
    if not stops:
        assert bit(drive.read("DRV_STATUS"), 24) is found
        # it goes on at its least velocity, and the steps are lost
        assert turns_a_second(drive) == pytest.approx(LEAST, rel=0.02)
        assert drive.plant_state.lost_fullsteps > 0


@pytest.mark.parametrize("vdcmin", [0, 200, FAST * ONE_TURN_A_SECOND + 300])
def test_below_its_least_velocity_there_is_no_dcstep(vdcmin: int) -> None:
    drive = drive_at(0.0, VDCMIN=vdcmin)
    assert not bit(drive.read("DRV_STATUS"), 15)
    assert turns_a_second(drive) == pytest.approx(FAST, rel=1e-4)


def test_it_ends_stealthchop_and_coolstep() -> None:
    drive = drive_at(0.0, GCONF=4, VMAX=ONE_TURN_A_SECOND)
    assert bit(drive.read("DRV_STATUS"), 14)
    drive.write("VMAX", FAST * ONE_TURN_A_SECOND)
    wait(drive, 2.0)
    assert not bit(drive.read("DRV_STATUS"), 14)
    assert bit(drive.read("DRV_STATUS"), 15)
