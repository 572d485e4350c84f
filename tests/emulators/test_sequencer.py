"""Microsteps and currents: DS-TMC428 sections 8.9, 8.14, 12, 12.1, 13."""

from __future__ import annotations

import pytest

from app.emulators.tmc428.sequencer import coils, increment, table_index
from tests.emulators.harness import (
    A_MAX,
    CONTINUOUS,
    COVER_DATAGRAM,
    CURRENT,
    DIVIDERS,
    MODE,
    NO_STOPS,
    SINE,
    TABLE_12_2,
    V_ACTUAL,
    V_TARGET,
    VELOCITY,
    X_TARGET,
    Bench,
    free_bench,
)

# Table 12-4 as printed, where the print is complete: sine and cosine indices by quadrant.
TABLE_12_4 = {
    0: (64, [[0], [63], [0], [63]], [[63], [0], [63], [0]]),
    1: (32, [[0, 32], [63, 32]] * 2, [[63, 32], [0, 32]] * 2),
    2: (16, [[0, 16, 32, 48], [63, 48, 32, 16]] * 2, [[63, 48, 32, 16], [0, 16, 32, 48]] * 2),
    3: (
        8,
        [[0, 8, 16, 24, 32, 40, 48, 56], [63, 56, 48, 40, 32, 24, 16, 8]] * 2,
        [[63, 56, 48, 40, 32, 24, 16, 8], [0, 8, 16, 24, 32, 40, 48, 56]] * 2,
    ),
    4: (4, [[*range(0, 64, 4)], [63, *range(60, 0, -4)]] * 2, [[63, *range(60, 0, -4)], [*range(0, 64, 4)]] * 2),
    5: (2, [[*range(0, 64, 2)], [63, *range(62, 0, -2)]] * 2, [[63, *range(62, 0, -2)], [*range(0, 64, 2)]] * 2),
    6: (1, [[*range(64)], [63, *range(63, 0, -1)]] * 2, [[63, *range(63, 0, -1)], [*range(64)]] * 2),
}


@pytest.mark.sheet("DS-TMC428", "12.1")
@pytest.mark.parametrize("usrs", TABLE_12_4)
def test_table_12_4(usrs: int) -> None:
    width, sine, cosine = TABLE_12_4[usrs]
    assert increment(usrs) == width
    waves = range(0, 256, width)
    assert [table_index(wave) for wave in waves] == [index for quadrant in sine for index in quadrant]
    assert [table_index(wave + 64 & 255) for wave in waves] == [index for quadrant in cosine for index in quadrant]


@pytest.mark.sheet("DS-TMC428", "12.1")
@pytest.mark.parametrize(
    ("quadrant", "ph_a", "ph_b", "fd_a", "fd_b"), [(0, 1, 1, 0, 1), (1, 1, 0, 1, 0), (2, 0, 0, 0, 1), (3, 0, 1, 1, 0)]
)
def test_table_12_3(quadrant: int, ph_a: int, ph_b: int, fd_a: int, fd_b: int) -> None:
    for wave in range(64 * quadrant, 64 * quadrant + 64):
        got = coils(wave, 1, 0, SINE)
        assert (got.ph_a, got.ph_b, got.fd_a, got.fd_b) == (ph_a, ph_b, fd_a, fd_b)


@pytest.mark.sheet("DS-TMC428", "12")
@pytest.mark.sheet("DS-TMC428", "10")
def test_table_12_2_writes_the_quarter_sine() -> None:
    bench = free_bench()
    bench.hex(TABLE_12_2)
    values = []
    for address in range(0x60, 0x80):
        word = bench.read(address)
        values += [word & 0xFF, word >> 8]
    assert values == SINE


@pytest.mark.sheet("DS-TMC428", "12.1")
@pytest.mark.sheet("DS-TMC428", "8.14")
@pytest.mark.parametrize("usrs", range(8))
@pytest.mark.parametrize("direction", [1, -1])
def test_the_driver_sees_the_expanded_wave_step_by_step(usrs: int, direction: int) -> None:
    """Positive motion counts the wave up, negative down; %111 is like %110 here."""
    bench = free_bench()
    bench.three_drivers()
    bench.ramp(dividers=0x6600 | usrs)
    start = bench.place()
    width = increment(usrs)
    for step in range(1, 260 // width if width > 8 else 40):
        bench.write(X_TARGET, direction * step)
        bench.seconds(0.05)
        wave = direction * step * width & 255
        driver = bench.driver()
        table = [63] * 64 if usrs == 0 else SINE
        assert (driver.dac_a, driver.dac_b) == (table[table_index(wave)], table[table_index(wave + 64 & 255)])
        assert (driver.ph_a, driver.ph_b) == (wave < 128, not 64 <= wave < 192)
    assert bench.place() - start == direction * step * width / 64


@pytest.mark.sheet("DS-TMC428", "8.14")
@pytest.mark.sheet("DS-TMC428", "12")
def test_full_steps_need_no_table_and_turn_one_phase_each() -> None:
    bench = free_bench()
    bench.hex("80003010")
    bench.write(0x3F, 0x700)
    bench.ramp(dividers=0x6600)
    seen = []
    for step in range(1, 6):
        bench.write(X_TARGET, step)
        bench.seconds(0.05)
        driver = bench.driver()
        assert (driver.dac_a, driver.dac_b) == (63, 63)
        seen.append((driver.ph_a, driver.ph_b))
    assert seen == [(1, 0), (0, 0), (0, 1), (1, 1), (1, 0)]


@pytest.mark.sheet("DS-TMC428", "12.1")
def test_changing_usrs_midway_leaves_an_offset() -> None:
    bench = free_bench()
    bench.three_drivers()
    start = bench.place()
    bench.ramp(dividers=0x6606)
    bench.write(X_TARGET, 3)  # three 64th steps
    bench.seconds(0.05)
    bench.write(DIVIDERS, 0x6602)
    bench.write(X_TARGET, 7)  # four quarter steps more
    bench.seconds(0.05)
    assert bench.driver().dac_a == SINE[table_index(3 + 4 * 16)]
    assert bench.place() == start + (3 + 64) / 64


def resting(scale_v0: int, scale_le: int, scale_gt: int, threshold: int, ramp_div: int = 6) -> Bench:
    bench = free_bench()
    bench.three_drivers(0x702 | CONTINUOUS)
    bench.ramp(mode=VELOCITY, dividers=6 << 12 | ramp_div << 8 | 6, a_max=40)
    bench.write(CURRENT, scale_gt << 20 | scale_le << 16 | scale_v0 << 12 | threshold)
    return bench


def dac_b(bench: Bench) -> int:
    """The cosine's DAC with the present scale; a datagram is forced, wave near the start."""
    bench.write(COVER_DATAGRAM, 0)
    bench.clocks(700)
    return bench.driver().dac_b


@pytest.mark.sheet("DS-TMC428", "8.9")
@pytest.mark.parametrize("code", range(8))
def test_table_8_1(code: int) -> None:
    bench = resting(code, 0, 0, 0)
    assert dac_b(bench) == 63 * (code or 8) // 8


@pytest.mark.sheet("DS-TMC428", "8.9")
@pytest.mark.parametrize(
    ("threshold", "a_max", "expected"),
    [
        (10, 40, "gt"),
        (40, 40, "le"),
        (39, 40, "gt"),
        (0, 40, "gt"),
        (1023, 2047, "gt"),
        (1024, 2047, "le"),
        (2047, 1, "le"),
    ],
)
def test_table_8_2(threshold: int, a_max: int, expected: str) -> None:
    bench = resting(2, 4, 6, threshold, ramp_div=9)
    bench.write(A_MAX, a_max)
    bench.write(V_TARGET, 2047)
    bench.ticks(600)
    assert dac_b(bench) in range(*{"gt": (45, 48), "le": (29, 32)}[expected])
    bench.write(V_TARGET, 0)
    bench.ticks(1200)
    while bench.v:  # back at rest, then is_v0 after its delay
        bench.seconds(0.5)
    bench.seconds(1.0)
    value = dac_b(bench)
    assert value <= 63 * 2 // 8


@pytest.mark.sheet("DS-TMC428", "8.9")
@pytest.mark.parametrize("ramp_div", [3, 6])
def test_is_v0_comes_after_255_ramp_ticks(ramp_div: int) -> None:
    bench = resting(1, 0, 0, 0, ramp_div)
    bench.write(MODE, 3 | NO_STOPS)
    bench.write(V_ACTUAL, 1)
    bench.ticks(64)
    bench.write(V_ACTUAL, 0)
    delay = 255 * 32 * 2**ramp_div
    bench.clocks(delay - 800)
    assert dac_b(bench) == 63  # a = 0 by now: is_aleat
    bench.clocks(800)
    assert dac_b(bench) == 7


@pytest.mark.sheet("DS-TMC428", "8.9")
@pytest.mark.sheet("DS-TMC428", "9.7")
@pytest.mark.parametrize("continuous", [True, False])
def test_only_continuous_update_brings_the_rest_current_to_the_drivers(continuous: bool) -> None:
    bench = resting(4, 0, 0, 0)
    if not continuous:
        bench.write(0x3F, 0x702)
    bench.write(MODE, NO_STOPS)
    bench.write(X_TARGET, 1)
    bench.seconds(1.0)
    assert bench.driver().dac_b == (31 if continuous else 63)


@pytest.mark.sheet("DS-TMC428", "8.9")
@pytest.mark.parametrize("eighths", range(1, 8))
def test_scaling_reduces_the_number_of_effective_microsteps(eighths: int) -> None:
    levels = {coils(wave, 1, eighths, list(range(64))).dac_a for wave in range(64)}
    assert levels == set(range(8 * eighths))


@pytest.mark.sheet("DS-TMC428", "13")
def test_a_motor_is_started_as_chapter_13_says() -> None:
    bench = Bench()
    bench.hex(TABLE_12_2)
    bench.three_drivers()
    for register, value in ((0x2, 1), (0x3, 2000), (0xC, 0x5504), (0x6, 500), (0x9, 0x6D05), (0xA, 0x300), (0x0, 1600)):
        bench.write(register, value)
    bench.seconds(2.0)
    assert bench.x == 1600
    assert bench.place() == 3750 + 100


@pytest.mark.sheet("DS-TMC428", "12.2")
@pytest.mark.parametrize("usrs", [1, 2, 4])
def test_a_partial_table_is_enough_for_one_constant_resolution(usrs: int) -> None:
    """Every width-th entry and the last; all others stay power-on noise, and nobody reads them."""
    width = increment(usrs)
    needed = {*range(0, 64, width), 63}
    for seed in range(3):
        bench = free_bench(seed=seed)
        bench.write(0x3F, 0x700)
        bench.write(0x40, 0x30)
        for word in range(32):
            if {2 * word, 2 * word + 1} & needed:
                noise = bench.read(0x60 | word)
                even = SINE[2 * word] if 2 * word in needed else noise & 0x3F
                odd = SINE[2 * word + 1] if 2 * word + 1 in needed else noise >> 8
                bench.write(0x60 | word, odd << 8 | even)
        bench.ramp(dividers=0x6600 | usrs)
        for step in range(1, 256 // width):
            bench.write(X_TARGET, step)
            bench.seconds(0.02)
            wave = step * width
            driver = bench.driver()
            assert driver.dac_a == SINE[table_index(wave)]
            assert driver.dac_b == SINE[table_index(wave + 64 & 255)]
