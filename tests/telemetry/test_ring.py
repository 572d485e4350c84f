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
