"""The stage's switches, and what SW_MODE makes of them."""

from __future__ import annotations

import pytest

from app.emulators.drive import Drive, EventKind, StageSwitches
from tests.emulators.drive.rig import (
    ONE_TURN_A_SECOND,
    SECOND,
    acceleration,
    bit,
    energised,
    until,
    velocity,
    wait,
    write,
)

STAGE = StageSwitches(
    left_at_fullsteps=-100.0, right_at_fullsteps=120.0, home_from_fullsteps=40.0, home_to_fullsteps=44.0
)
LEFT, RIGHT, SOFT = 1, 2, 1 << 11


def staged(mode: int = LEFT | RIGHT, **registers: int) -> Drive:
    drive = energised(stage=STAGE)
    write(drive, {"SW_MODE": mode, "VMAX": ONE_TURN_A_SECOND, "AMAX": 1000, "DMAX": 1000} | registers)
    return drive


def test_a_switch_follows_the_rotor() -> None:
    drive = staged(0, XTARGET=256 * 200)
    for kind, place in ((EventKind.SWITCH_HOME, 40), (EventKind.SWITCH_HOME, 44), (EventKind.SWITCH_RIGHT, 120)):
        until(drive, kind)
        assert drive.plant_state.rotor_fullsteps == pytest.approx(place, abs=0.2)
        assert drive.read("XACTUAL") == pytest.approx(place * 256, abs=60)
    assert drive.switches.right
    assert bit(drive.read("RAMP_STAT"), 1)
    assert not drive.switches.left
    assert not drive.switches.home


def test_a_switch_with_backlash_is_released_behind_where_it_is_pressed() -> None:
    drive = energised(stage=STAGE.model_copy(update={"backlash_fullsteps": 6.0}))
    write(drive, {"VMAX": ONE_TURN_A_SECOND, "AMAX": 1000, "DMAX": 1000, "XTARGET": 256 * 130})
    for place in (40, 44 + 6):
        until(drive, EventKind.SWITCH_HOME)
        assert drive.plant_state.rotor_fullsteps == pytest.approx(place, abs=0.2)
    until(drive, EventKind.SWITCH_RIGHT)
    assert drive.plant_state.rotor_fullsteps == pytest.approx(120, abs=0.2)
    until(drive, EventKind.POSITION_REACHED)
    write(drive, {"XTARGET": 0})
    until(drive, EventKind.SWITCH_RIGHT)
    assert drive.plant_state.rotor_fullsteps == pytest.approx(120 - 6, abs=0.2)


def test_a_hard_stop_is_at_once_and_lets_the_motor_back() -> None:
    drive = staged(RAMPMODE=1, TZEROWAIT=500)
    event = until(drive, EventKind.SWITCH_STOP)
    assert event.kinds == EventKind.SWITCH_STOP
    wait(drive, 0.001)
    assert drive.read("VACTUAL") == 0
    assert drive.read("XACTUAL") == pytest.approx(120 * 256, abs=60)
    flags = drive.read("RAMP_STAT")
    assert bit(flags, 5)
    assert bit(flags, 11)  # waits TZEROWAIT
    here = drive.read("XACTUAL")
    wait(drive, 1.0)
    assert drive.read("XACTUAL") == here
    drive.write("RAMPMODE", 2)
    assert not bit(drive.read("RAMP_STAT"), 5)
    until(drive, EventKind.SWITCH_STOP)
    wait(drive, 0.01)
    assert drive.read("XACTUAL") == pytest.approx(-100 * 256, abs=60)
    assert bit(drive.read("RAMP_STAT"), 4)


def test_a_soft_stop_brakes_by_the_deceleration_ramp() -> None:
    drive = staged(LEFT | RIGHT | SOFT, RAMPMODE=2, DMAX=2000)
    until(drive, EventKind.SWITCH_STOP)
    start = drive.read("XACTUAL")
    fast = velocity(abs(drive.read("VACTUAL")))
    end = until(drive, EventKind.STOPPED).position
    assert start - end == pytest.approx(fast**2 / 2 / acceleration(2000), rel=0.01)


def test_a_positioning_move_into_a_switch_stops_there_and_goes_on_when_it_is_released() -> None:
    drive = staged(XTARGET=256 * 150)
    until(drive, EventKind.SWITCH_STOP)
    wait(drive, 0.5)
    assert drive.read("XACTUAL") < 256 * 121
    assert not bit(drive.read("RAMP_STAT"), 9)
    drive.plant.right_at_fullsteps = 500.0
    assert until(drive, EventKind.POSITION_REACHED).position == 256 * 150


@pytest.mark.parametrize(
    ("mode", "pressed", "seen"),
    [
        (0, (False, False), 0b00),
        (0, (True, False), 0b01),
        (0, (False, True), 0b10),
        (0b1100, (False, False), 0b11),
        (0b0100, (True, False), 0b00),
        (0b1_0000, (True, False), 0b10),
        (0b1_0100, (False, False), 0b10),
    ],
)
def test_polarity_comes_before_the_swap(mode: int, pressed: tuple[bool, bool], seen: int) -> None:
    drive = staged(mode)
    drive.plant.force_left, drive.plant.force_right = pressed
    wait(drive, 0.001)
    assert drive.read("RAMP_STAT") & 3 == seen
    assert (drive.switches.left, drive.switches.right) == pressed


def test_a_forced_switch_is_an_edge_and_can_be_given_back() -> None:
    drive = staged(RAMPMODE=1)
    wait(drive, 0.1)
    drive.plant.force_right = True
    event = until(drive, EventKind.SWITCH_RIGHT, 0.001)
    assert drive.plant.force_right is True
    assert event.position < 256 * 100
    wait(drive, 0.01)
    assert drive.read("VACTUAL") == 0
    drive.plant.force_right = None
    until(drive, EventKind.SWITCH_RIGHT, 0.001)
    wait(drive, 0.1)
    assert drive.read("VACTUAL") > 0
    # one that is forced open is never reached
    drive.plant.force_right = False
    wait(drive, 2.0)
    assert drive.read("XACTUAL") > 256 * 130


@pytest.mark.parametrize(("mode", "flag"), [(1 << 7, 3), (1 << 8, 3), (1 << 5, 2), (1 << 6, 2)])
def test_edges_latch_the_position(mode: int, flag: int) -> None:
    drive = staged(mode | 1 << 9)
    forward = flag == 3
    edge = 120 if forward else -100
    drive.write("XTARGET", edge * 256 + (2560 if forward else -2560))
    until(drive, EventKind.POSITION_REACHED)
    rising = bool(mode & (1 << 7 | 1 << 5))
    assert bit(drive.read("RAMP_STAT"), flag) is rising
    if not rising:
        drive.write("XTARGET", 0)
        until(drive, EventKind.POSITION_REACHED)
    assert bit(drive.read("RAMP_STAT"), flag)
    assert drive.read("XLATCH") == pytest.approx(edge * 256, abs=60)
    assert drive.read("ENC_LATCH") == pytest.approx(edge * 20, abs=3)  # 4000 counts a turn, one to one
    drive.write("RAMP_STAT", 1 << flag)
    assert not bit(drive.read("RAMP_STAT"), flag)


def test_the_shaft_turned_by_hand_presses_switches_too() -> None:
    drive = Drive()
    drive.watch = EventKind.SWITCH_LEFT
    drive.plant.rotor_fullsteps = -4000.0
    event = drive.advance(SECOND)
    assert event is not None
    assert event.clocks == 256
    assert drive.switches.left
