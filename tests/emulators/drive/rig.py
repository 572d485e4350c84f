"""Drives set up for tests, and how the continuous ramp says a move goes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from app.emulators.drive import Drive, DriveOptions, Event, EventKind

F_CLK = 16e6
TICK_S = 256 / F_CLK
SECOND = 16_000_000
ONE_TURN_A_SECOND = 53_687
"""VMAX for 51,200 microsteps/s."""
TRAPEZOID = {
    "VSTART": 0,
    "A1": 1000,
    "V1": 0,
    "AMAX": 2000,
    "VMAX": 2 * ONE_TURN_A_SECOND,
    "DMAX": 2000,
    "D1": 1000,
    "VSTOP": 10,
}
CHOPPER_ON = 0x0041_0153
"""Driver on, 256 microsteps, no interpolation."""
RATED = 11
"""Current scale of 1.575 A peak with the module's full scale, close to the motor's rating."""


def velocity(units: float) -> float:
    """Register units to microsteps/s."""
    return units * F_CLK / 2**24


def acceleration(units: float) -> float:
    """Register units to microsteps/s^2."""
    return units * F_CLK**2 / 2**41


def write(drive: Drive, registers: Mapping[str, int]) -> None:
    for name, value in registers.items():
        drive.write(name, value)


def energised(current: int = RATED, **options: Any) -> Drive:
    """A drive with its motor switched on and settled, at a trapezoid of two turns a second."""
    drive = Drive(DriveOptions(**options))
    write(drive, TRAPEZOID | {"CHOPCONF": CHOPPER_ON, "IHOLD_IRUN": current | current << 8 | 1 << 16})
    wait(drive, 0.2)
    return drive


def wait(drive: Drive, seconds: float) -> None:
    """Let time pass, whatever happens."""
    until = drive.clocks + round(seconds * F_CLK)
    while drive.advance(until) is not None:
        pass


def until(drive: Drive, kinds: EventKind, seconds: float = 60.0) -> Event:
    """To the first of these events; AssertionError if none comes."""
    before, drive.watch = drive.watch, kinds
    event = drive.advance(drive.clocks + round(seconds * F_CLK))
    drive.watch = before
    assert event is not None, f"no {kinds} within {seconds} s"
    return event


def bit(word: int, at: int) -> bool:
    return bool(word >> at & 1)


def load_value(drive: Drive) -> int:
    return drive.read("DRV_STATUS") & 0x3FF


def slope(low: float, high: float, v1: float, first: float, second: float) -> tuple[float, float]:
    """Time [s] and way from speed `low` to `high`: `first` acts below `v1`, `second` above it."""
    time = way = 0.0
    knee = max(low, min(v1, high))
    for a, b, rate in ((low, knee, first), (knee, high, second)):
        if b > a:
            time += (b - a) / rate
            way += (b * b - a * a) / (2 * rate)
    return time, way


def duration(registers: Mapping[str, int], distance: int) -> float:
    """Seconds that the continuous SixPoint ramp (trapezoid with V1 = 0) takes from rest to rest."""
    vstart, v1, vmax, vstop = (velocity(registers[n]) for n in ("VSTART", "V1", "VMAX", "VSTOP"))
    a1, amax, dmax, d1 = (acceleration(registers[n]) for n in ("A1", "AMAX", "DMAX", "D1"))

    def both(peak: float) -> tuple[float, float]:
        up = slope(min(vstart, peak), peak, v1, a1, amax)
        down = slope(min(vstop, peak), peak, v1, d1, dmax)
        return up[0] + down[0], up[1] + down[1]

    time, way = both(vmax)
    if way <= distance:
        return time + (distance - way) / vmax
    low, high = min(vstart, vstop, vmax), vmax
    while high - low > 1e-12 * vmax and (middle := (low + high) / 2) not in (low, high):
        low, high = (middle, high) if both(middle)[1] <= distance else (low, middle)
    time, way = both(low)
    return time + max(distance - way, 0.0) / low


def static_angle_deg(drive: Drive, torque_nm: float, current_a: float) -> float:
    """Load angle [deg electrical] at which a sine-driven motor without detent holds `torque_nm`."""
    return math.degrees(math.asin(torque_nm / (drive.options.motor.torque_constant * current_a)))
