"""What a measurement comes down to."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from app.calc.signals.statistics import figures


def test_a_damped_step_settles_and_overshoots_as_theory_says() -> None:
    time_s = np.linspace(0, 10, 10_001)
    damping, natural = 0.2, 2 * np.pi
    damped = natural * np.sqrt(1 - damping**2)
    swing = np.exp(-damping * natural * time_s) * (
        np.cos(damped * time_s) + damping / np.sqrt(1 - damping**2) * np.sin(damped * time_s)
    )
    found = figures(time_s, 1000 * (1 - swing))
    assert found.overshoot == pytest.approx(1000 * np.exp(-np.pi * damping / np.sqrt(1 - damping**2)), rel=1e-3)
    envelope_s = -np.log(0.02 * np.sqrt(1 - damping**2)) / (damping * natural)
    assert found.settling_s is not None
    assert 0.75 * envelope_s < found.settling_s <= envelope_s


def test_noise_around_a_place_is_no_step() -> None:
    noise = np.random.default_rng(1).normal(size=1000)
    found = figures(np.arange(1000.0), noise)
    assert (found.overshoot, found.settling_s) == (None, None)
    assert found.rms == pytest.approx(1, rel=0.1)


def test_nothing_there() -> None:
    found = figures(np.arange(3.0), np.full(3, np.nan))
    assert (found.samples, found.missing, found.maximum) == (0, 3, None)


@given(arrays(np.float64, st.integers(1, 50), elements=st.floats(-1e6, 1e6) | st.just(np.nan)), st.booleans())
def test_figures_of_what_is_there(values: np.ndarray, mirrored: bool) -> None:
    values = -values if mirrored else values
    found = figures(np.arange(len(values)) / 10, values)
    known = values[~np.isnan(values)]
    assert (found.samples, found.missing) == (len(known), len(values) - len(known))
    if len(known):
        assert (found.minimum, found.maximum) == (known.min(), known.max())
        assert (found.first, found.last) == (known[0], known[-1])
        assert found.overshoot is None or 0 <= found.overshoot <= np.ptp(known)
        assert found.settling_s is None or 0 <= found.settling_s <= (len(values) - 1) / 10
