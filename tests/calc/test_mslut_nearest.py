"""The nearest encodable wave: that it is encodable, that nothing is nearer, and that what fits stays as it is."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from app.calc.microsteps.mslut import POWER_ON, decode, encode, refusals
from app.calc.microsteps.mslut_nearest import NORMS, Nearest, Norm, nearest
from app.calc.microsteps.mslut_waves import Formula, wanted_wave

norms = st.sampled_from(NORMS)
mirrors = st.sampled_from([-1, 0])
DEFAULT = decode(POWER_ON)


def distances(found: Nearest, wanted: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.abs(np.asarray(found.wave.values) - wanted)


@given(seed=st.integers(0, 2**32 - 1), noise=st.sampled_from([0.3, 3.0, 40.0]), norm=norms, mirror=mirrors)
@settings(max_examples=20)
def test_it_is_encodable_and_says_how_far_it_is(seed: int, noise: float, norm: Norm, mirror: int) -> None:
    wanted = np.asarray(DEFAULT.values) + np.random.default_rng(seed).normal(0, noise, 256)
    found = nearest(wanted, mirror, norm)
    assert decode(encode(found.wave.values, mirror)) == found.wave
    assert found.distance_max == pytest.approx(distances(found, wanted).max())
    assert found.distance_rms == pytest.approx(np.sqrt((distances(found, wanted) ** 2).mean()))


@given(seed=st.integers(0, 2**32 - 1), norm=norms)
@settings(max_examples=15)
def test_no_change_of_its_bits_or_borders_is_nearer(seed: int, norm: Norm) -> None:
    # Neighbours in the space of registers, made without the search: one difference more here and less there.
    rng = np.random.default_rng(seed)
    wanted = np.asarray(DEFAULT.values) + rng.normal(0, 10, 256)
    found = nearest(wanted, norm=norm)
    registers = encode(found.wave.values)
    worth = np.max if norm == "minimax" else np.linalg.norm
    here = worth(distances(found, wanted))
    tried = 0
    for _ in range(60):
        words = list(registers.words)
        for index in rng.integers(1, 256, 2):
            words[index >> 5] ^= 1 << (int(index) & 31)
        other = decode(type(registers)(tuple(words), registers.select, registers.start))
        if any(refusals(other)):
            continue
        tried += 1
        assert worth(np.abs(np.asarray(other.values) - wanted)) >= here - 1e-9
    assert tried


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=15)
def test_each_norm_is_the_best_by_its_own_measure(seed: int) -> None:
    wanted = np.asarray(DEFAULT.values) + np.random.default_rng(seed).normal(0, 8, 256)
    squares, largest = nearest(wanted), nearest(wanted, norm="minimax")
    assert squares.distance_rms <= largest.distance_rms + 1e-9
    assert largest.distance_max <= squares.distance_max + 1e-9


@pytest.mark.parametrize("norm", NORMS)
@pytest.mark.parametrize("grid", ["complement", "opposite", "whole_step"])
def test_what_can_be_encoded_is_its_own_nearest(norm: Norm, grid: str) -> None:
    wave = wanted_wave(Formula(grid=grid)).wave  # type: ignore[arg-type]
    found = nearest(wave.values, wave.mirror, norm)
    assert found.wave == wave
    assert found.distance_max == 0


def test_a_single_spike_is_smoothed_and_the_rest_stays() -> None:
    wanted = list(DEFAULT.values)
    wanted[100] += 40
    found = nearest(wanted)
    apart = np.abs(np.asarray(found.wave.values) - np.asarray(DEFAULT.values))
    assert apart[100] > 5
    # up and down again take two segments, which leaves one for each side: a count is lost there at most
    assert (apart[:96] == 0).all()
    assert apart[116:].max() == 1


def test_a_square_wave_rises_as_fast_as_the_table_can() -> None:
    found = nearest([200.0] * 256, mirror=-1)
    steps = np.diff(found.wave.values)
    assert found.wave.values[0] == 1  # the zero crossing, 2 * 1 + 1, is a difference of 3 too
    assert (steps[:60] == 3).all()
    assert set(np.abs(np.asarray(found.wave.values[80:]) - 200)) <= {0, 1}


def test_wishes_beyond_every_value_end_at_the_range() -> None:
    high, low = nearest([1e6] * 256), nearest([-1e6] * 256)
    assert max(high.wave.values) == 255
    assert max(low.wave.values) == 0
    assert not any(refusals(high.wave))
    assert not any(refusals(low.wave))


@pytest.mark.parametrize(
    ("wanted", "mirror", "norm"),
    [
        ([0.0] * 255, -1, "least_squares"),
        ([float("nan")] * 256, -1, "least_squares"),
        ([0.0] * 256, -4, "least_squares"),
        ([0.0] * 256, 512, "least_squares"),
        ([0.0] * 256, -1, "manhattan"),
    ],
)
def test_what_has_no_nearest_is_an_error(wanted: list[float], mirror: int, norm: Norm) -> None:
    with pytest.raises(ValueError, match=r"256 finite|mirror is|known: least_squares"):
        nearest(wanted, mirror, norm)
