"""How far ahead of real time emulated TMC5xxx can run, all axes of each moving, and what a rigid motor costs.

Every chip at 16 MHz: each motor turns from end to end of its stage under load, with encoder and N line, StallGuard2 and
CoolStep at work; it never rests, and somebody reads all positions over SPI every 10 ms. The last figure is a year of a
TMC5160 with a rigid motor at 1,000,000 microsteps a second, asked every hour; its position has to be exact.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

from app.clock import VirtualClock
from app.emulators.tmc5xxx import MODELS, EmulatedTmc5xxx, Tmc5xxxModel, Tmc5xxxOptions
from app.emulators.tmc5xxx.family import FAMILY
from app.links.datagram40 import Reply, read, read_chain
from app.registers.tmc5xxx.table import AXES, TABLES
from tests.bench.table import Row

REQUIRED = 100.0
LOOK_S = 0.01
YEAR_S = 365 * 86_400
SETTINGS = {
    "CHOPCONF": 0x153,
    "IHOLD_IRUN": 20 | 24 << 8 | 1 << 16,
    "A1": 1000,
    "V1": 30_000,
    "AMAX": 2000,
    "VMAX": 200_000,
    "DMAX": 2000,
    "D1": 1500,
    "VSTOP": 10,
    "COOLCONF": 2 | 1 << 8,
    "VCOOLTHRS": 20_000,
    "VHIGH": 1 << 22,
    "TCOOLTHRS": 5000,
    "ENC_CONST": 51_200 * 65_536 // 40_000,
    "ENCMODE": 0x14,
    "ENC_DEVIATION": 2000,
}
HERE, THERE = -300_000, 300_000


def address(model: Tmc5xxxModel, name: str, axis: int) -> int | None:
    """Where the chip has that register, or None."""
    found = TABLES[model].find(name, axis)
    return found[0].address if found else None


def started(model: Tmc5xxxModel, options: Tmc5xxxOptions) -> EmulatedTmc5xxx:
    """A chip with all its registers set."""
    chip = FAMILY.make(model, VirtualClock(), options)
    if AXES[model] == 2:
        chip.write(0x00, 1 << 5, 0.0)  # encoder 2 has its pins
    for axis in range(AXES[model]):
        for name, value in SETTINGS.items():
            place = address(model, name, axis)
            if place is not None:
                chip.write(place, value, 0.0)
    return chip


def fast_forward(model: Tmc5xxxModel, seconds: int) -> tuple[float, int, int]:
    """(chip seconds per second, microsteps travelled by all motors, full steps lost)."""
    full_scale_a = 2.1  # whatever the chip, its motor gets its rated current
    chip = started(model, Tmc5xxxOptions.model_validate({"full_scale_a": full_scale_a, "load": {"torque_nm": 0.05}}))
    axes = range(AXES[model])
    positions = [TABLES[model].get("XACTUAL", axis).address for axis in axes]
    encoders = [place for axis in axes if (place := address(model, "X_ENC", axis)) is not None]
    targets = [TABLES[model].get("XTARGET", axis).address for axis in axes]
    goals = [THERE, HERE][: len(axes)]
    for place, goal in zip(targets, goals, strict=True):
        chip.write(place, goal & 0xFFFFFFFF, 0.0)
    frames = read_chain([*positions, *encoders])
    travelled, last = 0, [0] * len(axes)
    start = time.perf_counter()
    for look in range(1, 100 * seconds + 1):
        replies = [chip.exchange(frame, look * LOOK_S) for frame in frames]
        for axis in axes:
            word = Reply.decode(replies[axis + 1]).data
            position = word - (1 << 32) if word >> 31 else word
            travelled += abs(position - last[axis])
            last[axis] = position
            if position == goals[axis]:
                goals[axis] = -position
                chip.write(targets[axis], goals[axis] & 0xFFFFFFFF, look * LOOK_S)
    elapsed_s = time.perf_counter() - start
    return seconds / elapsed_s, travelled, max(abs(axis.truth.lost_fullsteps) for axis in chip.state().axes)


def a_year() -> tuple[float, int]:
    """(seconds that it took, microsteps that the position is off)."""
    chip = FAMILY.make("tmc5160", VirtualClock(), Tmc5xxxOptions(motor="rigid"))
    pps = 1_000_000  # VMAX 2^20 at 16 MHz: exact
    for place, word in ((0x26, 2000), (0x27, 1 << 20), (0x20, 1)):
        chip.write(place, word, 0.0)
    settled_s = 60
    begin = chip.read(0x21, settled_s)
    start = time.perf_counter()
    for hour in range(1, YEAR_S // 3600 + 1):
        chip.exchange(read(0x21), settled_s + hour * 3600)
    elapsed_s = time.perf_counter() - start
    return elapsed_s, abs(chip.read(0x21, settled_s + YEAR_S) - (begin + pps * YEAR_S) % (1 << 32))


def measure(quick: bool) -> Sequence[Row]:
    rows = []
    for model in MODELS:
        fast_forward(model, 1)
        speed, travelled, lost = max(fast_forward(model, 5 if quick else 20) for _ in range(3))
        motors = "two motors" if AXES[model] == 2 else "motor"
        rows.append(
            Row(
                what=f"emulated {model.upper()}: {motors}, encoder, positioning",
                measured=f"{speed:,.0f} s per s",
                peer="real time",
                ratio=speed,
                required=f">= {REQUIRED:g}, no step lost",
                ok=speed >= REQUIRED and travelled > 0 and lost == 0,
                notes=(f"{travelled:,} microsteps travelled, {lost} full steps lost",),
            )
        )
    elapsed_s, off = a_year()
    return [
        *rows,
        Row(
            what="emulated TMC5160: a year with a rigid motor",
            measured=f"{elapsed_s:.2f} s",
            peer="a year",
            ratio=YEAR_S / elapsed_s,
            required="exact, in under 60 s",
            ok=elapsed_s < 60 and off == 0,
            notes=(f"asked every hour; {off} microsteps off in the end",),
        ),
    ]
