"""Statistics of measurements."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import astuple
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from app.calc.signals.statistics import Piece, Statistics
from app.calc.signals.statistics import statistics as statistics_of


def of_channel(time_s: np.ndarray, values: np.ndarray, cuts: Iterable[int] = ()) -> Statistics:
    """Of one channel, in pieces that end at `cuts`."""

    def pieces() -> Iterator[Piece]:
        ends = sorted({0, *cuts, len(values)})
        for first, last in pairwise(ends):
            yield time_s[first:last], values[None, first:last]

    (found,) = statistics_of(pieces, 1)
    return found


def test_a_damped_step_settles_and_overshoots_as_theory_says() -> None:
    time_s = np.linspace(0, 10, 10_001)
    damping, natural = 0.2, 2 * np.pi
    damped = natural * np.sqrt(1 - damping**2)
    swing = np.exp(-damping * natural * time_s) * (
        np.cos(damped * time_s) + damping / np.sqrt(1 - damping**2) * np.sin(damped * time_s)
    )
    found = of_channel(time_s, 1000 * (1 - swing))
    assert found.overshoot == pytest.approx(1000 * np.exp(-np.pi * damping / np.sqrt(1 - damping**2)), rel=1e-3)
    envelope_s = -np.log(0.02 * np.sqrt(1 - damping**2)) / (damping * natural)
    assert found.settling_s is not None
    assert 0.75 * envelope_s < found.settling_s <= envelope_s


def test_noise_around_a_place_is_no_step() -> None:
    noise = np.random.default_rng(1).normal(size=1000)
    found = of_channel(np.arange(1000.0), noise)
    assert (found.overshoot, found.settling_s) == (None, None)
    assert found.rms == pytest.approx(1, rel=0.1)


def test_nothing_there() -> None:
    found = of_channel(np.arange(3.0), np.full(3, np.nan))
    assert (found.samples, found.missing, found.maximum) == (0, 3, None)


@given(arrays(np.float64, st.integers(1, 50), elements=st.floats(-1e6, 1e6) | st.just(np.nan)), st.booleans())
def test_figures_of_what_is_there(values: np.ndarray, mirrored: bool) -> None:
    values = -values if mirrored else values
    found = of_channel(np.arange(len(values)) / 10, values)
    known = values[~np.isnan(values)]
    assert (found.samples, found.missing) == (len(known), len(values) - len(known))
    if len(known):
        assert (found.minimum, found.maximum) == (known.min(), known.max())
        assert (found.first, found.last) == (known[0], known[-1])
        assert found.overshoot is None or 0 <= found.overshoot <= np.ptp(known)
        assert found.settling_s is None or 0 <= found.settling_s <= (len(values) - 1) / 10


@given(
    arrays(np.float64, st.integers(1, 50), elements=st.floats(-1e3, 1e3) | st.just(np.nan)),
    st.sets(st.integers(1, 49), max_size=8),
    st.booleans(),
)
def test_in_how_many_pieces_it_comes_does_not_matter(values: np.ndarray, cuts: set[int], rising: bool) -> None:
    values = np.sort(values) if rising else values
    time_s = np.arange(len(values)) / 10
    whole = of_channel(time_s, values)
    parts = of_channel(time_s, values, (cut for cut in cuts if cut < len(values)))
    for one, other in zip(astuple(parts), astuple(whole), strict=True):
        assert other is one is None or one == pytest.approx(other, rel=1e-9, abs=1e-9)


def test_settling_is_told_whether_or_not_the_last_sample_outside_ends_a_piece() -> None:
    time_s, values = np.arange(6.0), np.array([0.0, 50.0, 110.0, 101.0, 100.0, 100.0])
    for cuts in ((), (1,), (2,), (3,), (1, 2, 3, 4, 5)):
        found = of_channel(time_s, values, cuts)
        assert (found.overshoot, found.settling_s) == (10.0, 3.0)
