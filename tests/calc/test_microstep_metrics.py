"""Figures of merit of a table, against waves whose figures are known without computing them."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from app.calc.microsteps.metrics import TableMetrics, metrics, metrics_of_currents
from app.calc.microsteps.shapes import rhomb
from app.calc.microsteps.table import design_table

tables = st.lists(st.integers(0, 63), min_size=64, max_size=64)
resolutions = st.integers(0, 6)


def ideal_sine(usrs: int, amplitude: float = 1.0) -> TableMetrics:
    phase = 2 * np.pi * np.arange(4 << usrs) / (4 << usrs)
    return metrics_of_currents(amplitude * np.sin(phase), amplitude * np.cos(phase))


@given(usrs=resolutions, amplitude=st.floats(1e-3, 1e6))
def test_a_continuous_sine_has_no_error_and_no_ripple(usrs: int, amplitude: float) -> None:
    ideal = ideal_sine(usrs, amplitude)
    assert ideal.usrs == usrs
    assert ideal.steps == 4 << usrs
    assert ideal.vector_length_mean == pytest.approx(amplitude)
    assert ideal.vector_length_ripple == pytest.approx(0, abs=1e-12)
    assert ideal.angle_error_max_deg == pytest.approx(0, abs=1e-9)
    assert ideal.angle_error_rms_deg == pytest.approx(0, abs=1e-9)
    assert ideal.largest_step is not None
    assert ideal.smallest_step is not None
    assert ideal.largest_step.ratio == pytest.approx(1)
    assert ideal.smallest_step.ratio == pytest.approx(1)
    assert ideal.backward_steps == ideal.standing_steps == ()


def test_a_continuous_sine_at_full_resolution_is_one_harmonic() -> None:
    ideal = ideal_sine(6)
    assert ideal.harmonics is not None
    assert ideal.harmonics[0] == 1
    assert len(ideal.harmonics) == 15
    assert max(ideal.harmonics[1:]) < 1e-14
    assert ideal.thd == pytest.approx(0, abs=1e-13)


def test_full_steps_have_the_harmonics_of_a_stepped_square() -> None:
    # 0, 1, 0, -1, each held for a quarter: odd harmonics fall as 1/n, all together sqrt(pi^2/8 - 1).
    full = metrics(design_table().values, usrs=0)
    assert full.harmonics is not None
    for number, amplitude in enumerate(full.harmonics, start=1):
        assert amplitude == pytest.approx(1 / number if number % 2 else 0, abs=1e-3)
    assert full.thd == pytest.approx(math.sqrt(math.pi**2 / 8 - 1), abs=1e-3)


def test_a_wave_with_a_known_third_harmonic() -> None:
    phase = 2 * np.pi * np.arange(256) / 256
    sine, cosine = (np.sin(at) + 0.1 * np.sin(3 * at) + 0.05 * np.sin(40 * at) for at in (phase, phase + np.pi / 2))
    found = metrics_of_currents(sine, cosine)
    assert found.harmonics is not None
    expected = np.zeros(15)
    expected[[0, 2]] = 1, 0.1
    np.testing.assert_allclose(found.harmonics, expected, atol=1e-14)
    assert found.thd == pytest.approx(math.hypot(0.1, 0.05))  # harmonic 40 counts though it is not listed


@given(wave=st.lists(st.integers(-63, 63), min_size=256, max_size=256))
def test_distortion_agrees_with_the_power_of_the_wave(wave: list[int]) -> None:
    currents = np.array(wave, dtype=float)
    fundamental = 2 / 256 * abs(np.sum(currents * np.exp(-2j * np.pi * np.arange(256) / 256)))
    assume(fundamental > 0.1)
    found = metrics_of_currents(currents, np.roll(currents, -64))
    assert found.thd is not None
    power = np.var(currents)  # all but the mean
    assert power == pytest.approx((1 + found.thd**2) * fundamental**2 / 2, rel=1e-9)


@pytest.mark.sheet("DS-TMC428", "12.3")
def test_a_rhomb_has_the_ripple_and_angles_of_a_square() -> None:
    t = np.arange(64) / 64
    sine = np.concatenate([rhomb(t), 1 - rhomb(t), -rhomb(t), rhomb(t) - 1])
    found = metrics_of_currents(sine, np.roll(sine, -64))
    assert found.vector_length_max == 1
    assert found.vector_length_min == pytest.approx(1 / math.sqrt(2))
    assert found.vector_length_ripple == pytest.approx((1 - 1 / math.sqrt(2)) / found.vector_length_mean)
    expected = [math.degrees(math.atan2(i, 64 - i)) - 90 * i / 64 for i in range(64)]
    assert found.angle_error_deg[:64] == pytest.approx(expected, abs=1e-9)
    assert found.angle_error_max_deg == pytest.approx(max(map(abs, expected)))
    assert found.angle_error_microsteps == pytest.approx([error / 1.40625 for error in expected] * 4, abs=1e-9)


def test_the_data_sheets_table_by_hand() -> None:
    found = metrics(design_table().values)
    # steps 0 and 1 read (sine, cosine) = (0, 63) and (2, 63)
    assert found.angle_deg[0] == 0
    assert found.angle_deg[1] == pytest.approx(math.degrees(math.atan2(2, 63)))
    assert found.step_deg[0] == pytest.approx(found.angle_deg[1])
    assert found.angle_error_deg[1] == pytest.approx(math.degrees(math.atan2(2, 63)) - 1.40625)
    assert found.vector_length[32] == pytest.approx(math.hypot(45, 45))
    assert found.backward_steps == found.standing_steps == ()
    assert found.thd is not None
    assert found.thd < 0.01


def test_a_constant_table_stands_and_jumps() -> None:
    found = metrics([63] * 64)
    assert found.vector_length_ripple == 0
    assert found.largest_step is not None
    assert found.largest_step.step == 63
    assert found.largest_step.size_deg == pytest.approx(90)
    assert found.largest_step.ratio == pytest.approx(64)
    assert found.smallest_step is not None
    assert found.smallest_step.size_deg == pytest.approx(0)
    assert found.standing_steps == tuple(step for step in range(256) if step % 64 != 63)
    assert found.backward_steps == ()


def test_a_dent_makes_named_steps_go_backwards() -> None:
    values = list(design_table().values)
    values[30] = 0
    found = metrics(values)
    # the sine meets entry 30 at step 30, the cosine at 64 - 30 = 34: down into the first, back from the second
    assert found.backward_steps == tuple(quadrant * 64 + step for quadrant in range(4) for step in (29, 34))
    assert found.smallest_step is not None
    assert found.smallest_step.step in found.backward_steps
    assert found.smallest_step.ratio < 0


def test_a_motor_without_current_has_no_angle() -> None:
    found = metrics([0] * 64)
    assert set(found.angle_deg) == set(found.angle_error_deg) == set(found.step_deg) == {None}
    assert found.vector_length_mean == 0
    figures = ("vector_length_ripple", "angle_error_max_deg", "angle_error_rms_deg", "harmonics", "thd")
    for figure in (*figures, "worst_angle_step", "largest_step", "smallest_step"):
        assert getattr(found, figure) is None
    assert found.backward_steps == found.standing_steps == ()


@given(values=tables, usrs=resolutions)
def test_of_equal_extremes_the_first_is_named(values: list[int], usrs: int) -> None:
    found = metrics(values, usrs)
    assume(found.worst_angle_step is not None)
    assert found.worst_angle_step is not None
    assert found.largest_step is not None
    assert found.smallest_step is not None
    # each quarter repeats the one before, so every extreme is met in the first
    for step in (found.worst_angle_step, found.largest_step.step, found.smallest_step.step):
        assert step < 1 << usrs


@given(values=tables, usrs=resolutions)
def test_steps_of_a_period_add_up_to_a_turn(values: list[int], usrs: int) -> None:
    assume(values[63] > 0)  # or a step could be half a turn, either way round
    found = metrics(values, usrs)
    if found.largest_step is None or found.smallest_step is None:
        assert None in found.angle_deg
        return
    sizes = [size for size in found.step_deg if size is not None]
    assert sum(sizes) == pytest.approx(360)
    assert found.largest_step.size_deg == pytest.approx(max(sizes))
    assert found.smallest_step.size_deg == pytest.approx(min(sizes))
    assert found.smallest_step.ratio <= 1 + 1e-9
    assert found.largest_step.ratio >= 1 - 1e-9
    assert set(found.backward_steps).isdisjoint(found.standing_steps)
    assert found.angle_error_max_deg is not None
    assert found.angle_error_rms_deg is not None
    assert found.angle_error_rms_deg <= found.angle_error_max_deg + 1e-9


@given(values=tables.map(sorted), usrs=resolutions)
def test_a_monotone_table_never_steps_back(values: list[int], usrs: int) -> None:
    assume(values[63] > 0)
    assert metrics(values, usrs).backward_steps == ()


@given(values=tables, usrs=resolutions, dac_bits=st.integers(1, 6))
def test_dac_bits_that_do_not_reach_the_driver_are_as_if_not_there(values: list[int], usrs: int, dac_bits: int) -> None:
    lost = 6 - dac_bits
    assert metrics(values, usrs, dac_bits) == metrics([value >> lost << lost for value in values], usrs)


@given(values=tables, usrs=resolutions, factor=st.sampled_from([0.25, 2.0, 64.0]))
def test_figures_without_unit_do_not_depend_on_the_scale(values: list[int], usrs: int, factor: float) -> None:
    table = np.array(values)
    reference = metrics(values, usrs)
    width = 64 >> usrs
    wave = np.concatenate([table, [table[63]], table[:0:-1]])
    full = np.concatenate([wave, -wave])
    scaled = metrics_of_currents(factor * full[::width], factor * np.roll(full, -64)[::width])
    assert scaled.angle_error_deg == reference.angle_error_deg
    assert scaled.vector_length_ripple == pytest.approx(reference.vector_length_ripple)
    assert scaled.thd == pytest.approx(reference.thd)
    assert scaled.vector_length_mean == pytest.approx(factor * reference.vector_length_mean)


def test_more_resolution_distorts_less() -> None:
    distortion = [metrics(design_table().values, usrs).thd for usrs in range(7)]
    assert all(coarse is not None and fine is not None and fine < coarse for coarse, fine in pairwise(distortion))


@pytest.mark.parametrize("size", [0, 3, 5, 12, 512])
def test_currents_that_are_no_period_are_refused(size: int) -> None:
    with pytest.raises(ValueError, match="256 steps"):
        metrics_of_currents(np.ones(size), np.ones(size))


def test_phases_of_different_length_are_refused() -> None:
    with pytest.raises(ValueError, match="both phases"):
        metrics_of_currents(np.ones(8), np.ones(4))


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_currents_have_to_be_finite(bad: float) -> None:
    with pytest.raises(ValueError, match="finite"):
        metrics_of_currents([0, bad, 0, -1], [1, 0, -1, 0])


@pytest.mark.parametrize(
    ("usrs", "dac_bits", "name"), [(7, 6, "usrs"), (-1, 6, "usrs"), (6, 0, "dac_bits"), (6, 7, "dac_bits")]
)
def test_settings_out_of_range_are_refused(usrs: int, dac_bits: int, name: str) -> None:
    with pytest.raises(ValueError, match=name):
        metrics([0] * 64, usrs, dac_bits)
