"""SpreadCycle's ripple: closed formulas against a chopper followed edge by edge, and what the motor does of it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from app.emulators.drive import Drive, DriveOptions, MotorOptions
from app.emulators.drive.spread_cycle import Chopper, bent, cycles
from tests.emulators.drive.rig import F_CLK, ONE_TURN_A_SECOND, RATED, TRAPEZOID, energised, wait, write

CALM = Chopper(2.3, 4.4e-3, 24.0, 24 / 16e6, (24 + 32 * 3) / 16e6, 0.068)
NARROW = Chopper(1.5, 2.8e-3, 48.0, 54 / 16e6, (24 + 32 * 5) / 16e6, 0.02)
WIDE = Chopper(1.5, 2.8e-3, 36.0, 16 / 16e6, (24 + 32 * 2) / 16e6, 0.2)
STEP_S = 5e-9
IDEAL = MotorOptions(detent_torque_nm=0.0, friction_nm=0.0)
PEAK_A = 4.2 * (RATED + 1) / 32


def followed(chopper: Chopper, wanted_a: float) -> tuple[float, float, float]:
    """Mean [A], ripple [A] and length [s] of the last of 30 cycles that are followed in steps of `STEP_S`."""
    i, mean, ripple, length_s = wanted_a, 0.0, 0.0, 0.0
    upper, lower = max(wanted_a + chopper.band_a / 2, 0.0), max(wanted_a - chopper.band_a / 2, 0.0)
    for _ in range(30):
        seen: list[float] = []
        for volts, driven in ((chopper.supply_v, True), (0.0, False), (-chopper.supply_v, True), (0.0, False)):
            began = len(seen)
            while True:
                i += (volts - chopper.resistance_ohm * i) / chopper.inductance_h * STEP_S
                seen.append(i)
                passed_s = (len(seen) - began) * STEP_S
                if not driven and passed_s >= chopper.decay_s:
                    break
                if driven and passed_s >= chopper.blank_s and (i >= upper if volts > 0 else i <= lower):
                    break
        mean, ripple, length_s = float(np.mean(seen)), max(seen) - min(seen), len(seen) * STEP_S
    return mean, ripple, length_s


@pytest.mark.parametrize(
    ("chopper", "wanted_a"), [(CALM, 0.004), (CALM, 0.3), (CALM, 1.5), (NARROW, 0.2), (NARROW, 1.7), (WIDE, 0.02)]
)
def test_the_formulas_agree_with_a_chopper_followed_edge_by_edge(chopper: Chopper, wanted_a: float) -> None:
    mean, ripple, length_s = followed(chopper, wanted_a)
    found = cycles(chopper, np.array([wanted_a]))
    assert found.mean_a[0] == pytest.approx(max(mean, 0.0), abs=0.02 * chopper.band_a + 0.005 * wanted_a)
    assert found.ripple_a[0] == pytest.approx(ripple, rel=0.05)
    assert found.length_s[0] == pytest.approx(length_s, rel=0.05)


def test_what_the_blank_time_drives_is_lost_near_zero_and_enough_hysteresis_holds_it() -> None:
    """Peak less half of V t_blank / L, of a band that is narrower; the reference itself where both are the same."""
    blank_a = NARROW.supply_v * NARROW.blank_s / NARROW.inductance_h
    small = 0.04
    lost = float(cycles(NARROW, np.array([small])).mean_a[0])
    assert lost == pytest.approx(small + NARROW.band_a / 2 - blank_a / 2, abs=0.004)
    even = Chopper(0.05, 2.8e-3, 48.0, NARROW.blank_s, NARROW.decay_s, blank_a)
    assert float(cycles(even, np.array([small])).mean_a[0]) == pytest.approx(small, abs=1e-3)


def test_a_current_that_the_supply_cannot_drive_is_not_chopped() -> None:
    weak = Chopper(10.0, 4e-3, 12.0, 1e-6, 5e-6, 0.05)
    found = cycles(weak, np.array([1.5]))
    assert (found.mean_a[0], found.ripple_a[0]) == (1.5, 0.0)
    off = cycles(Chopper(10.0, 4e-3, 0.0, 1e-6, 5e-6, 0.05), np.array([0.0, 1.5]))
    assert off.mean_a.tolist() == [0.0, 1.5]


def test_a_wave_is_bent_alike_on_both_sides_and_not_at_all_without_current() -> None:
    wave = np.sin(np.linspace(0.1, 2 * math.pi + 0.1, 64, endpoint=False))
    once = bent(NARROW, wave, 1.7)
    assert bent(NARROW, -wave, 1.7) == pytest.approx(-once)
    assert np.max(np.abs(once - wave)) > 0.01
    assert bent(NARROW, wave, 0.0) is wave


def conf(hysteresis: int, tbl: int = 2, toff: int = 3) -> int:
    start = min(8, hysteresis + 3)
    return toff | (start - 1) << 4 | (hysteresis - start + 3) << 7 | tbl << 15


def coil_a(drive: Drive) -> float:
    """Its current a microstep before zero [A], the shaft clamped."""
    drive.plant.blocked = True
    write(drive, {"XTARGET": -3, "VMAX": ONE_TURN_A_SECOND})
    wait(drive, 0.5)
    return drive.plant_state.current_a_a


def test_the_coil_gets_what_the_chopper_makes_of_the_table() -> None:
    drive = energised(motor=IDEAL, ripple=True)
    drive.write("CHOPCONF", conf(-2, tbl=3))
    wave = math.sin(-2.5 * math.pi / 512) * PEAK_A
    assert coil_a(drive) == pytest.approx(0.0, abs=1e-6)
    assert coil_a(energised(motor=IDEAL)) == pytest.approx(wave, rel=0.1)
    drive.write("CHOPCONF", conf(6, tbl=1))
    wait(drive, 0.1)
    assert drive.plant_state.current_a_a < 0.5 * wave


def vibration(hysteresis: int, *, ripple: bool = True, stealth: bool = False, supply_v: float = 36.0) -> float:
    """Of the shaft at half a turn a second: standard deviation of its load angle [deg electrical]."""
    options = DriveOptions(motor=IDEAL, ripple=ripple, supply_v=supply_v, full_scale_a=2.1)
    drive = Drive(options)
    write(drive, TRAPEZOID | {"CHOPCONF": conf(hysteresis), "IHOLD_IRUN": 31 | 31 << 8 | 1 << 16})
    if stealth:
        write(drive, {"GCONF": 4, "PWMCONF": 0xC40C001E})
    write(drive, {"VMAX": ONE_TURN_A_SECOND // 2, "RAMPMODE": 1})
    wait(drive, 1.0)
    seen = []
    for _ in range(500):
        drive.advance(drive.clocks + round(F_CLK / 1000))
        seen.append(drive.plant_state.load_angle_deg)
    return float(np.std(seen))


def test_too_little_hysteresis_shakes_the_shaft_and_more_than_enough_no_more_than_enough() -> None:
    shaken, enough, more = (vibration(each) for each in (-2, 8, 14))
    assert shaken > 2 * enough
    assert more == pytest.approx(enough, rel=0.25)
    assert vibration(-2, supply_v=14.0) < 0.8 * shaken


def test_neither_without_the_option_nor_with_stealthchop_does_hysteresis_matter() -> None:
    assert vibration(-2, ripple=False) == vibration(8, ripple=False)
    assert vibration(-2, stealth=True) == vibration(8, stealth=True)
