from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.telemetry.ring import Ring


@given(capacity=st.integers(1, 30), pieces=st.lists(st.integers(0, 70), max_size=30))
def test_a_ring_keeps_the_newest_rows_in_order(capacity: int, pieces: list[int]) -> None:
    ring = Ring(2, capacity)
    written = 0
    for rows in pieces:
        time_s = np.arange(written, written + rows, dtype=float)
        ring.append(time_s, np.column_stack([time_s * 2, time_s * 3]))
        written += rows
    time_s, samples = ring.since(-1.0, [0, 1])
    assert time_s.tolist() == [float(row) for row in range(max(0, written - capacity), written)]
    assert len(ring) == len(time_s)
    np.testing.assert_array_equal(samples, np.column_stack([time_s * 2, time_s * 3]))


@given(
    capacity=st.integers(1, 2000),
    span_s=st.integers(1, 3000),
    pieces=st.lists(st.tuples(st.integers(0, 700), st.integers(1, 20)), max_size=30),
)
def test_what_is_older_than_the_span_goes(capacity: int, span_s: int, pieces: list[tuple[int, int]]) -> None:
    ring = Ring(1, capacity, span_s)
    now_s, every = 0, [np.empty(0)]
    for rows, apart_s in pieces:
        every.append(now_s + apart_s * np.arange(1.0, rows + 1))
        now_s += rows * apart_s
        ring.append(every[-1], -every[-1][:, None])
    times = np.concatenate(every)
    expected = times[times >= now_s - span_s][-capacity:]
    time_s, samples = ring.since(-1.0, [0])
    np.testing.assert_array_equal(time_s, expected)
    np.testing.assert_array_equal(samples[:, 0], -expected)


def test_its_buffer_is_no_longer_than_what_a_span_takes() -> None:
    lively, resting = Ring(50, 30_000, 600.0), Ring(50, 30_000, 600.0)
    lengths = []
    for second in range(3600):
        lively.append(second + np.arange(50) / 50, np.zeros((50, 50)))
        resting.append(second + np.arange(2) / 2, np.zeros((2, 50)))
        lengths.append(len(lively._time_s))
    assert lengths[-1] == lengths[660] <= 30_000 * 9 / 8
    assert len(resting._time_s) < 2 * 1200


def test_since_begins_at_the_asked_time() -> None:
    ring = Ring(1, 100)
    ring.append(np.array([0.0, 1.0, 1.0, 2.0]), np.array([[0.0], [1.0], [2.0], [3.0]]))
    assert ring.since(1.0, [0])[1][:, 0].tolist() == [1.0, 2.0, 3.0]
    assert ring.since(2.5, [0])[0].tolist() == []


def test_what_is_read_is_not_overwritten_later() -> None:
    ring = Ring(1, 2)
    ring.append(np.array([0.0, 1.0]), np.array([[10.0], [11.0]]))
    _, before = ring.since(0.0, [0])
    ring.append(np.array([2.0, 3.0, 4.0]), np.array([[12.0], [13.0], [14.0]]))
    assert before[:, 0].tolist() == [10.0, 11.0]


def test_a_ring_without_room_is_refused() -> None:
    with pytest.raises(ValueError, match="at least one row"):
        Ring(1, 0)
