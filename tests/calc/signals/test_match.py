"""A measurement is found in another one wherever it lies, upside down or with holes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.calc.signals.alignment import FloatArray, match_of


def bump(time_s: FloatArray, at_s: float) -> FloatArray:
    """A move: up along a slope, and a ringing at its end."""
    since = time_s - at_s
    after = np.maximum(since - 0.3, 0)
    return np.asarray(np.clip(since, 0, 0.3) * 10 + np.exp(-8 * after) * np.sin(60 * after), dtype=np.float64)


@settings(max_examples=60, deadline=None)
@given(
    shift_s=st.floats(-0.4, 0.4),
    start_s=st.floats(-50, 50),
    gain=st.sampled_from((-3.0, -0.01, 0.02, 5.0)),
    level=st.floats(-10, 10),
    step_s=st.sampled_from((0.0005, 0.001, 0.0037)),
)
def test_it_is_found_wherever_it_lies(shift_s: float, start_s: float, gain: float, level: float, step_s: float) -> None:
    first_s = np.arange(0, 2, 0.002)
    second_s = np.arange(0, 1.5, step_s)
    second = level + gain * bump(second_s, 0.7 - shift_s)
    found = match_of(first_s, bump(first_s, 0.7), second_s + start_s, second)
    assert found is not None
    assert found.offset_s == pytest.approx(shift_s - start_s, abs=0.002)
    assert abs(found.correlation) > 0.99
    assert np.sign(found.correlation) == np.sign(gain)


def test_holes_count_nowhere() -> None:
    first_s = np.arange(0, 2, 0.002)
    first, second = bump(first_s, 0.7), bump(first_s, 0.6)
    first[100:200] = np.nan
    second[500:520] = np.nan
    found = match_of(first_s, first, first_s, second)
    assert found is not None
    assert found.offset_s == pytest.approx(0.1, abs=0.001)


def test_what_does_not_change_lies_nowhere() -> None:
    at_s = np.arange(0, 1, 0.01)
    flat, hole = np.ones(100), np.full(100, np.nan)
    for other in (flat, hole):
        assert match_of(at_s, other, at_s, at_s) is None
        assert match_of(at_s, at_s, at_s, other) is None
    assert match_of(at_s[:2], at_s[:2], at_s, at_s) is None


def test_noise_is_not_alike() -> None:
    noise = np.random.default_rng(7)
    at_s = np.arange(0, 4, 0.001)
    found = match_of(at_s, noise.normal(size=4000), at_s, noise.normal(size=4000))
    assert found is not None
    assert abs(found.correlation) < 0.3
