"""A supply behind a resistance: what the coils draw lowers the voltage that drives them."""

from __future__ import annotations

import math

import pytest

from app.emulators.drive import Drive, EventKind

from .rig import F_CLK, ONE_TURN_A_SECOND, energised, until, wait, write

SUPPLY_V = 24.0


def electrical_w(drive: Drive) -> float:
    """Power into both coils at the latest tick."""
    now = drive.plant_state
    return now.voltage_a_v * now.current_a_a + now.voltage_b_v * now.current_b_a


def turning(turns: float, ohm: float, supply_v: float = SUPPLY_V) -> Drive:
    drive = energised(load={"inertia_kgm2": 2e-6}, supply_v=supply_v, supply_resistance_ohm=ohm)
    write(drive, {"AMAX": 600, "VMAX": round(turns * ONE_TURN_A_SECOND), "RAMPMODE": 1})
    until(drive, EventKind.VELOCITY_REACHED)
    wait(drive, 0.3)
    return drive


def pull_out(ohm: float, supply_v: float) -> tuple[float, float]:
    """The greatest load that is held at 12 turns a second [N m], and the voltage at the driver with it [V]."""
    drive, load_nm, volts = turning(12, ohm, supply_v), 0.0, supply_v
    while drive.plant_state.lost_fullsteps == 0:
        volts = drive.plant_state.supply_v
        load_nm += 0.01
        drive.plant.load_torque_nm = load_nm
        wait(drive, 0.1)
    return load_nm, volts


@pytest.mark.parametrize("ohm", [0.5, 4.0])
def test_a_standing_motor_draws_what_its_coils_heat(ohm: float) -> None:
    drive = energised(supply_resistance_ohm=ohm)
    volts = drive.plant_state.supply_v
    assert (SUPPLY_V - volts) / ohm * volts == pytest.approx(electrical_w(drive), rel=1e-4)
    assert electrical_w(drive) > 5
    wait(drive, 0.5)
    assert drive.quiet, "it comes to rest with its supply"


def test_at_speed_the_voltage_falls_by_resistance_times_supply_current() -> None:
    drive, powers = turning(5, 3.0), []
    volts = drive.plant_state.supply_v
    for _ in range(400):
        drive.advance(drive.clocks + 256)
        powers.append(electrical_w(drive))
    current = sum(powers) / len(powers) / volts
    assert volts == pytest.approx(SUPPLY_V - 3.0 * current, rel=0.01)
    assert volts < SUPPLY_V - 0.5


def test_a_sagging_supply_leaves_less_torque_at_speed_as_a_lower_one_does() -> None:
    stiff, _ = pull_out(0.0, SUPPLY_V)
    sagging, volts = pull_out(5.0, SUPPLY_V)
    lower, _ = pull_out(0.0, volts)
    assert sagging < 0.8 * stiff
    assert sagging == pytest.approx(lower, abs=0.021)


def test_a_supply_that_sags_below_what_the_bridges_need_is_an_undervoltage() -> None:
    """They let go, the supply comes back, and the chip has latched it until that is cleared."""
    drive = energised(current=31, supply_v=10.0, supply_resistance_ohm=2.0)
    assert drive.gstat & 4
    seen = set()
    for _ in range(2000):
        drive.advance(drive.clocks + 256)
        seen.add((drive.undervoltage, drive.plant_state.bridges))
    assert (True, "regulated") in seen
    assert (False, "open") in seen
    write(drive, {"IHOLD_IRUN": 0})
    wait(drive, 1.0)
    assert drive.gstat & 4, "latched"
    drive.write("GSTAT", 7)
    wait(drive, 0.1)
    assert drive.gstat == 0
    assert drive.plant_state.supply_v == pytest.approx(10.0, abs=0.2)


def test_no_voltage_is_beyond_the_supplys_own_or_below_none_however_great_the_resistance() -> None:
    drive = energised(current=31, supply_v=30.0, supply_resistance_ohm=20.0)
    write(drive, {"VMAX": 3 * ONE_TURN_A_SECOND, "RAMPMODE": 1})
    for _ in range(20_000):
        drive.advance(drive.clocks + 256)
        assert 0.0 <= drive.plant_state.supply_v <= 30.0
        assert math.isfinite(drive.plant_state.torque_nm)


def test_in_how_many_pieces_time_is_advanced_makes_no_difference_to_a_sagging_supply() -> None:
    ends = []
    for pieces in (1, 13):
        drive = energised(supply_resistance_ohm=3.0)
        drive.write("XTARGET", 20_000)
        begin = drive.clocks
        for piece in range(1, pieces + 1):
            drive.advance(begin + round(0.8 * F_CLK * piece / pieces))
        ends.append(drive.plant_state)
    assert ends[0] == ends[1]
