"""One measurement at another's times: along lines, and nothing made up."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.signals.alignment import at_times, difference_of, usual_interval_s

TIME_S = np.array([0.0, 1.0, 2.0, 3.0, 10.0, 11.0])
VALUES = np.array([0.0, 10.0, np.nan, 30.0, 40.0, 50.0])


@pytest.mark.parametrize(
    ("wanted_s", "value"),
    [
        (0.0, 0.0),
        (0.25, 2.5),
        (1.0, 10.0),
        (1.5, np.nan),  # beside a missing one
        (2.0, np.nan),
        (3.0, 30.0),
        (5.0, np.nan),  # in a gap
        (10.5, 45.0),
        (11.0, 50.0),
        (-0.001, np.nan),
        (11.001, np.nan),
    ],
)
def test_between_samples(wanted_s: float, value: float) -> None:
    found = at_times(TIME_S, VALUES, np.array([wanted_s]), reach_s=2.5)
    np.testing.assert_allclose(found, [value])


@given(
    st.lists(st.floats(0.01, 1), min_size=2, max_size=40), st.floats(-50, 50), st.floats(-50, 50), st.integers(0, 99)
)
def test_a_straight_line_stays_one_inside_and_nothing_is_outside(
    steps: list[float], slope: float, offset: float, seed: int
) -> None:
    time_s = np.cumsum(steps)
    wanted_s = np.random.default_rng(seed).uniform(time_s[0] - 1, time_s[-1] + 1, 50)
    found = at_times(time_s, offset + slope * time_s, wanted_s, reach_s=2.0)
    inside = (wanted_s >= time_s[0]) & (wanted_s <= time_s[-1])
    np.testing.assert_array_equal(np.isnan(found), ~inside)
    np.testing.assert_allclose(found[inside], (offset + slope * wanted_s)[inside], atol=1e-9)


def test_figures_of_a_difference() -> None:
    found = difference_of(np.array([0.0, 1.0, 2.0, 3.0]), np.array([1.0, -4.0, np.nan, 3.0]))
    assert (found.samples, found.peak, found.peak_at_s, found.mean) == (3, -4.0, 1.0, 0.0)
    assert found.rms == pytest.approx(np.sqrt(26 / 3))
    assert difference_of(np.array([0.0]), np.array([np.nan])).peak is None


def test_nothing_at_all() -> None:
    assert np.isnan(at_times(np.empty(0), np.empty(0), np.array([1.0]), 1.0)).all()
    assert usual_interval_s(np.empty(0)) == 0
    assert usual_interval_s(TIME_S) == 1
