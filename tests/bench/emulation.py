"""How far ahead of real time three moving axes can run, and that running ahead changes no bit.

The same moves are made twice: by an emulated TMC428 that jumps, timed; and by one beside the tests' tick-by-tick
oracle, compared register by register, accumulators, hidden velocity bits and driver datagrams included.
"""

from __future__ import annotations

import time
from collections.abc import Callable

from app.calc.driver_chain.chain import build_chain
from app.clock import VirtualClock
from app.emulators.build import build_emulator
from app.emulators.tmc428.options import EmulatorOptions, StageOptions
from tests.bench.table import Row
from tests.emulators.lockstep import Pair

REQUIRED = 100.0
CLOCK_HZ = 16e6
AXES = 3
# Switches far away: the axes are to move and not to be stopped.
STAGE = StageOptions(left_at_fullsteps=-100_000.0, right_at_fullsteps=100_000.0, start_fullsteps=0.0)
LEG_S = 0.4
LOOK_S = 0.01  # how often somebody reads the positions, as the dashboard does
# pulse_div, ramp_div, v_max, a_max, pmul, pdiv: 125,000, 80,000 and 62,000 microsteps/s, accelerated in about 0.1 s
SETTINGS = ((2, 6, 2047, 420, 71, 6), (3, 6, 2600 // 2, 260, 119, 5), (2, 7, 1024, 430, 75, 7))

Write = Callable[[int, int], None]


def set_up(write: Write) -> None:
    """Three TMC236 in a chain, SPI at 1 MHz (clk2_div 7), and three axes of different dividers."""
    words = [*build_chain(["tmc236"] * AXES).ram_words, 0]
    for cell in range(0, len(words) - 1, 2):
        write(0x40 | cell // 2, words[cell] | words[cell + 1] << 8)
    write(0x3F, 0x100700 | AXES - 1)
    for axis, (pulse_div, ramp_div, v_max, a_max, pmul, pdiv) in enumerate(SETTINGS):
        base = axis << 4
        write(base | 0xC, pulse_div << 12 | ramp_div << 8 | 6)
        write(base | 0x2, 1)
        write(base | 0x3, v_max)
        write(base | 0x6, a_max)
        write(base | 0x9, (0x80 | pmul) << 8 | pdiv)


def turn(write: Write, leg: int) -> None:
    """Send every axis to its other end: on the fly, wherever it is."""
    for axis in range(AXES):
        distance = 18_000 - 4_000 * axis
        write(axis << 4, (distance if leg % 2 else -distance) & 0xFFFFFF)


def fast_forward(seconds: float) -> tuple[float, int]:
    """(chip seconds per second, microsteps made in all) over `seconds` of chip time."""
    clock = VirtualClock()
    device = build_emulator("tmc428", clock, EmulatorOptions(stages=[STAGE] * AXES))

    def write(address: int, data: int) -> None:
        device.exchange((address << 25 | data).to_bytes(4, "big"))

    set_up(write)
    clock.set(LOOK_S)
    device.exchange(bytes(4))  # compiled or loaded before the watch starts
    now_s, leg, travelled = clock.now(), 0, 0
    last = [0] * AXES
    start_s, end_s = time.perf_counter(), now_s + seconds
    while now_s < end_s:
        turn(write, leg)
        leg += 1
        for _ in range(round(LEG_S / LOOK_S)):
            now_s += LOOK_S
            clock.set(now_s)
            for axis in range(AXES):
                reply = device.exchange(((axis << 4 | 1) << 25 | 1 << 24).to_bytes(4, "big"))
                position = int.from_bytes(reply[1:], "big")
                travelled += abs((position - last[axis] + 0x800000 & 0xFFFFFF) - 0x800000)
                last[axis] = position
    return (now_s - LOOK_S) / (time.perf_counter() - start_s), travelled


def compare(seconds: float) -> int:
    """Ticks compared with the oracle. Raises AssertionError where a bit differs."""
    pair = Pair(False, "left-only", [STAGE] * AXES)
    set_up(pair.write)
    for leg in range(max(2, round(seconds / LEG_S))):
        turn(pair.write, leg)
        for part in (0.31, 0.27, 0.42):  # not at round moments
            pair.run(int(part * LEG_S * CLOCK_HZ) + leg)
            pair.check()
    return pair.clock // 32


def measure(*, quick: bool) -> Row:
    speed, travelled = max(fast_forward(20.0 if quick else 120.0) for _ in range(3))
    try:
        ticks, finding = compare(0.8 if quick else 8.0), ""
    except AssertionError as error:
        ticks, finding = 0, str(error)
    return Row(
        what=f"{AXES} TMC428 axes moving at 16 MHz, fast-forward",
        measured=f"{speed:,.0f} s per s",
        peer="real time",
        ratio=speed,
        required=f">= {REQUIRED:g}, bit-exact",
        ok=speed >= REQUIRED and not finding and travelled > 0,
        notes=(finding or f"{ticks:,} ticks equal to the tick-by-tick oracle; {travelled:,} microsteps travelled",),
    )
