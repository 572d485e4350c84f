"""What a velocity over time asks for, and the points that are sent for it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.ramps.velocity_profile import VelocityProfile, held_positions


def test_a_trapezoid() -> None:
    profile = VelocityProfile.of([0, 1, 3, 3.5], [0, 1000, 1000, 0])
    assert (profile.duration_s, profile.peak_pps, profile.acceleration_pps2) == (3.5, 1000, 2000)
    times, velocities = profile.points(None)
    assert (times.tolist(), velocities.tolist()) == ([0, 1, 3, 3.5], [0, 1000, 1000, 0])


@pytest.mark.parametrize(
    ("time_s", "velocity_pps", "words"),
    [
        ([0, 1], [0, 5], "ends at rest"),
        ([0, 1], [5, 0], "begins at rest"),
        ([1, 2], [0, 0], "begins at 0 s"),
        ([0, 1, 1], [0, 1, 0], "point 2 at 1 s does not come after 1 s"),
        ([0], [0], "two points or more"),
        ([0, 1], [0, 1, 0], "a time and a velocity each"),
        ([0, float("nan"), 2], [0, 1, 0], "finite"),
    ],
)
def test_what_is_no_profile(time_s: list[float], velocity_pps: list[float], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        VelocityProfile.of(time_s, velocity_pps)


@given(
    st.lists(st.tuples(st.floats(0.01, 2), st.floats(-1e5, 1e5)), min_size=1, max_size=20),
    st.floats(1, 2000),
)
def test_points_lie_on_the_lines_and_end_at_rest(knots: list[tuple[float, float]], rate_hz: float) -> None:
    time = np.concatenate(([0.0], np.cumsum([step for step, _ in knots]), [0.0]))
    time[-1] = time[-2] + 0.5
    velocity = np.array([0.0, *(value for _, value in knots), 0.0])
    profile = VelocityProfile.of(time, velocity)
    times, velocities = profile.points(rate_hz)
    assert times[0] == 0
    assert times[-1] == pytest.approx(profile.duration_s, abs=1e-9)
    assert (np.diff(times) > 0).all()
    assert velocities[-1] == 0
    np.testing.assert_allclose(velocities[:-1], np.interp(times[:-1], time, velocity))


def test_each_velocity_is_held_until_the_next() -> None:
    times = np.array([0.0, 0.5, 2.0])
    assert held_positions(times, np.array([100.0, -20.0, 0.0])).tolist() == [0.0, 50.0, 20.0]
