"""An emulated TMC428 with three TMC2660 and their motors: how far ahead of real time, and who says what is wrong.

Faults are made on each axis in turn while all three turn; counted are the cycles of the chain (datagrams) until the
flags that come back with them name it, and that no other axis does. A stall counts from the first full step that a held
shaft did not follow on, which is when the driver itself knows.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

from tests.bench.table import Row
from tests.emulators.test_chain_drives import OLA, OT, SG, Rig

REQUIRED_SPEED, CYCLES_MAX = 1.0, 2
FAULTS: tuple[tuple[str, dict[str, object], int, float], ...] = (
    ("over-temperature", {"motor": {"temperature_c": 160.0}}, OT, 0.0),
    ("open load", {"motor": {"connected": False}}, OLA, 0.0),
    ("stall", {"blocked": True}, SG, 0.1),
)
FLAGS = OT | OLA | SG


def turning() -> Rig:
    rig = Rig(["tmc2660"] * 3)
    for axis in range(3):
        rig.set_up(axis, sgt=0)
        rig.move(axis, 8_000_000)
    rig.wait(1.0)
    return rig


def flags(rig: Rig) -> list[int]:
    """Of all three by one datagram that covers nothing (DS-TMC428 9.3)."""
    rig.write(0x32, 0)
    rig.write(0x33, 0)
    rig.wait(0.0005)
    stored = rig.read(0x31) << 24 | rig.read(0x30)
    return [stored >> shift & FLAGS for shift in (40, 20, 0)]


def cycles_until(axis: int, change: dict[str, object], flag: int, after_s: float) -> int:
    """Datagrams until that axis, and no other, shows the flag; beyond `CYCLES_MAX` it was not so."""
    rig = turning()
    rig.patch(axis, **change)
    rig.wait(after_s)
    for cycle in range(1, CYCLES_MAX + 1):
        if flags(rig) == [flag if one == axis else 0 for one in range(3)]:
            return cycle
    return CYCLES_MAX + 1


def measure(quick: bool) -> Sequence[Row]:
    seconds = 2.0 if quick else 10.0
    rig = turning()
    start = time.process_time()
    rig.wait(seconds)
    speed = seconds / (time.process_time() - start)
    rows = [
        Row(
            "TMC428 with three TMC2660, motors turning",
            f"{speed:.3g} chip s a CPU s",
            f"{REQUIRED_SPEED:g}",
            speed / REQUIRED_SPEED,
            ">= 1",
            speed >= REQUIRED_SPEED,
        )
    ]
    for name, change, flag, after_s in FAULTS:
        worst = max(cycles_until(axis, change, flag, after_s) for axis in range(3))
        rows.append(
            Row(
                f"{name} on one of three: the right axis says it",
                f"{worst} datagrams",
                f"{CYCLES_MAX}",
                worst / CYCLES_MAX,
                "<= 1",
                worst <= CYCLES_MAX,
            )
        )
    return rows
