"""How fast a batch of 64 emulated axes with motors runs on all cores: ramp, driver, motor, encoder and load of each.

Threads, one a core, as compiled code lets go of Python's lock. Each axis has a load of its own. In the first row no
motor ever rests; in the second each rests as long as it has moved, as in a study that waits until the shaft is still.
A machine with other work too shows what it has left; what a second of a core's time brings stands below. So does what
the same cores make of the motors' equations alone (`bare_motor.py`): where a fair share of that limit is less than what
was asked, what was asked is out of this machine's reach, and that share is required instead.
"""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

from app.emulators.drive import Drive, warm_up
from app.emulators.drive.kernel import TICK_CLOCKS
from app.emulators.drive.units import signed
from tests.bench.bare_motor import motors_alone
from tests.bench.motor import CLOCK_HZ, SETTINGS
from tests.bench.table import Row

REQUIRED = 1000.0
OF_LIMIT = 0.45
"""Of the motors alone: little more than as much again for ramp, driver, StallGuard, switches, encoders and load."""
AXES = 64
LOOK_CLOCKS = CLOCK_HZ // 20
TARGET = 300_000


def _drive(index: int) -> Drive:
    drive = Drive()
    for register, value in SETTINGS.items():
        drive.write(register, value)
    drive.plant.load_torque_nm = 0.001 * index
    return drive


def run(drive: Drive, seconds: int, rests: bool) -> tuple[int, int]:
    """(moves, full steps lost) in `seconds` of the drive's time; `rests`: half of it at rest."""
    target, since, moves = TARGET, 0, 0
    arrived: int | None = None
    drive.write("XTARGET", target)
    for look in range(1, 20 * seconds + 1):
        now = look * LOOK_CLOCKS
        drive.advance(now)
        if arrived is None and signed(drive.read("XACTUAL"), 32) == target:
            arrived, moves = now, moves + 1
        if arrived is not None and (not rests or now - arrived >= arrived - since):
            target, since, arrived = -target, now, None
            drive.write("XTARGET", target)
    return moves, abs(drive.plant_state.lost_fullsteps)


def batch(seconds: int, rests: bool) -> tuple[float, float, int, int]:
    """(axis-seconds a second of this machine, the same a second of one core's time, moves, full steps lost)."""
    drives = [_drive(index) for index in range(AXES)]
    with ThreadPoolExecutor(os.cpu_count()) as threads:
        began_s, spent_s = time.perf_counter(), time.process_time()
        found = list(threads.map(lambda drive: run(drive, seconds, rests), drives))
        took_s, spent_s = time.perf_counter() - began_s, time.process_time() - spent_s
    moves, lost = (sum(each) for each in zip(*found, strict=True))
    return AXES * seconds / took_s, AXES * seconds / spent_s, moves, lost


def _alone(seconds: int) -> float:
    """Motor-seconds a second of this machine, of the same motors and nothing else."""
    drives = [_drive(index) for index in range(AXES)]
    for drive in drives:
        drive.advance(LOOK_CLOCKS)
    rate, followed = motors_alone(drives, seconds, TICK_CLOCKS / CLOCK_HZ)
    assert followed > 0.99, "a motor that has lost its field costs less"
    return rate


def measure(quick: bool) -> Sequence[Row]:
    warm_up()
    cores = os.cpu_count() or 1
    rows = []
    for rests in (False, True):
        seconds = 8 if quick else 16
        tries = [(batch(seconds, rests), _alone(seconds)) for _ in range(3)]  # in turn: the machine's speed swings
        whole, core, moves, lost = max(found for found, _ in tries)
        alone = max(limit for _, limit in tries)
        required = min(REQUIRED, OF_LIMIT * alone)
        how = "half the time at rest" if rests else "all moving"
        rows.append(
            Row(
                what=f"batch of {AXES} TMC5160 axes with motors, {how}",
                measured=f"{whole:,.0f} axis-seconds a second",
                peer=f"{REQUIRED:,.0f}; motors alone {alone:,.0f}",
                ratio=whole / REQUIRED,
                required=f">= 1 on 2 cores, or {OF_LIMIT:g} of the motors alone",
                ok=whole >= required and moves > 0 and lost == 0,
                notes=(
                    f"{core:,.0f} a second of one of {cores} cores; {moves} moves, {lost} full steps lost",
                    f"{whole / alone:.2f} of the motors alone",
                ),
            )
        )
    return rows
