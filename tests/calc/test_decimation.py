"""Fewer points, and no peak hidden."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from app.calc.signals.decimation import extremes

SAMPLES = arrays(
    np.float64, st.integers(0, 400), elements=st.floats(-1e6, 1e6, width=32) | st.sampled_from([np.nan, 0.0, 1.0])
)


@given(SAMPLES, st.integers(8, 120))
def test_the_picture_has_every_extreme_and_every_gap(values: np.ndarray, points: int) -> None:
    time_s = np.arange(len(values)) / 1000
    at_s, few = extremes(time_s, values, points)
    assert len(few) <= max(points, 8)
    rows = np.round(at_s * 1000).astype(int)
    np.testing.assert_array_equal(values[rows], few)  # every point is a sample, at its own time
    assert np.all(np.diff(at_s) > 0)
    if len(values) <= points:
        np.testing.assert_array_equal(few, values)
        return
    for part in np.split(np.arange(len(values)), np.linspace(0, len(values), points // 3 + 1).astype(int)[1:-1]):
        held, shown = values[part], few[(rows >= part[0]) & (rows <= part[-1])]
        assert np.isnan(held).any() == np.isnan(shown).any()
        if not np.isnan(held).all():
            assert (np.nanmin(shown), np.nanmax(shown)) == (np.nanmin(held), np.nanmax(held))


@pytest.mark.parametrize(
    ("time_s", "values", "points"), [(np.zeros(3), np.zeros(3), 7), (np.zeros(3), np.zeros(4), 100)]
)
def test_what_cannot_be(time_s: np.ndarray, values: np.ndarray, points: int) -> None:
    with pytest.raises(ValueError, match=r"points|as many"):
        extremes(time_s, values, points)
