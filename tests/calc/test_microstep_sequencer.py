"""Stepping through the table: DS-TMC428 12.1, Tables 12-3 and 12-4."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.microsteps.sequencer import SequencerStep, increment, step_through, table_index

RAMP = tuple(range(64))
"""A table whose values are their own indices."""

tables = st.lists(st.integers(0, 63), min_size=64, max_size=64)
resolutions = st.integers(0, 6)

# Table 12-4 as head and tail of each printed row: rising in the odd quadrants of the sine, falling in
# the even ones. The row usrs = %101 is printed "63, 60, 58": a lost 62, since each quadrant has 32 steps.
TABLE_12_4 = {
    6: (1, [0, 1, 2, 3], [61, 62, 63], [63, 63, 62, 61], [3, 2, 1]),
    5: (2, [0, 2, 4, 6], [58, 60, 62], [63, 62, 60, 58, 56], [4, 2]),
    4: (4, [0, 4, 8, 12], [56, 60], [63, 60, 56], [12, 8, 4]),
    3: (8, [0, 8, 16, 24], [48, 56], [63, 56, 48, 40], [16, 8]),
    2: (16, [0, 16, 32, 48], [48], [63, 48, 32, 16], [16]),
    1: (32, [0, 32], [32], [63, 32], [32]),
    0: (64, [0], [0], [63], [63]),
}


@pytest.mark.sheet("DS-TMC428", "12.1")
@pytest.mark.parametrize("usrs", TABLE_12_4)
def test_indices_of_table_12_4(usrs: int) -> None:
    width, rising, rising_tail, falling, falling_tail = TABLE_12_4[usrs]
    assert increment(usrs) == width
    steps = step_through(RAMP, usrs)
    quarter = 1 << usrs
    assert len(steps) == 4 * quarter
    for quadrant in range(4):
        part = steps[quadrant * quarter : (quadrant + 1) * quarter]
        assert {step.quadrant for step in part} == {quadrant + 1}
        sine, cosine = [step.index_a for step in part], [step.index_b for step in part]
        up, down = (sine, cosine) if quadrant % 2 == 0 else (cosine, sine)
        assert up[: len(rising)] == rising
        assert up[-len(rising_tail) :] == rising_tail
        assert down[: len(falling)] == falling
        assert down[-len(falling_tail) :] == falling_tail


@pytest.mark.sheet("DS-TMC428", "12.1")
@pytest.mark.parametrize("usrs", range(7))
def test_inside_a_quadrant_indices_move_by_the_increment(usrs: int) -> None:
    for step in step_through(RAMP, usrs):
        within = step.wave_index % 64
        rising, falling = within, min(64 - within, 63)
        assert (step.index_a, step.index_b) == ((rising, falling) if step.quadrant % 2 else (falling, rising))


@pytest.mark.sheet("DS-TMC428", "12.1")
@pytest.mark.parametrize(
    ("quadrant", "bits"), [(1, (1, 1, 0, 1)), (2, (1, 0, 1, 0)), (3, (0, 0, 0, 1)), (4, (0, 1, 1, 0))]
)
def test_phase_and_fast_decay_bits_of_table_12_3(quadrant: int, bits: tuple[int, int, int, int]) -> None:
    for usrs in range(7):
        part = [step for step in step_through(RAMP, usrs) if step.quadrant == quadrant]
        assert [step.wave_index >> 6 for step in part] == [quadrant - 1] * (1 << usrs)
        assert {(step.ph_a, step.ph_b, step.fd_a, step.fd_b) for step in part} == {bits}


@pytest.mark.sheet("DS-TMC428", "8.14")
def test_each_full_step_turns_one_phase_bit() -> None:
    steps = step_through(RAMP, 0)
    for before, after in zip(steps, steps[1:] + steps[:1], strict=True):
        assert (before.ph_a != after.ph_a) + (before.ph_b != after.ph_b) == 1


@pytest.mark.sheet("DS-TMC428", "12.1")
@given(values=tables, usrs=resolutions)
def test_currents_are_table_values_with_the_sign_of_the_phase_bit(values: list[int], usrs: int) -> None:
    for step in step_through(values, usrs):
        assert step.current_a == (1 if step.ph_a else -1) * values[step.index_a]
        assert step.current_b == (1 if step.ph_b else -1) * values[step.index_b]


@pytest.mark.sheet("DS-TMC428", "12.1")
@given(values=tables, usrs=resolutions)
def test_phase_a_follows_phase_b_by_a_quarter_and_turns_after_a_half(values: list[int], usrs: int) -> None:
    steps = step_through(values, usrs)
    quarter = 1 << usrs
    sine, cosine = [step.current_a for step in steps], [step.current_b for step in steps]
    assert sine == cosine[-quarter:] + cosine[:-quarter]
    assert sine[2 * quarter :] == [-current for current in sine[: 2 * quarter]]


@pytest.mark.sheet("DS-TMC428", "12.1")
@given(values=tables.map(sorted), usrs=resolutions)
def test_fast_decay_is_on_while_a_current_falls(values: list[int], usrs: int) -> None:
    steps = step_through(values, usrs)
    for before, after in pairwise(steps):
        if before.quadrant == after.quadrant:
            for name in ("a", "b"):
                growth = abs(_current(after, name)) - abs(_current(before, name))
                assert growth <= 0 if getattr(after, f"fd_{name}") else growth >= 0


def _current(step: SequencerStep, phase: str) -> int:
    return step.current_a if phase == "a" else step.current_b


@pytest.mark.sheet("DS-TMC428", "12.1")
@given(usrs=resolutions, start=st.integers(0, 255))
def test_a_resolution_changed_under_way_keeps_its_offset(usrs: int, start: int) -> None:
    steps = step_through(RAMP, usrs, start)
    assert steps[0].wave_index == start
    assert {step.wave_index % increment(usrs) for step in steps} == {start % increment(usrs)}
    full = {step.wave_index: step for step in step_through(RAMP, 6)}
    assert all(
        (step.index_a, step.index_b, step.ph_a, step.ph_b)
        == (
            full[step.wave_index].index_a,
            full[step.wave_index].index_b,
            full[step.wave_index].ph_a,
            full[step.wave_index].ph_b,
        )
        for step in steps
    )


def test_the_table_index_repeats_every_half_period() -> None:
    assert [table_index(wave) for wave in (-1, 0, 63, 64, 65, 127, 128, 192, 256)] == [1, 0, 63, 63, 63, 1, 0, 63, 0]


@pytest.mark.parametrize("usrs", [-1, 7, 1.0, True])
def test_another_resolution_is_refused(usrs: int) -> None:
    with pytest.raises(ValueError, match=r"usrs is .*0\.\.6"):
        step_through(RAMP, usrs)


@pytest.mark.parametrize("start", [-1, 256])
def test_another_start_is_refused(start: int) -> None:
    with pytest.raises(ValueError, match=r"start is .*0\.\.255"):
        step_through(RAMP, 6, start)


def test_a_table_of_63_is_refused() -> None:
    with pytest.raises(ValueError, match="63"):
        step_through(RAMP[:63], 6)
