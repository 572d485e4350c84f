"""Whether a difference is one: against figures from elsewhere, and against chance."""

from __future__ import annotations

import numpy as np
import pytest

from app.studies.parts import Interval
from app.studies.proof import is_better, paired_effect, rate_bound, runs_for


def test_how_many_runs_show_which_rate() -> None:
    # the rule of three's exact form: 0 of 59 shows less than 5 %, 0 of 299 less than 1 %
    assert (runs_for(0.05), runs_for(0.01), runs_for(0.001)) == (59, 299, 2995)
    assert rate_bound(0, 59) < 0.05 < rate_bound(0, 58)
    assert rate_bound(1, 10) == pytest.approx(0.394163, abs=1e-5)  # Clopper and Pearson, one-sided
    assert rate_bound(0, 0) == rate_bound(3, 3) == 1.0


def test_a_difference_that_is_always_there_is_shown_with_its_size() -> None:
    before = [1.0 + 0.01 * index for index in range(10)]
    effect = paired_effect(before, [value - 0.1 for value in before])
    assert effect.mean == pytest.approx(-0.1)
    assert effect.interval.high < -0.099
    assert effect.p == pytest.approx(2 / 2**10)  # the exact one of ten differences of one sign
    assert is_better(effect, 1.045, 0.01)
    assert not is_better(effect, 1.045, 0.2), "less than what counts"


def test_what_does_not_differ_at_all_is_no_improvement() -> None:
    effect = paired_effect([1.0] * 10, [1.0] * 10)
    assert (effect.mean, effect.interval, effect.p) == (0.0, Interval(low=0.0, high=0.0), 1.0)
    assert not is_better(effect, 1.0, 0.0)


def test_chance_alone_is_seldom_taken_for_an_improvement_and_the_interval_holds_the_truth() -> None:
    rng = np.random.default_rng(7)
    claimed = held = 0
    for seed in range(200):
        before, after = rng.normal(1.0, 0.05, (2, 10))
        effect = paired_effect(list(before), list(after), seed)
        claimed += is_better(effect, 1.0, 0.0)
        held += effect.interval.low <= 0 <= effect.interval.high
    assert claimed <= 10
    assert held >= 185


def test_pairs_have_to_be_pairs() -> None:
    with pytest.raises(ValueError, match="of one length"):
        paired_effect([1.0] * 10, [1.0] * 9)
    with pytest.raises(ValueError, match="without a figure"):
        paired_effect([1.0] * 10, [float("nan"), *[1.0] * 9])
