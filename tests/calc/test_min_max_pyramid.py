"""Min/max segments of a measurement, and segments of segments: never is a peak hidden or a gap closed."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from app.calc.signals.min_max_pyramid import MinMaxSegments, size_for

COLUMNS = arrays(
    np.float64,
    st.tuples(st.integers(1, 3), st.integers(1, 200)),
    elements=st.floats(-1e6, 1e6, width=32) | st.sampled_from([np.nan, 0.0, 1.0]),
)


def extremes(values: np.ndarray) -> tuple[float, float]:
    known = values[~np.isnan(values)]
    return (known.min(), known.max()) if len(known) else (np.nan, np.nan)


@given(COLUMNS, st.integers(1, 30), st.integers(1, 9))
def test_against_looking_at_every_sample(columns: np.ndarray, size: int, again: int) -> None:
    time_s = np.arange(columns.shape[1]) / 10
    whole = MinMaxSegments.of_rows(time_s, columns).joined(size).joined(again)
    length = size * again
    assert len(whole) == -(-columns.shape[1] // length)
    for number in range(len(whole)):
        part = slice(number * length, (number + 1) * length)
        assert whole.start_s[number] == time_s[part][0]
        for channel, values in enumerate(columns):
            low, high = extremes(values[part])
            np.testing.assert_array_equal((whole.low[channel, number], whole.high[channel, number]), (low, high))
            assert whole.missing[channel, number] == np.isnan(values[part]).any()
            if not np.isnan(low):
                assert values[round(whole.low_s[channel, number] * 10)] == low
                assert values[round(whole.high_s[channel, number] * 10)] == high


@given(COLUMNS, st.integers(1, 30))
def test_what_is_drawn_has_every_extreme_and_every_gap(columns: np.ndarray, size: int) -> None:
    time_s = np.arange(columns.shape[1]) / 10
    segments = MinMaxSegments.of_rows(time_s, columns).joined(size)
    line_s, line = segments.line()
    assert np.all(np.diff(line_s) >= 0)
    for channel, values in enumerate(columns):
        assert np.isnan(line[channel]).any() == np.isnan(values).any()
        np.testing.assert_array_equal(extremes(line[channel]), extremes(values))
        own_s, own = segments.points(channel)
        assert np.all(np.diff(own_s) >= 0)
        rows = np.round(own_s * 10).astype(int)
        there = ~np.isnan(own)
        np.testing.assert_array_equal(values[rows][there], own[there])  # every point is a sample, at its own time
        np.testing.assert_array_equal(extremes(own), extremes(values))
        assert np.isnan(own).any() == np.isnan(values).any()


def test_parts_and_chains() -> None:
    columns = np.array([[3.0, 1.0, 2.0, 5.0, 4.0]])
    rows = MinMaxSegments.of_rows(np.arange(5.0), columns)
    chained = MinMaxSegments.chained((rows.part(0, 2).joined(2), rows.part(2, 5).joined(3)))
    np.testing.assert_array_equal(chained.low, [[1, 2]])
    np.testing.assert_array_equal(chained.high, [[3, 5]])
    np.testing.assert_array_equal(chained.start_s, [0, 2])


@pytest.mark.parametrize(("segments", "wanted", "size"), [(0, 10, 1), (10, 10, 1), (11, 10, 2), (100, 7, 15)])
def test_how_many_become_one(segments: int, wanted: int, size: int) -> None:
    assert size_for(segments, wanted) == size
    with pytest.raises(ValueError, match="at least one"):
        MinMaxSegments.of_rows(np.arange(2.0), np.zeros((1, 2))).joined(0)
