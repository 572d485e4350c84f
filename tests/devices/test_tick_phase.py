"""Ramp ticks learned from motion: from clean samples, and never from what only looks like them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.devices.tick_phase import TickPhase

PERIOD_S = 256e-6
VELOCITY = np.linspace(1_000.0, 80_000.0, 200)


@given(lead=st.floats(0.1, 1.0), start_s=st.floats(0.0, 100.0), later_s=st.floats(0.0, 100.0))
def test_the_next_start_finds_its_tick(lead: float, start_s: float, later_s: float) -> None:
    ticks = TickPhase()
    assert ticks.until_tick_s(start_s, PERIOD_S) is None
    residual = np.floor(VELOCITY * lead * PERIOD_S + 0.5)
    assert ticks.learn(residual, VELOCITY, start_s + PERIOD_S, PERIOD_S)
    first_tick_s = start_s + (1 - lead) * PERIOD_S
    until_s = ticks.until_tick_s(start_s + later_s, PERIOD_S)
    assert until_s is not None
    assert 0 < until_s <= PERIOD_S
    periods = (start_s + later_s + until_s - first_tick_s) / PERIOD_S
    assert abs(periods - round(periods)) < 0.05


def test_what_is_known_already_moves_nothing() -> None:
    """Else the curve would be computed anew for every block of samples."""
    ticks = TickPhase()
    assert ticks.learn(np.zeros(200), VELOCITY, 1.0, PERIOD_S), "a prediction that fits tells as much"
    assert not ticks.learn(np.zeros(200), VELOCITY, 1.0 + 3 * PERIOD_S, PERIOD_S)


def test_another_ramp_div_has_other_ticks() -> None:
    ticks = TickPhase()
    assert ticks.learn(VELOCITY * 0.5 * PERIOD_S, VELOCITY, 1.0, PERIOD_S)
    assert ticks.until_tick_s(2.0, PERIOD_S) is not None
    assert ticks.until_tick_s(2.0, 2 * PERIOD_S) is None


@pytest.mark.parametrize(
    ("residual", "velocity"),
    [
        pytest.param(np.full(200, np.nan), VELOCITY, id="nothing predicted"),
        pytest.param(VELOCITY * 0.5 * PERIOD_S, np.zeros(200), id="at rest"),
        pytest.param(VELOCITY[:2] * 0.5 * PERIOD_S, VELOCITY[:2], id="too few"),
        pytest.param(np.full(200, 0.1), np.full(200, 10.0), id="too slow to tell"),
        pytest.param(VELOCITY * 3 * PERIOD_S, VELOCITY, id="more than a tick: another reason"),
        pytest.param(np.random.default_rng(1).normal(5, 20, 200), VELOCITY, id="jitter of the link"),
    ],
)
def test_nothing_is_learned_from(residual: np.ndarray, velocity: np.ndarray) -> None:
    ticks = TickPhase()
    assert not ticks.learn(residual, velocity, 1.0, PERIOD_S)
    assert ticks.until_tick_s(2.0, PERIOD_S) is None
