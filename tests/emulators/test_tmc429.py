"""The emulated TMC429: the TMC428's chain after power-on, and step/direction for three motors where it is told to."""

from __future__ import annotations

import pytest

from app.emulators.tmc428.state import StepDirState
from tests.emulators.harness import (
    DIVIDERS,
    GLOBAL,
    INTERRUPT,
    SINE,
    SWITCHES,
    X_ACTUAL,
    X_TARGET,
    Bench,
    free_bench,
)

INTERFACE, POS_COMP, POS_COMP_INT, TYPE, USTEP_COUNT = 0x34, 0x35, 0x36, 0x39, 0x0F
INV_REF, STEP_HALF, INV_DIR, EN_SD, EN_REFR = 1, 1 << 2, 1 << 4, 1 << 5, 1 << 8
AXES = pytest.mark.parametrize("axis", [0, 1, 2])


def stepping(interface: int = EN_SD, **options: object) -> Bench:
    bench = free_bench("tmc429", **options)
    bench.write(INTERFACE, interface)
    for axis in range(3):
        bench.ramp(axis, dividers=0x5500)
    return bench


def pulses(bench: Bench) -> list[StepDirState]:
    return bench.device.state().step_dirs


def test_it_says_what_it_is() -> None:
    bench = Bench("tmc429")
    assert bench.read(TYPE) == 0x429101
    assert bench.device.state().model == "tmc429"
    assert not pulses(bench)[2].enabled


def test_ram_holds_a_chain_and_a_sine_after_power_on() -> None:
    """DS-TMC429 1.5.5; a TMC428's is noise."""
    bench = Bench("tmc429")
    words = [bench.read(0x60 + word) for word in range(32)]
    assert [value for word in words for value in (word & 0x3F, word >> 8)] == SINE
    bench.write(GLOBAL, 0x0700 | 2)
    chain = bench.chain()
    assert not chain.endless
    bench.ramp(0, dividers=0x5500)
    bench.write(X_TARGET, 1)
    bench.seconds(0.1)
    assert bench.chain().datagrams_sent > 0
    assert len(bench.chain().last_bits) == 36


@AXES
def test_steps_leave_for_the_driver_of_their_motor_alone(axis: int) -> None:
    bench = stepping()
    before = [bench.place(one) for one in range(3)]
    bench.write(axis << 4 | X_TARGET, 320)
    bench.seconds(0.5)
    assert [one.steps_sent for one in pulses(bench)] == [320 * (one == axis) for one in range(3)]
    assert [bench.place(one) - was for one, was in enumerate(before)] == [20.0 * (one == axis) for one in range(3)]
    assert bench.chain().datagrams_sent == 0, "nSCS_S is a step output now (DS-TMC429 p. 43)"


@pytest.mark.parametrize("microsteps", [1, 3, 16, 256])
def test_the_external_drivers_decide_what_a_step_is(microsteps: int) -> None:
    bench = stepping(driver_microsteps=microsteps)
    start = bench.place(2)
    bench.write(0x20 | X_TARGET, -768)
    bench.seconds(1.0)
    assert bench.place(2) - start == pytest.approx(-768 / microsteps)


def test_motors_do_not_merge_their_pulses() -> None:
    """Each output has its own pulse: two motors in step lose nothing, however long the pulses are."""
    bench = stepping()
    bench.write(GLOBAL, 0x0F00)
    for axis in range(3):
        bench.write(axis << 4 | X_TARGET, 500)
    bench.seconds(1.0)
    assert [(one.steps_sent, one.steps_merged) for one in pulses(bench)] == [(500, 0)] * 3


def test_direction_can_be_inverted_and_back_to_the_chain_it_goes() -> None:
    bench = stepping(EN_SD | INV_DIR)
    start = bench.place()
    bench.write(X_TARGET, 160)
    bench.seconds(0.5)
    assert bench.place() - start == -10
    assert pulses(bench)[0].dir_level == 1
    bench.write(INTERFACE, 0)
    bench.write(DIVIDERS, 0x5504)
    bench.write(X_TARGET, 320)
    bench.seconds(0.5)
    assert bench.place() - start == 0, "160 microsteps of 16 a full step, the other way"
    assert pulses(bench)[0].steps_sent == 160


@AXES
def test_position_compare_is_of_the_motor_that_is_chosen(axis: int) -> None:
    bench = stepping(EN_SD | axis << 6)
    bench.write(POS_COMP, 100)
    bench.write(POS_COMP_INT, 0x100)
    for other in range(3):
        if other != axis:
            bench.write(other << 4 | X_TARGET, 200)
    bench.seconds(0.5)
    assert bench.read(POS_COMP_INT) == 0x100
    bench.write(axis << 4 | X_TARGET, 200)
    bench.seconds(0.5)
    assert bench.read(POS_COMP_INT) == 0x101
    bench.write(POS_COMP_INT, 0x101)
    assert bench.read(POS_COMP_INT) == 0x100


def test_right_switches_have_pins_of_their_own() -> None:
    bench = stepping(EN_SD)
    bench.switch(1, right=True)
    bench.seconds(0.01)
    assert bench.read(SWITCHES) == 0, "without en_refr the pins are ignored"
    bench.write(INTERFACE, EN_SD | EN_REFR)
    assert bench.read(SWITCHES) == 0b000100
    bench.write(INTERFACE, EN_SD | EN_REFR | INV_REF)
    assert bench.read(SWITCHES) == 0b111011


def test_the_sequencer_can_be_read_and_set() -> None:
    bench = free_bench("tmc429")
    bench.ramp(1, dividers=0x5506)
    bench.write(0x10 | X_TARGET, 70)
    bench.seconds(0.5)
    assert bench.read(0x10 | USTEP_COUNT) == 70
    bench.write(0x10 | USTEP_COUNT, 3)
    assert bench.read(0x10 | USTEP_COUNT) == 3
    assert bench.signed(0x10 | X_ACTUAL) == 70


def test_a_mask_keeps_flags_as_in_its_sisters() -> None:
    bench = stepping()
    bench.write(0x20 | INTERRUPT, 0x0100)
    bench.write(0x20 | X_TARGET, 50)
    bench.seconds(0.5)
    assert bench.read(0x20 | INTERRUPT) == 0x0101
