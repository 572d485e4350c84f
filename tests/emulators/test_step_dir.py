"""Step/direction output, position compare and step pointer of the TMC4210: DS-TMC4210 chapters 1, 2, 5, 6."""

from __future__ import annotations

import pytest

from tests.emulators.harness import (
    DIVIDERS,
    GLOBAL,
    HOLD,
    MODE,
    NO_STOPS,
    V_ACTUAL,
    V_TARGET,
    VELOCITY,
    X_ACTUAL,
    X_TARGET,
    Bench,
    free_bench,
)

INTERFACE, POS_COMP, POS_COMP_INT, USTEP_COUNT = 0x34, 0x35, 0x36, 0x0F
STEP_HALF, INV_STP, INV_DIR, EN_SD = 1 << 2, 1 << 3, 1 << 4, 1 << 5


def stepping(interface: int = EN_SD, **options: object) -> Bench:
    bench = free_bench("tmc4210", **options)
    bench.write(INTERFACE, interface)
    bench.ramp(dividers=0x5500)
    return bench


@pytest.mark.sheet("DS-TMC4210", "6.2.1")
@pytest.mark.sheet("DS-TMC4210", "1.4")
@pytest.mark.parametrize("enabled", [True, False])
def test_without_en_sd_no_step_leaves_the_chip(enabled: bool) -> None:
    bench = stepping(EN_SD if enabled else 0)
    start = bench.place()
    bench.write(X_TARGET, 320)
    bench.seconds(0.5)
    assert bench.x == 320  # the ramp generator runs all the same
    assert bench.step_dir().steps_sent == (320 if enabled else 0)
    assert bench.place() - start == (20 if enabled else 0)


@pytest.mark.sheet("DS-TMC4210", "1.1")
@pytest.mark.sheet("DS-TMC4210", "1.4.1")
@pytest.mark.parametrize("microsteps", [1, 3, 16, 256])
def test_the_external_driver_decides_what_a_step_is(microsteps: int) -> None:
    bench = stepping(driver_microsteps=microsteps)
    start = bench.place()
    bench.write(X_TARGET, -768)
    bench.seconds(1.0)
    assert bench.place() - start == -768 / microsteps


@pytest.mark.sheet("DS-TMC4210", "6.2.1")
@pytest.mark.sheet("DS-TMC4210", "1.2.2")
@pytest.mark.sheet("DS-TMC4210", "2.2")
@pytest.mark.parametrize("inverted", [0, 1])
def test_direction_output_and_its_inversion(inverted: int) -> None:
    bench = stepping(EN_SD | inverted * INV_DIR)
    start = bench.place()
    for target, level in ((100, 0), (0, 1), (160, 0)):
        bench.write(X_TARGET, target)
        bench.seconds(0.5)
        assert bench.step_dir().dir_level == level ^ inverted
    assert bench.place() - start == (-10 if inverted else 10)


@pytest.mark.sheet("DS-TMC4210", "6.2.2")
@pytest.mark.sheet("DS-TMC4210", "8.1")
@pytest.mark.sheet("DS-TMC4210", "5.3")
@pytest.mark.sheet("DS-TMC4210", "1.2.2")
@pytest.mark.parametrize("stpdiv", [0, 1, 7, 15])
@pytest.mark.parametrize("inverted", [0, 1])
def test_step_pulse_length(stpdiv: int, inverted: int) -> None:
    """16 * (1 + STPDIV) clocks."""
    bench = stepping(EN_SD | inverted * INV_STP)
    bench.write(GLOBAL, stpdiv << 8)
    bench.write(MODE, HOLD | NO_STOPS)
    bench.write(DIVIDERS, 0)
    bench.write(V_ACTUAL, 128)  # a step every 16 ticks, 512 clocks
    bench.clocks(16 * 32)
    high = 0
    while bench.step_dir().steps_sent < 2:
        high += bench.step_dir().step_level ^ inverted
        bench.clocks(1)
    assert high == bench.step_dir().pulse_clocks == 16 * (1 + stpdiv)


@pytest.mark.sheet("DS-TMC4210", "6.2.1")
@pytest.mark.sheet("DS-TMC4210", "5.3")
def test_step_half_makes_every_edge_a_step() -> None:
    bench = stepping(EN_SD | STEP_HALF)
    levels = []
    for target in range(1, 6):
        bench.write(X_TARGET, target)
        bench.seconds(0.1)
        levels.append(bench.step_dir().step_level)
    assert levels == [1, 0, 1, 0, 1]


@pytest.mark.sheet("DS-TMC4210", "1.4.1")
@pytest.mark.parametrize(("stpdiv", "half", "lost"), [(15, 0, True), (0, 0, False), (15, STEP_HALF, False)])
def test_full_step_rate_needs_short_pulses(stpdiv: int, half: int, lost: bool) -> None:
    """At fCLK / 32 steps a second a pulse of 256 clocks runs into the next: the driver misses it."""
    bench = stepping(EN_SD | half)
    bench.write(GLOBAL, stpdiv << 8)
    bench.write(DIVIDERS, 0)
    start = bench.place()
    bench.write(MODE, HOLD | NO_STOPS)
    bench.write(V_ACTUAL, 2047)
    bench.seconds(0.05)
    output = bench.step_dir()
    assert (output.steps_merged > 0) == lost
    assert output.steps_sent + output.steps_merged == bench.x
    assert (bench.place() - start) * 16 == output.steps_sent


@pytest.mark.sheet("DS-TMC4210", "5.3")
@pytest.mark.sheet("DS-TMC4210", "6.1")
def test_the_step_pointer_counts_and_can_be_set() -> None:
    bench = stepping()
    bench.write(X_TARGET, 300)
    bench.seconds(0.5)
    assert bench.read(USTEP_COUNT) == 300 % 256
    bench.write(USTEP_COUNT, 7)
    bench.write(X_TARGET, 290)
    bench.seconds(0.5)
    assert bench.read(USTEP_COUNT) == (7 - 10) % 256
    assert bench.x == 290


@pytest.mark.sheet("DS-TMC4210", "6.2.1.1")
@pytest.mark.sheet("DS-TMC4210", "6.2.1.2")
@pytest.mark.sheet("DS-TMC4210", "5.3")
def test_position_compare_sets_its_flag_when_the_position_is_met() -> None:
    bench = stepping()
    bench.write(POS_COMP, 150)
    bench.write(POS_COMP_INT, 0x100)
    bench.write(X_TARGET, 149)
    bench.seconds(0.5)
    assert bench.read(POS_COMP_INT) == 0x100
    assert not bench.status & 0x80
    bench.write(X_TARGET, 400)
    bench.seconds(0.5)
    assert bench.read(POS_COMP_INT) == 0x101
    assert bench.status & 0x80
    bench.write(POS_COMP_INT, 0x101)
    assert bench.read(POS_COMP_INT) == 0x100
    assert not bench.status & 0x80
    bench.write(X_TARGET, -400)
    bench.seconds(0.5)
    assert bench.read(POS_COMP_INT) == 0x101


@pytest.mark.sheet("DS-TMC4210", "6.2.1.2")
@pytest.mark.sheet("DS-TMC4210", "5.3")
def test_position_compare_needs_its_mask_and_a_motor_that_exists() -> None:
    for interface, mask in ((EN_SD, 0), (EN_SD | 3 << 6, 0x100), (EN_SD | 1 << 6, 0x100)):
        bench = stepping(interface)
        bench.write(POS_COMP, -20 & 0xFFFFFF)
        bench.write(POS_COMP_INT, mask)
        bench.write(X_TARGET, -100)
        bench.seconds(0.5)
        assert bench.read(POS_COMP_INT) == mask


@pytest.mark.sheet("DS-TMC4210", "6.1.2")
@pytest.mark.sheet("DS-TMC4210", "6.1.4")
@pytest.mark.parametrize("mode", [VELOCITY, HOLD])
def test_the_position_can_be_overwritten_at_rest_in_velocity_and_hold_mode(mode: int) -> None:
    bench = stepping()
    bench.write(MODE, mode | NO_STOPS)
    bench.write(X_ACTUAL, 4711)
    bench.seconds(0.5)
    assert (bench.x, bench.v) == (4711, 0)


@pytest.mark.sheet("DS-TMC4210", "5.3")
def test_there_is_no_driver_chain_and_writing_the_ram_does_nothing() -> None:
    bench = stepping()
    state = bench.device.state()
    for address in range(0x40, 0x80):
        bench.write(address, 0xFFFFFF)
        assert bench.read(address) == 0x3F3F
    assert state.driver_chain is None
    assert bench.device.state().step_dir == state.step_dir
    assert bench.status == 1


@pytest.mark.sheet("DS-TMC4210", "2.4")
def test_signed_and_unsigned_parameters() -> None:
    bench = stepping()
    bench.write(MODE, VELOCITY | NO_STOPS)
    bench.write(V_TARGET, -5)
    assert bench.read(V_TARGET) == 0xFFB
    bench.seconds(0.2)
    assert bench.signed(V_ACTUAL, 12) == -5
    assert bench.x < 0
    bench.write(0x02, -1)
    assert bench.read(0x02) == 0x7FF


@pytest.mark.sheet("DS-TMC4210", "6.1.12")
@pytest.mark.sheet("DS-TMC4210", "6.1.7")
@pytest.mark.sheet("DS-TMC4210", "5.3")
def test_pulse_div_changed_outside_ramp_mode_may_emit_a_step() -> None:
    bench = stepping()
    bench.write(X_TARGET, 33)
    bench.seconds(0.2)
    bench.write(MODE, VELOCITY | NO_STOPS)
    bench.write(DIVIDERS, 0x6500)
    assert bench.step_dir().steps_sent == 34
    assert bench.x == 33
