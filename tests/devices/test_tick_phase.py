"""Ramp ticks learned from motion: from clean samples, and never from what only looks like them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.devices.tmc428.tick_phase import TickPhase

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


def test_a_whole_motion_tells_more_than_its_beginning() -> None:
    """Learned from the first samples to some microseconds, then from all of them to a fraction of one."""
    ticks = TickPhase()
    noise = np.random.default_rng(7).uniform(-0.5, 0.5, VELOCITY.size)
    few = slice(140, 150)
    assert ticks.learn(VELOCITY[few] * 0.5 * PERIOD_S + 1.2, VELOCITY[few], PERIOD_S, PERIOD_S)
    assert ticks.until_tick_s(0.0, PERIOD_S) != pytest.approx(0.5 * PERIOD_S, abs=5e-6)
    # The next motion begins with a tick that was taken for later than it was; all of its samples say so.
    assert ticks.learn(VELOCITY * 0.25 * PERIOD_S + noise, VELOCITY, 8.75 * PERIOD_S, PERIOD_S)
    assert not ticks.learn(VELOCITY * 0.01 * PERIOD_S + noise, VELOCITY, 8.51 * PERIOD_S, PERIOD_S)
    ticks.next_motion()
    assert ticks.until_tick_s(20.4 * PERIOD_S, PERIOD_S) == pytest.approx(0.1 * PERIOD_S, abs=0.5e-6)


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
