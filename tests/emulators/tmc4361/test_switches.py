"""Stop switches, virtual stops, latches, home, compare position and circular motion of an emulated TMC4361."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest

from tests.emulators.tmc4361.rig import (
    HOLD_VELOCITY,
    S_POSITION,
    S_VELOCITY,
    TRAPEZOID_POSITION,
    TRAPEZOID_VELOCITY,
    Ramp,
    Rig,
)

BASE = Ramp(vmax=20_000.0)
STOP_L, STOP_R, POL_L, POL_R, INVERT, SOFT = (1 << n for n in range(6))
VIRT_L, VIRT_R, HARD, LINEAR = 1 << 6, 1 << 7, 1 << 8, 2 << 8
CIRCULAR, CLEAR_AT_TARGET, TRACK_HOME = 1 << 22, 1 << 21, 1 << 20


def high_active(conf: int = 0) -> int:
    return STOP_L | STOP_R | POL_L | POL_R | conf


# --- STOPL, STOPR ------------------------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "9.1")
@pytest.mark.parametrize(("sign", "pin", "flag"), [(-1, "left", 7), (1, "right", 8)])
def test_a_stop_switch_stops_its_direction_at_once(sign: int, pin: str, flag: int) -> None:
    rig = Rig()
    rig.write("REFERENCE_CONF", high_active())
    rig.ramp(replace(BASE, vmax=sign * 20_000.0), TRAPEZOID_VELOCITY)
    rig.wait(0.5)
    rig.events()
    rig.patch(switches={pin: True})
    rig.wait(1e-4)
    assert rig.signed("VACTUAL") == 0
    assert rig.flag(flag)
    assert {"left": "STOPL_EVENT", "right": "STOPR_EVENT"}[pin] in rig.events()
    stood = rig.position
    rig.wait(1.0)
    assert rig.position == stood


@pytest.mark.sheet("DS-TMC4361", "9.1")
def test_the_other_direction_stays_open() -> None:
    rig = Rig()
    rig.write("REFERENCE_CONF", high_active())
    rig.patch(switches={"left": True})
    rig.ramp(BASE, TRAPEZOID_VELOCITY)
    rig.wait(0.5)
    assert rig.signed("VACTUAL") == 20_000
    rig.write("VMAX", -20_000 << 8)
    rig.wait(1.0)
    assert rig.signed("VACTUAL") == 0


@pytest.mark.sheet("DS-TMC4361", "9.1")
def test_a_soft_stop_is_a_straight_slope_of_dstop_without_vstop() -> None:
    rig = Rig()
    rig.write("REFERENCE_CONF", high_active(SOFT))
    rig.ramp(replace(BASE, dstop=100_000.0, vstop=8000.0), S_VELOCITY)
    rig.wait(0.5)
    rig.patch(switches={"right": True})
    speeds = []
    for _ in range(20):
        rig.wait(0.01)
        speeds.append(rig.signed("VACTUAL"))
        if speeds[-1]:
            assert rig.signed("AACTUAL") == -100_000
    assert speeds == [pytest.approx(20_000 - 1000 * n, abs=10) for n in range(1, 20)] + [0]


def test_a_soft_stop_without_dstop_is_a_hard_one() -> None:
    """In no source; the other reading, no stop at all, would drive into the switch."""
    rig = Rig()
    rig.write("REFERENCE_CONF", high_active(SOFT))
    rig.ramp(replace(BASE, dstop=0.0), TRAPEZOID_VELOCITY)
    rig.wait(0.5)
    rig.patch(switches={"right": True})
    rig.wait(1e-4)
    assert rig.signed("VACTUAL") == 0


@pytest.mark.sheet("DS-TMC4361", "9.1")
def test_a_closed_direction_opens_when_event_and_switch_are_gone() -> None:
    rig = Rig()
    rig.write("REFERENCE_CONF", high_active())
    rig.ramp(BASE, TRAPEZOID_VELOCITY)
    rig.wait(0.5)
    rig.patch(switches={"right": True})
    rig.wait(0.1)
    rig.events()
    rig.wait(0.1)
    assert rig.signed("VACTUAL") == 0  # the switch is still active
    rig.patch(switches={"right": False})
    rig.wait(0.2)
    assert rig.signed("VACTUAL") == 20_000
    rig.patch(switches={"right": True})
    rig.wait(0.1)
    rig.patch(switches={"right": False})
    rig.wait(0.2)
    assert rig.signed("VACTUAL") == 0  # the event is still there
    assert not rig.flag(8)
    rig.events()
    rig.wait(0.2)
    assert rig.signed("VACTUAL") == 20_000


@pytest.mark.sheet("DS-TMC4361", "9.1")
def test_disabling_the_switch_opens_the_direction_too() -> None:
    rig = Rig()
    rig.write("REFERENCE_CONF", high_active())
    rig.ramp(BASE, TRAPEZOID_VELOCITY)
    rig.wait(0.5)
    rig.patch(switches={"right": True})
    rig.wait(0.1)
    rig.events()
    rig.write("REFERENCE_CONF", high_active() & ~STOP_R)
    rig.wait(0.2)
    assert rig.signed("VACTUAL") == 20_000


@pytest.mark.sheet("DS-TMC4361", "17.2")
def test_polarity_and_inverted_directions() -> None:
    rig = Rig()
    rig.write("REFERENCE_CONF", STOP_L | INVERT)  # low active, and nothing presses it
    rig.ramp(BASE, TRAPEZOID_VELOCITY)
    rig.wait(0.5)
    assert rig.signed("VACTUAL") == 0  # STOPL closes the positive direction
    rig.write("VMAX", -20_000 << 8)
    rig.wait(0.5)
    assert rig.signed("VACTUAL") == -20_000


def test_the_stage_presses_its_switches() -> None:
    rig = Rig()
    rig.patch(stage={"right_at_fullsteps": 20.0})
    rig.write("REFERENCE_CONF", high_active())
    rig.ramp(BASE, TRAPEZOID_VELOCITY)
    rig.wait(2.0)
    assert rig.position == pytest.approx(20 * 256, abs=400)
    assert rig.state().switches.right.active


# --- virtual stops -------------------------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "9.2")
@pytest.mark.sheet("DS-TMC4361", "9")
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_virtual_stop_acts_where_xactual_meets_it(sign: int) -> None:
    rig = Rig()
    rig.write("VIRT_STOP_LEFT", -10_000)
    rig.write("VIRT_STOP_RIGHT", 10_000)
    rig.write("REFERENCE_CONF", VIRT_L | VIRT_R | HARD)
    rig.ramp(BASE, TRAPEZOID_POSITION)
    rig.write("XTARGET", sign * 50_000)
    rig.wait(2.0)
    assert rig.position == sign * 10_000
    assert rig.flag(9 if sign < 0 else 10)
    assert {-1: "VSTOPL_ACTIVE", 1: "VSTOPR_ACTIVE"}[sign] in rig.events()
    rig.write("XTARGET", 0)
    rig.wait(2.0)
    assert rig.position == 0  # the way back is open
    rig.events()
    rig.write("VIRT_STOP_LEFT", -60_000)
    rig.write("VIRT_STOP_RIGHT", 60_000)
    rig.write("XTARGET", sign * 50_000)
    rig.wait(5.0)
    assert rig.position == sign * 50_000


@pytest.mark.sheet("DS-TMC4361", "9.2")
def test_a_linear_virtual_stop_slopes_down_with_dstop_and_knows_no_inversion() -> None:
    rig = Rig()
    rig.write("VIRT_STOP_RIGHT", 10_000)
    rig.write("REFERENCE_CONF", VIRT_R | LINEAR | INVERT)
    rig.ramp(replace(BASE, dstop=100_000.0), TRAPEZOID_VELOCITY)
    rig.wait(3.0)
    assert rig.position == pytest.approx(12_000, abs=3)


# --- latches -------------------------------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "17.2")
@pytest.mark.parametrize(("bit", "pin", "edge"), [(10, "left", 0), (11, "left", 1), (12, "right", 0), (13, "right", 1)])
def test_x_latch_takes_xactual_at_the_chosen_edge(bit: int, pin: str, edge: int) -> None:
    rig = Rig()
    rig.write("REFERENCE_CONF", POL_L | POL_R | 1 << bit)
    rig.ramp(BASE, HOLD_VELOCITY)
    rig.events()
    found = {}
    for level in (1, 0):
        rig.wait(0.1)
        rig.patch(switches={pin: bool(level)})
        rig.wait(1e-5)
        if "XLATCH_DONE" in rig.events():
            found[level] = rig.position
    assert list(found) == [edge]
    assert rig.signed("X_LATCH") == pytest.approx(found[edge], abs=2)


# --- home ----------------------------------------------------------------------------------------------------------


def sweep(home_event: int, sign: int) -> int:
    """X_HOME after driving over a home zone of 4000..6000 in direction `sign`."""
    rig = Rig()
    rig.patch(switches={"home": False})
    begin = 0 if sign > 0 else 10_000
    rig.write("XACTUAL", begin)
    rig.write("XTARGET", begin)
    rig.write("X_HOME", 0x7FFF)
    rig.write("REFERENCE_CONF", home_event << 16 | TRACK_HOME)
    rig.ramp(replace(BASE, vmax=sign * 20_000.0), HOLD_VELOCITY)
    for _ in range(1250):
        rig.wait(0.0004)
        inside = 4000 <= rig.position < 6000
        rig.patch(switches={"home": inside})
    assert not rig.read("REFERENCE_CONF") & TRACK_HOME
    assert "XLATCH_DONE" in rig.events()
    return rig.signed("X_HOME")


@pytest.mark.sheet("DS-TMC4361", "9.3")
@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize(("home_event", "place"), [(2, 4000), (4, 6000), (6, 5000), (3, 4000), (12, 6000)])
def test_x_home_is_found_where_home_event_says(home_event: int, place: int, sign: int) -> None:
    assert sweep(home_event, sign) == pytest.approx(place, abs=20)


@pytest.mark.sheet("DS-TMC4361", "9.3")
def test_low_zones_are_found_as_high_ones() -> None:
    assert sweep(13, 1) == pytest.approx(6000, abs=20)  # the level falls there: a low zone begins
    assert sweep(11, 1) == pytest.approx(4000, abs=20)


@pytest.mark.sheet("DS-TMC4361", "9.3")
def test_home_event_0_waits_for_the_next_n_event() -> None:
    rig = Rig()
    rig.write("X_HOME", 123_456)
    rig.write("ENC_IN_RES", 40_000)
    rig.write("ENC_IN_CONF", 0x400 | 1 << 4 | 1 << 5)  # N high active, the edge to it counts
    rig.write("REFERENCE_CONF", TRACK_HOME)
    rig.ramp(BASE, TRAPEZOID_VELOCITY)
    rig.wait(6.0)  # two turns
    assert not rig.read("REFERENCE_CONF") & TRACK_HOME
    assert rig.signed("X_HOME") == pytest.approx(37.3 * 256, abs=400)


@pytest.mark.sheet("DS-TMC4361", "9.3")
@pytest.mark.parametrize(("bit", "pin", "sign"), [(14, "left", -1), (15, "right", 1)])
def test_a_stop_switch_can_be_home(bit: int, pin: str, sign: int) -> None:
    rig = Rig()
    rig.write("REFERENCE_CONF", high_active() | 1 << bit | 3 << 16 | TRACK_HOME)
    rig.ramp(replace(BASE, vmax=sign * 20_000.0), HOLD_VELOCITY)
    rig.wait(0.1)
    rig.patch(switches={pin: True})
    rig.wait(1e-3)
    assert rig.signed("X_HOME") == rig.position == pytest.approx(sign * 2000, abs=2)
    assert not rig.read("REFERENCE_CONF") & TRACK_HOME


@pytest.mark.sheet("DS-TMC4361", "9.3")
@pytest.mark.sheet("DS-TMC4361", "9")
def test_home_error_is_not_judged_within_the_margin() -> None:
    rig = Rig()
    rig.patch(switches={"home": True})
    rig.write("X_HOME", 0)
    rig.write("HOME_SAFETY_MARGIN", 1000)
    rig.write("REFERENCE_CONF", 3 << 16)  # 0 on the negative side
    rig.write("XACTUAL", -1000)
    assert not rig.flag(12)
    rig.events()
    rig.write("XACTUAL", -1001)
    assert rig.flag(12)
    assert "HOME_ERROR" in rig.events()
    rig.write("XACTUAL", 5000)
    assert not rig.flag(12)


def test_home_error_as_a_copy_of_the_pin() -> None:
    """The vendor's firmware trick: home_event 3 and X_HOME far to the right."""
    rig = Rig()
    rig.write("X_HOME", 0x7FFFFFFF)
    rig.write("REFERENCE_CONF", 3 << 16)
    for level in (False, True, False):
        rig.patch(switches={"home": level})
        assert rig.flag(12) is level


# --- compare, cycles, circles ---------------------------------------------------------------------------------------


@pytest.mark.sheet("DS-TMC4361", "9.5")
def test_pos_comp_tells_when_it_is_passed_however_fast() -> None:
    rig = Rig()
    rig.write("POS_COMP", 123_457)
    rig.ramp(Ramp(vmax=4e6), HOLD_VELOCITY)  # 16 steps a tick
    rig.events()
    rig.wait(0.0308)
    assert "POS_COMP_REACHED" not in rig.events()
    rig.wait(0.0002)
    assert "POS_COMP_REACHED" in rig.events()
    assert rig.position > 123_457


@pytest.mark.sheet("DS-TMC4361", "9.5")
def test_other_positions_can_be_compared() -> None:
    rig = Rig()
    rig.write("POS_COMP", 111)
    rig.write("X_HOME", 222)
    rig.write("REFERENCE_CONF", 1 << 28)
    rig.write("XACTUAL", 111)
    assert not rig.flag(1)
    rig.write("XACTUAL", 222)
    assert rig.flag(1)
    rig.write("REFERENCE_CONF", 2 << 28)
    assert not rig.flag(1)
    rig.write("XACTUAL", 0)  # X_LATCH
    assert rig.flag(1)


@pytest.mark.sheet("DS-TMC4361", "9.5")
def test_the_target_reached_pin_shows_the_chosen_flag() -> None:
    rig = Rig()
    rig.write("XTARGET", 5)
    assert not rig.state().pins.target_reached
    rig.write("REFERENCE_CONF", 1 << 23)  # VEL_REACHED_F
    assert rig.state().pins.target_reached
    rig.write("GENERAL_CONF", 0x6020 | 1 << 16)
    assert not rig.state().pins.target_reached


@pytest.mark.sheet("DS-TMC4361", "9.4")
@pytest.mark.sheet("DS-TMC4361", "9")
def test_clr_pos_at_target_makes_endless_cycles() -> None:
    rig = Rig()
    rig.write("REFERENCE_CONF", CLEAR_AT_TARGET)
    rig.ramp(BASE, TRAPEZOID_POSITION)
    rig.write("XTARGET", 2000)
    rig.wait(3.0)
    assert rig.state().step_output.microsteps_256 > 8000
    assert 0 <= rig.position < 2000
    assert "TARGET_REACHED" in rig.events()


def circle(half: int, decimals: int = 0) -> Rig:
    rig = Rig()
    rig.write("X_LATCH", half)  # a write is X_RANGE
    rig.write("CIRCULAR_DEC", decimals)
    rig.write("REFERENCE_CONF", CIRCULAR)
    rig.write("GENERAL_CONF", 0x6020 | 1 << 27)  # 0x36 reads REV_CNT
    return rig


@pytest.mark.sheet("DS-TMC4361", "17.2")
def test_circular_motion_wraps_and_counts_turns() -> None:
    rig = circle(1000)
    rig.ramp(BASE, HOLD_VELOCITY)
    rig.wait(0.225)  # 4500 steps: 2 turns and 500
    assert rig.position == pytest.approx(500, abs=1)
    assert rig.signed("X_LATCH") == 2
    rig.write("VMAX", -20_000 << 8)
    rig.wait(0.35)
    assert rig.position == pytest.approx(-6500 + 3 * 2000, abs=1)
    assert rig.signed("X_LATCH") == -1
    rig.write("REFERENCE_CONF", 0)
    assert rig.signed("X_LATCH") == 0


@pytest.mark.parametrize(
    ("begin", "target", "way"), [(0, 900, 900), (-900, 900, -200), (900, -900, 200), (500, 0, -500)]
)
def test_circular_positioning_takes_the_shorter_way(begin: int, target: int, way: int) -> None:
    rig = circle(1000)
    rig.write("XACTUAL", begin)
    rig.ramp(BASE, S_POSITION)
    rig.write("XTARGET", target)
    rig.wait_for_rest()
    assert rig.position == target
    assert rig.state().step_output.microsteps_256 == way


def test_circular_dec_adds_up_to_whole_steps() -> None:
    """601 steps a turn as X_RANGE 300 and one more; 600.25 as one more every fourth turn."""
    for decimals, turns, steps in ((0x80000000, 5, 601 * 5), (0x20000000, 8, 600 * 8 + 2)):
        rig = circle(300, decimals)
        rig.ramp(BASE, TRAPEZOID_POSITION)
        for _ in range(3 * turns):
            rig.write("XTARGET", (rig.position + 200 + 300) % 600 - 300)
            rig.wait_for_rest()
        assert rig.position == 0
        assert rig.signed("X_LATCH") == turns
        assert rig.state().step_output.microsteps_256 == steps


def test_circular_moves_there_and_back_lose_nothing() -> None:
    source = random.Random(9)
    rig = circle(300, 0x55555555)
    rig.ramp(BASE, S_POSITION)
    for _ in range(40):
        target = source.randint(-300, 299)
        rig.write("XTARGET", target)
        rig.wait(source.uniform(0, 0.05))
    rig.write("XTARGET", 0)
    rig.wait_for_rest()
    assert rig.position == 0
    turns = rig.signed("X_LATCH")
    surplus = int((turns * 0x55555555 / 2**31) // 1)
    assert rig.state().step_output.microsteps_256 == 600 * turns + surplus


def test_a_blocked_zone_of_circular_motion_is_closed_from_both_sides() -> None:
    rig = circle(1000)
    rig.write("VIRT_STOP_LEFT", 600)
    rig.write("VIRT_STOP_RIGHT", 400)
    rig.write("REFERENCE_CONF", CIRCULAR | VIRT_L | VIRT_R | HARD)
    rig.ramp(replace(BASE, vmax=10_000.0), HOLD_VELOCITY)
    rig.wait(0.5)
    assert rig.position == 400
    rig.write("VMAX", -10_000 << 8)
    rig.wait(0.5)
    assert rig.position == 600
