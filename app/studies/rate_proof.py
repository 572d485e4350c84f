"""How many runs show that a rate is below what was asked: more where some were wrong, and exact all the same."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from .proof import LEVEL

WRONG_MORE = 2
"""Wrong runs, beyond those that the asked runs allow, that more runs may make up for."""


@dataclass(frozen=True, slots=True)
class RateProof:
    """A sequence of runs that is looked at after each.

    ends : after so many runs it is over where none was wrong, one, two ...; with one more it is over at once
    level : how sure the bound of a rate at its end has to be: the chance to be wrong of one look [share]
    """

    ends: tuple[int, ...]
    level: float

    def shown(self, wrong: int, runs: int) -> bool | None:
        """Whether the rate is low enough; None while further runs have to tell."""
        if wrong >= len(self.ends):
            return False
        return True if runs >= self.ends[wrong] else None


@cache
def rate_proof(asked: int, rate: float) -> RateProof:
    """At least `asked` runs. Where without a wrong one they show less than `rate` in any case, wrong ones are made up
    for by more, up to `WRONG_MORE` beyond what the asked runs allow; else the first wrong one ends it.

    A rate of `rate` or more passes in 5 % of all such sequences at the most, although there are several looks: the
    level of each is found by reckoning through all of them (binomial, exact).
    """
    from scipy import stats

    wrong = int(stats.binom.ppf(LEVEL, asked, rate)) - 1 + WRONG_MORE
    low, high = 0.001, LEVEL
    for _ in range(20):
        level = (low + high) / 2
        if _passes(_ends(asked, level, rate, wrong), rate) <= LEVEL:
            low = level
        else:
            high = level
    ends = _ends(asked, low, rate, wrong)
    return RateProof(ends, low) if asked >= ends[0] else RateProof((asked,), LEVEL)


def _ends(asked: int, level: float, rate: float, most: int) -> tuple[int, ...]:
    """So many runs, `asked` at the least, bound the rate below `rate` at `level`, with 0, 1 ... `most` wrong ones."""
    from scipy import stats

    wrong = np.arange(1, most + 2)
    # At that rate the next wrong run has come by then, but for a chance of `level`.
    ends = stats.nbinom.ppf(1 - level, wrong, rate) + wrong
    return tuple(max(asked, int(end)) for end in ends)


def _passes(ends: tuple[int, ...], rate: float) -> float:
    """How often a sequence at that rate is taken for good."""
    from scipy import stats

    going = np.eye(1, len(ends))[0]
    """Chance to go on with so many wrong runs."""
    passed, runs = 0.0, 0
    for end in sorted(set(ends)):
        more = stats.binom.pmf(np.arange(len(ends)), end - runs, rate)
        going = np.convolve(going, more)[: len(ends)]
        good = np.asarray(ends) <= end
        passed += float(going[good].sum())
        going[good] = 0.0
        runs = end
    return passed
