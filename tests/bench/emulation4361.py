"""How far ahead of real time an emulated TMC4361 can run, and that each of its moves ends where it was sent.

The first figure is of a chip at 16 MHz that never rests: S-ramps from end to end, motor with load and encoder, and
somebody looks every 10 ms. The second counts random moves of all positioning modes, most of them sent elsewhere, or
with another VMAX, while they were under way; each has to end with XACTUAL = XTARGET, all steps sent and the flag set.
"""

from __future__ import annotations

import random
import time
from collections.abc import Sequence

from app.clock import VirtualClock
from app.emulators.build import build_emulator
from app.emulators.tmc4361 import Tmc4361Options
from app.links.datagram40 import FETCH, Reply, read, write
from tests.bench.table import Row
from tests.emulators.tmc4361.moves import ending

REQUIRED = 50.0
LOOK_S = 0.01
XACTUAL, VACTUAL, XTARGET, ENC_POS, STATUS = 0x21, 0x22, 0x37, 0x50, 0x0F
SETTINGS = {
    0x54: 40_000,
    0x20: 6,
    0x24: 100_000 << 8,
    0x28: 400_000 << 2,
    0x29: 400_000 << 2,
    0x2D: 4_000_000,
    0x2E: 4_000_000,
    0x2F: 4_000_000,
    0x30: 4_000_000,
}


def fast_forward(seconds: int) -> tuple[float, int, int]:
    """(chip seconds per second, microsteps travelled, microsteps that the encoder is off in the end)."""
    chip = build_emulator("tmc4361", VirtualClock(), Tmc4361Options())
    now_s = 0.0

    def ask(address: int) -> int:
        chip.exchange(read(address), now_s)
        word = Reply.decode(chip.exchange(FETCH, now_s)).data
        return word - (1 << 32) if word >> 31 else word

    for address, word in SETTINGS.items():
        chip.exchange(write(address, word), now_s)
    travelled, last, target = 0, 0, 60_000
    chip.exchange(write(XTARGET, target), now_s)
    start = time.perf_counter()
    for look in range(1, 100 * seconds + 1):
        now_s = look * LOOK_S
        position = ask(XACTUAL)
        ask(ENC_POS)
        travelled += abs(position - last)
        last = position
        if position == target:
            target = -target
            chip.exchange(write(XTARGET, target & 0xFFFFFFFF), now_s)
    elapsed_s = time.perf_counter() - start
    chip.exchange(write(XTARGET, last & 0xFFFFFFFF), now_s)
    now_s += 10.0
    return seconds / elapsed_s, travelled, ask(ENC_POS) - ask(XACTUAL)


TIMES = 4 << 20 | 4 << 24 | 4 << 28
DRIVERS = {"steps": (11 | TIMES, 0xEF010), "currents": (10 | TIMES, 0xEF090)}
"""SPI_OUT_CONF for a TMC26x, and DRVCONF without and with SDOFF."""
COVERED = (0xA0000, 0xD001F, 0x00000, 0x901B4)


def with_driver(seconds: int, by: str) -> tuple[float, int, float]:
    """(chip seconds per second, microsteps travelled, full steps that the rotor is off in the end) with a TMC26x."""
    chip = build_emulator("tmc4361", VirtualClock(), Tmc4361Options(driver="tmc2660"))
    output, conf = DRIVERS[by]
    now_s = 0.0

    def put(address: int, word: int) -> None:
        chip.exchange(write(address, word & 0xFFFFFFFF), now_s)

    def position() -> int:
        chip.exchange(read(XACTUAL), now_s)
        word = Reply.decode(chip.exchange(FETCH, now_s)).data
        return word - (1 << 32) if word >> 31 else word

    put(0x04, output)
    for word in (conf, *COVERED):
        put(0x6C, word)
        now_s += 0.001
    for address, word in SETTINGS.items():
        put(address, word)
    first_fullsteps = chip.ground_truth(0, now_s).shaft_fullsteps
    travelled, last, target = 0, 0, 60_000
    put(XTARGET, target)
    start = time.process_time()
    for _ in range(100 * seconds):
        now_s += LOOK_S
        at = position()
        travelled += abs(at - last)
        last = at
        if at == target:
            target = -target
            put(XTARGET, target)
    elapsed_s = time.process_time() - start
    put(XTARGET, 0)
    now_s += 10.0
    return seconds / elapsed_s, travelled, chip.ground_truth(0, now_s).shaft_fullsteps - first_fullsteps


def standing(seconds: int) -> float:
    """Chip seconds per second of a chip whose motor holds its place."""
    chip = build_emulator("tmc4361", VirtualClock(), Tmc4361Options())
    start = time.perf_counter()
    for look in range(1, 100 * seconds + 1):
        chip.exchange(read(XACTUAL), look * LOOK_S)
    return seconds / (time.perf_counter() - start)


def measure(quick: bool) -> Sequence[Row]:
    fast_forward(1)
    speed, travelled, off = max(fast_forward(5 if quick else 20) for _ in range(3))
    rest = standing(20)
    moves = 1000 if quick else 10_000
    random_source = random.Random(4361)
    begin = time.perf_counter()
    endings = [ending(random_source) for _ in range(moves)]
    elapsed_s = time.perf_counter() - begin
    exact = sum(one.exact for one in endings)
    changes = sum(one.changes for one in endings)
    first_wrong = next((f"; the first that is not: {one}" for one in endings if not one.exact), "")
    behind = {by: max(with_driver(5 if quick else 20, by) for _ in range(2)) for by in DRIVERS}
    slowest = min(one[0] for one in behind.values())
    lost = max(abs(one[2]) for one in behind.values())
    told = [f"by {by} {one[0]:,.0f} s per s, rotor {one[2]:.2f} full steps off" for by, one in behind.items()]
    return [
        Row(
            what="emulated TMC4361 with a TMC26x behind: S-ramps, driver, motor and encoder",
            measured=f"{slowest:,.0f} s per s",
            peer="real time",
            ratio=slowest,
            required=f">= {REQUIRED:g}",
            ok=slowest >= REQUIRED and all(one[1] > 0 for one in behind.values()) and lost < 1,
            notes=("of CPU time", *told),
        ),
        Row(
            what="emulated TMC4361: S-ramps, motor and encoder",
            measured=f"{speed:,.0f} s per s",
            peer="real time",
            ratio=speed,
            required=f">= {REQUIRED:g}",
            ok=speed >= REQUIRED and travelled > 0 and abs(off) < 256,
            notes=(f"{travelled:,} microsteps travelled, encoder {off} off; standing still {rest:,.0f} s per s",),
        ),
        Row(
            what="emulated TMC4361: moves that end on XTARGET",
            measured=f"{exact:,} of {moves:,}",
            peer="all",
            ratio=exact / moves,
            required="= 1",
            ok=exact == moves,
            notes=(f"{changes:,} changes on the fly, in {elapsed_s:.0f} s{first_wrong}",),
        ),
    ]
