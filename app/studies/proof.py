"""Whether a new setting is better than the old one, by pairs of runs, and how sure that is."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .parts import Interval, PairOrder

# scipy is imported where it is used: the server starts without it.

LEVEL = 0.05
RESAMPLES = 4000


def pair_order(index: int) -> PairOrder:
    """A B, then B A: what drifts with time is neither's advantage."""
    return "BA" if index % 2 else "AB"


@dataclass(frozen=True, slots=True)
class PairedEffect:
    """Mean of (new less old), its 95 % interval, and the two-sided p of Wilcoxon's signed-rank test."""

    mean: float
    interval: Interval
    p: float


def paired_effect(old: Sequence[float], new: Sequence[float], seed: int = 0) -> PairedEffect:
    """The paired difference of two series of the same length, 5 pairs at the least. Raises ValueError.

    The interval is a bootstrap over the pairs; of differences that are all the same it has no width.
    """
    from scipy import stats

    before, after = np.asarray(old, dtype=float), np.asarray(new, dtype=float)
    if before.shape != after.shape or before.ndim != 1 or len(before) < 5:
        raise ValueError(f"pairs are two series of one length, 5 at the least, not {before.shape} and {after.shape}")
    if not (np.isfinite(before).all() and np.isfinite(after).all()):
        raise ValueError("a pair without a figure is no pair")
    difference = after - before
    mean = float(difference.mean())
    if np.ptp(difference) == 0:
        around = Interval(low=mean, high=mean)
    else:
        found = stats.bootstrap(
            (difference,), np.mean, n_resamples=RESAMPLES, method="percentile", rng=np.random.default_rng(seed)
        ).confidence_interval
        # A percentile bootstrap of few pairs is too narrow: Student's interval is not.
        around = mean_interval(difference)
        around = Interval(low=min(float(found.low), around.low), high=max(float(found.high), around.high))
    p = 1.0 if not difference.any() else float(stats.wilcoxon(difference).pvalue)
    return PairedEffect(mean, around, p)


def mean_interval(values: Sequence[float] | NDArray[np.float64], level: float = LEVEL) -> Interval:
    """Student's interval of a mean, of two values at the least; wrong in a share `level`."""
    from scipy import stats

    found = np.asarray(values, dtype=float)
    n, mean = len(found), float(found.mean())
    half = float(stats.t.ppf(1 - level / 2, n - 1)) * float(found.std(ddof=1)) / math.sqrt(n)
    return Interval(low=mean - half, high=mean + half)


def is_better(effect: PairedEffect, old_mean: float, smallest_share: float) -> bool:
    """Whether less is shown: the test says so, and the whole interval lies below the smallest gain that counts."""
    return effect.p < LEVEL and effect.interval.high < -abs(smallest_share * old_mean)


@dataclass(frozen=True, slots=True)
class Compared:
    """Two series of pairs: the effect, both means, and whether less is shown."""

    effect: PairedEffect
    old: float
    new: float
    better: bool


def compared_pairs(
    old: Sequence[float], new: Sequence[float], smallest_share: float, seed: int, figures: int = 1
) -> Compared:
    """Compare a new setting with the old one by pairs of runs; less is better. Raises ValueError as `paired_effect`.

    figures : so many are compared by the same pairs, any of which may be better: p is taken as often (Bonferroni)
    """
    effect, mean = paired_effect(old, new, seed), statistics.fmean(old)
    effect = replace(effect, p=min(figures * effect.p, 1.0))
    return Compared(effect, mean, statistics.fmean(new), is_better(effect, mean, smallest_share))


def rate_bound(failures: int, runs: int, level: float = LEVEL) -> float:
    """Upper bound of a failure rate, one-sided, exact (Clopper and Pearson), wrong in a share `level`; 1 without a run.

    At 95 % 0 of 59 runs shows less than 5 %, 0 of 299 less than 1 %.
    """
    if runs <= 0 or failures >= runs:
        return 1.0
    if failures == 0:
        return float(1 - level ** (1 / runs))
    from scipy import stats

    return float(stats.beta.ppf(1 - level, failures + 1, runs - failures))


def rate_shown(failures: int, runs: int) -> float:
    """Lower bound of a failure rate, 95 %, one-sided, exact; 0 where nothing failed."""
    if failures <= 0:
        return 0.0
    from scipy import stats

    return float(stats.beta.ppf(LEVEL, failures, runs - failures + 1))


def runs_for(rate: float) -> int:
    """How many runs without a failure show less than `rate`."""
    return math.ceil(math.log(LEVEL) / math.log(1 - rate))
