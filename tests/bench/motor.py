"""How far ahead of real time a drive can run: ramp generator, driver, motor, switches and encoders of one axis.

The motor never rests: it turns from end to end of its stage with a load on it, StallGuard2, CoolStep and a deviation
limit at work, and somebody looks every 10 ms, as the dashboard does. A second figure is of a motor that stands.
"""

from __future__ import annotations

import time

from app.emulators.drive import Drive, EventKind, warm_up
from tests.bench.table import Row

REQUIRED = 50.0
CLOCK_HZ = 16_000_000
LOOK_CLOCKS = CLOCK_HZ // 100
SETTINGS = {
    "CHOPCONF": 0x0041_0153,
    "IHOLD_IRUN": 11 | 15 << 8 | 1 << 16,
    "VSTART": 0,
    "A1": 1000,
    "V1": 30_000,
    "AMAX": 2000,
    "VMAX": 200_000,
    "DMAX": 2000,
    "D1": 1000,
    "VSTOP": 10,
    "SW_MODE": 3,
    "TCOOLTHRS": 0xFFFFF,
    "COOLCONF": 2 | 1 << 8,
}


def fast_forward(seconds: int) -> tuple[float, int, int]:
    """(chip seconds per second, microsteps travelled, full steps lost) of a motor kept moving for `seconds`."""
    drive = Drive()
    for register, value in SETTINGS.items():
        drive.write(register, value)
    drive.plant.load_torque_nm = 0.05
    drive.internal.limit = 2000
    drive.watch = EventKind.POSITION_REACHED
    travelled, last, target = 0, 0, 300_000
    drive.write("XTARGET", target)
    start = time.perf_counter()
    for look in range(1, 100 * seconds + 1):
        while drive.advance(look * LOOK_CLOCKS) is not None:
            target = -target
            drive.write("XTARGET", target)
        position = drive.read("XACTUAL")
        travelled += abs(position - last)
        last = position
    return seconds / (time.perf_counter() - start), travelled, drive.plant_state.lost_fullsteps


def standing(seconds: int) -> float:
    """Chip seconds per second of a motor that holds its place."""
    drive = Drive()
    for register, value in SETTINGS.items():
        drive.write(register, value)
    start = time.perf_counter()
    for look in range(1, 100 * seconds + 1):
        drive.advance(look * LOOK_CLOCKS)
        drive.read("XACTUAL")
    return seconds / (time.perf_counter() - start)


def measure(quick: bool) -> Row:
    warm_up()
    speed, travelled, lost = max(fast_forward(10 if quick else 60) for _ in range(3))
    rest = standing(10 if quick else 60)
    return Row(
        what="motor model: one TMC5160 axis, moving under load",
        measured=f"{speed:,.0f} s per s",
        peer="real time",
        ratio=speed,
        required=f">= {REQUIRED:g}, no step lost",
        ok=speed >= REQUIRED and travelled > 0 and lost == 0,
        notes=(f"{travelled:,} microsteps travelled, {lost} full steps lost; standing still {rest:,.0f} s per s",),
    )
