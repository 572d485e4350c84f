"""The input filter against a plain reading of its rule, and its bounds against every case there is."""

from __future__ import annotations

from collections import deque

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.signals.input_filter import EXAMPLES, bounds, filtered, groups, levels_of
from app.registers.tmc4361.table import TMC4361

SETTINGS = [(rate, length) for rate in range(8) for length in range(8)]


def walked(levels: list[int], sample_rate: int, length: int, initial: int, phase: int) -> list[int]:
    """One clock after the other, with the latest samples in hand."""
    latest = deque([initial] * (length + 1), maxlen=length + 1)
    output, level = [], initial
    for clock, pin in enumerate(levels):
        if clock % 2**sample_rate == phase:
            latest.append(pin)
            if len(set(latest)) == 1:
                level = pin
        output.append(level)
    return output


@pytest.mark.sheet("DS-TMC4361", "6.1.1")
@pytest.mark.sheet("DS-TMC4361", "6.1.2")
@given(
    st.lists(st.integers(0, 1), min_size=1, max_size=300),
    st.integers(0, 4),
    st.integers(0, 7),
    st.integers(0, 1),
    st.data(),
)
def test_clock_by_clock_it_is_what_the_rule_says(
    levels: list[int], sample_rate: int, length: int, initial: int, data: st.DataObject
) -> None:
    phase = data.draw(st.integers(0, 2**sample_rate - 1))
    got = filtered(levels, sample_rate, length, initial, phase)
    assert got.output.tolist() == walked(levels, sample_rate, length, initial, phase)
    assert got.samples.tolist() == levels[phase :: 2**sample_rate]
    assert got.sample_clocks.tolist() == list(range(phase, len(levels), 2**sample_rate))


@pytest.mark.sheet("DS-TMC4361", "6.1.1")
@pytest.mark.parametrize(("sample_rate", "length"), SETTINGS)
def test_sample_rate_is_the_clock_over_a_power_of_two(sample_rate: int, length: int) -> None:
    levels = np.arange(1024) % 2
    assert np.all(np.diff(filtered(levels, sample_rate, length).sample_clocks) == 2**sample_rate)
    assert bounds(sample_rate, length).period_clocks == 2**sample_rate


@pytest.mark.sheet("DS-TMC4361", "6.1.2")
@pytest.mark.parametrize(("sample_rate", "length"), SETTINGS)
def test_bounds_are_met_and_never_left_whatever_the_phase(sample_rate: int, length: int) -> None:
    limits = bounds(sample_rate, length)
    period = limits.period_clocks
    long = 12 * period + 3
    delays, passed = set(), {True: set[int](), False: set[int]()}
    for phase in range(period):
        step = filtered(levels_of([long], 3 * long), sample_rate, length, phase=phase).output
        delays.add(int(step.argmax()) - long)
        for width in {1, length * period, length * period + 1, (length + 1) * period - 1, (length + 1) * period}:
            if width:
                pulse = filtered(levels_of([long, long + width], 4 * long), sample_rate, length, phase=phase).output
                passed[bool(pulse.any())].add(width)
    assert (min(delays), max(delays)) == (limits.delay_min_clocks, limits.delay_max_clocks)
    assert not any(width <= limits.stopped_clocks for width in passed[True])
    assert not any(width >= limits.passed_clocks for width in passed[False])
    if length:
        assert limits.stopped_clocks in passed[False]
    assert limits.passed_clocks in passed[True]


@pytest.mark.sheet("DS-TMC4361", "6.1.2")
def test_length_0_filters_nothing() -> None:
    levels = np.random.default_rng(1).integers(0, 2, 500)
    assert np.array_equal(filtered(levels, 0, 0).output, levels)


@pytest.mark.sheet("DS-TMC4361", "6")
def test_times_of_the_slowest_and_a_fast_filter_at_16_mhz() -> None:
    slow, fast = bounds(7, 7), bounds(0, 7)
    assert slow.seconds(slow.passed_clocks) == 64e-6
    assert fast.seconds(fast.passed_clocks) == 0.5e-6


@pytest.mark.sheet("DS-TMC4361", "6.1.3")
def test_the_three_examples_show_a_stopped_glitch_and_a_passed_pulse() -> None:
    assert [(e.figure, e.sample_rate, e.length) for e in EXAMPLES] == [("6.1", 1, 1), ("6.2", 2, 0), ("6.3", 0, 7)]
    for example in EXAMPLES:
        pin = levels_of(example.edges, example.clocks)
        output = filtered(pin, example.sample_rate, example.length).output
        assert 0 < np.count_nonzero(np.diff(output)) < np.count_nonzero(np.diff(pin))
        assert example.pin in next(group.pins for group in groups(0) if group.suffix == example.group)


@pytest.mark.sheet("DS-TMC4361", "6.1")
@given(st.integers(0, 0xFFFF_FFFF))
def test_the_four_groups_are_the_fields_of_the_register(word: int) -> None:
    fields = TMC4361.get("INPUT_FILT_CONF", 0).unpack(word)
    for number, group in enumerate(groups(word)):
        assert group.sample_rate == fields[f"sr_{group.suffix}"]
        assert group.length == fields[f"filt_l_{group.suffix}"]
        assert group.step_input == fields[f"sd_filt{number}"]


@given(st.lists(st.integers(1, 20), max_size=20), st.integers(0, 1))
def test_edges_make_the_levels_between_them(gaps: list[int], first: int) -> None:
    edges = np.cumsum(gaps, dtype=int).tolist()
    levels = levels_of(edges, sum(gaps) + 5, first)
    assert levels[0] == first
    assert (np.flatnonzero(np.diff(levels.astype(int))) + 1).tolist() == edges


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: filtered([0, 1], 8, 0), "sample_rate is 0 to 7"),
        (lambda: filtered([0, 1], 0, -1), "length is 0 to 7"),
        (lambda: filtered([0, 2], 0, 0), "levels are 0 or 1"),
        (lambda: filtered([], 0, 0), "clocks"),
        (lambda: filtered([[0, 1]], 0, 0), "clocks"),
        (lambda: filtered([0, 1], 1, 0, phase=2), "phase is 0 to 1"),
        (lambda: filtered([0, 1], 1, 0, initial=2), "initial is 0 to 1"),
        (lambda: bounds(0, 0, 0.0), "clock_hz"),
        (lambda: levels_of([3, 3], 10), "rising order"),
        (lambda: levels_of([10], 10), "rising order"),
        (lambda: levels_of([], 0), "clocks is 1"),
        (lambda: groups(1 << 32), "32 bits"),
    ],
)
def test_what_cannot_be_is_refused_by_name(call: object, message: str) -> None:
    assert callable(call)
    with pytest.raises(ValueError, match=message):
        call()
