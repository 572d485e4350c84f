"""The chopper with constant off time, and what changes at high velocity: full steps and slow decay alone."""

from __future__ import annotations

import math

import pytest

from app.emulators.drive import TICK_CLOCKS, Drive, MotorOptions
from tests.emulators.drive.rig import CHOPPER_ON, ONE_TURN_A_SECOND, RATED, TICK_S, bit, energised, wait, write

PEAK_A = 4.2 * (RATED + 1) / 32
VHIGHFS, VHIGHCHM, CHM = 1 << 18, 1 << 19, 1 << 14
IDEAL = MotorOptions(detent_torque_nm=0.0, friction_nm=0.0)


def constant_off(toff: int, tfd: int, offset: int = 0, tbl: int = 2) -> int:
    return CHM | toff | (tfd & 7) << 4 | tfd >> 3 << 11 | offset + 3 << 7 | tbl << 15


def currents(drive: Drive, seconds: float) -> list[tuple[float, float]]:
    """Of coil A and B, tick by tick."""
    seen = []
    for _ in range(round(seconds / TICK_S)):
        drive.advance(drive.clocks + TICK_CLOCKS)
        seen.append((drive.plant_state.current_a_a, drive.plant_state.current_b_a))
    return seen


def falling(toff: int, tfd: int, tbl: int) -> float:
    """Time [s] in which the current of coil B falls from its peak to half of it, the shaft clamped."""
    drive = energised(motor=IDEAL)
    drive.plant.blocked = True
    drive.write("CHOPCONF", constant_off(toff, tfd, tbl=tbl))
    wait(drive, 0.1)
    whole = drive.plant_state.current_b_a
    drive.write("IHOLD_IRUN", 0)
    for tick, (_, now) in enumerate(currents(drive, 0.1)):
        if now < whole / 2:
            return tick * TICK_S
    raise AssertionError("it never fell")


@pytest.mark.parametrize(("toff", "tfd", "tbl"), [(3, 0, 2), (3, 4, 2), (3, 12, 2), (8, 12, 2), (3, 12, 3), (3, 2, 0)])
def test_with_constant_off_time_a_current_falls_as_fast_as_its_fast_decay_lets_it(
    toff: int, tfd: int, tbl: int
) -> None:
    """R i + L di/dt = -V share, of which share is left of a cycle; without fast decay resistance alone."""
    blank = (16, 24, 36, 54)[tbl]
    share = max(32 * tfd - blank, 0) / (blank + 32 * tfd + 24 + 32 * toff)
    motor = MotorOptions()
    low = 24 * share / motor.resistance_ohm
    expected = motor.inductance_h / motor.resistance_ohm * math.log((PEAK_A + low) / (PEAK_A / 2 + low))
    assert falling(toff, tfd, tbl) == pytest.approx(expected, rel=0.05, abs=2.5e-4)


def test_without_fast_decay_the_wave_is_distorted_at_speed_and_with_it_not() -> None:
    worst = []
    for tfd in (0, 3, 15):
        drive = energised(motor=IDEAL)
        drive.write("CHOPCONF", constant_off(3, tfd))
        write(drive, {"VMAX": 2 * ONE_TURN_A_SECOND, "RAMPMODE": 1})
        wait(drive, 1.0)
        worst.append(max(abs(math.hypot(a, b) - PEAK_A) for a, b in currents(drive, 0.02)))
    assert worst[0] > 0.2 * PEAK_A
    assert worst[0] > worst[1] > worst[2]
    assert worst[2] < 0.05 * PEAK_A


@pytest.mark.parametrize("offset", [-3, 0, 5, 12])
def test_the_sine_offset_is_added_to_the_amount(offset: int) -> None:
    drive = energised(motor=IDEAL)
    drive.write("CHOPCONF", constant_off(3, 12, offset))
    wait(drive, 0.2)
    assert drive.plant_state.current_b_a == pytest.approx(PEAK_A * (247.5 / 248 + offset / 512), abs=1e-6)
    assert drive.plant_state.current_a_a == pytest.approx(PEAK_A * (0.5 / 248 + offset / 512), abs=1e-6)


@pytest.mark.parametrize("by_velocity", [False, True])
def test_full_steps_begin_at_the_high_velocity_and_end_below_it(by_velocity: bool) -> None:
    drive = energised(motor=IDEAL)
    drive.write("CHOPCONF", CHOPPER_ON | VHIGHFS)
    if by_velocity:
        drive.set_velocity_window(0, 3 * ONE_TURN_A_SECOND)
    else:
        drive.write("THIGH", 2**24 // (3 * ONE_TURN_A_SECOND))
    for turns, full in ((2.7, False), (3.5, True), (1.5, False)):  # far above the motor's resonance
        write(drive, {"VMAX": round(turns * ONE_TURN_A_SECOND), "RAMPMODE": 1})
        wait(drive, 1.0)
        assert bit(drive.read("DRV_STATUS"), 15) is full
        seen = currents(drive, 0.02)
        both = sum(abs(abs(a) - abs(b)) < 0.02 for a, b in seen)
        assert (both > len(seen) / 2) is full
        if full:
            assert max(abs(a) for a, _ in seen) == pytest.approx(PEAK_A / math.sqrt(2), rel=0.01)
    assert drive.plant_state.lost_fullsteps == 0
    write(drive, {"XTARGET": 0, "RAMPMODE": 0, "VMAX": 3 * ONE_TURN_A_SECOND})
    wait(drive, 10.0)
    assert drive.plant_state.rotor_fullsteps == pytest.approx(drive.plant_state.field_fullsteps, abs=0.02)


def test_full_steps_shake_the_motor() -> None:
    ripples = []
    for conf in (CHOPPER_ON, CHOPPER_ON | VHIGHFS):
        drive = energised(motor=IDEAL)
        write(drive, {"CHOPCONF": conf, "THIGH": 0xFFFFF, "VMAX": ONE_TURN_A_SECOND, "RAMPMODE": 1})
        wait(drive, 1.0)
        speeds = []
        for _ in range(1000):
            drive.advance(drive.clocks + TICK_CLOCKS)
            speeds.append(drive.plant_state.speed_rad_s)
        ripples.append(max(speeds) - min(speeds))
    assert ripples[1] > 10 * ripples[0]


def test_vhighchm_leaves_slow_decay_alone_at_high_velocity() -> None:
    worst = []
    for more in (0, VHIGHCHM):
        drive = energised(motor=IDEAL)
        thresholds = {"CHOPCONF": CHOPPER_ON | more, "THIGH": 2**24 // ONE_TURN_A_SECOND}
        write(drive, thresholds | {"VMAX": ONE_TURN_A_SECOND // 4, "RAMPMODE": 1})
        wait(drive, 1.0)
        slow = max(abs(math.hypot(a, b) - PEAK_A) for a, b in currents(drive, 0.05))
        assert slow < 0.05 * PEAK_A
        drive.write("VMAX", 2 * ONE_TURN_A_SECOND)
        wait(drive, 1.0)
        worst.append(max(abs(math.hypot(a, b) - PEAK_A) for a, b in currents(drive, 0.02)))
    assert worst[0] < 0.1 * PEAK_A
    assert worst[1] > 0.2 * PEAK_A
