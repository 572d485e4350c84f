"""Slow turns there and back, sampled at places of the electrical period that tell little or nothing."""

from __future__ import annotations

import numpy as np
import pytest

from app.calc.motors.slow_turns import SlowTurn, fit_slow_turn

TURN, PERIOD = 51_200.0, 1024.0
PLAY = 30.0


def fitted(step: float, seed: int, count: int = 500) -> SlowTurn:
    """A turn there and back, sampled every so many microsteps; a detent of order 4, an encoder of 40,000 counts."""
    there = np.floor(step * np.arange(count // 2) + 100.0)
    position = np.concatenate((there, there[::-1]))
    forward = np.arange(count) < count // 2
    encoder = position + np.where(forward, -PLAY / 2, PLAY / 2) + 6 * np.sin(8 * np.pi * position / PERIOD)
    encoder += np.random.default_rng(seed).normal(0.0, 2.0, count)
    encoder = np.round(encoder / 1.28) * 1.28
    return fit_slow_turn(position, encoder, forward, TURN, PERIOD)


@pytest.mark.parametrize("samples_a_period", [5.0, 6.0, 4.97, 5.3])
def test_orders_that_fall_on_each_other_spoil_nothing_of_what_is_told(samples_a_period: float) -> None:
    for seed in range(20):
        turn = fitted(PERIOD / samples_a_period, seed, 2 * int(TURN / PERIOD * samples_a_period))
        for told, truth in ((turn.ratio, 1.0), (turn.apart, PLAY)):
            assert 0 < told.half < np.inf
            assert abs(told.value - truth) <= 3 * told.half
        assert abs(turn.apart.value - PLAY) < 1.0
        assert 0 < turn.eccentricity.half < np.inf


@pytest.mark.parametrize("samples_a_period", [4.0, 2.0])
def test_an_order_that_looks_like_the_way_between_both_is_no_play(samples_a_period: float) -> None:
    """Order 4 is the same at each sample: 6 microsteps that nothing tells from the play."""
    with pytest.raises(ValueError, match="turn a little slower"):
        fitted(PERIOD / samples_a_period, 1, 8 * int(TURN / PERIOD * samples_a_period))


@pytest.mark.parametrize("samples_a_period", [5.3, 20.3])
def test_intervals_hold_the_truth(samples_a_period: float) -> None:
    """95 % is asked for; without leaving each part out it was 84 to 91 of 100."""
    count = 2 * int(TURN / PERIOD * samples_a_period)
    turns = [fitted(PERIOD / samples_a_period, seed, count) for seed in range(100)]
    assert sum(abs(turn.ratio.value - 1) <= turn.ratio.half for turn in turns) >= 92
    assert sum(abs(turn.apart.value - PLAY) <= turn.apart.half for turn in turns) >= 92
