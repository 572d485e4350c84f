"""How many runs a proof of a rate takes: against sequences that were drawn."""

from __future__ import annotations

import numpy as np
import pytest

from app.studies.proof import rate_bound, rate_shown
from app.studies.rate_proof import RateProof, rate_proof

DRAWN = 20_000


def share_shown(proof: RateProof, rate: float) -> float:
    """Of sequences in which a run is wrong with a chance of `rate`."""
    rng = np.random.default_rng(5)
    wrong = np.cumsum(rng.random((DRAWN, proof.ends[-1])) < rate, axis=1)
    looks = [wrong[:, end - 1] <= allowed for allowed, end in enumerate(proof.ends)]
    return float(np.any(looks, axis=0).mean())


@pytest.mark.parametrize("rate", [0.01, 0.05])
def test_a_rate_as_high_as_asked_passes_once_in_twenty_and_one_far_below_nearly_always(rate: float) -> None:
    proof = rate_proof(400, rate)
    assert share_shown(proof, rate) <= 0.05 + 0.004
    assert share_shown(proof, rate / 10) > 0.95


def test_a_wrong_run_is_made_up_for_by_more_runs() -> None:
    proof = rate_proof(366, 0.01)
    first, second, third = proof.ends
    assert (proof.shown(0, 365), proof.shown(0, 366), first) == (None, True, 366)
    assert (proof.shown(1, 366), proof.shown(1, second), proof.shown(2, second)) == (None, True, None)
    assert (proof.shown(2, third), proof.shown(3, 10)) == (True, False)
    assert rate_bound(2, third, proof.level) <= 0.01


def test_too_few_runs_to_show_it_may_have_none_wrong() -> None:
    proof = rate_proof(20, 0.01)
    assert (proof.shown(0, 19), proof.shown(0, 20), proof.shown(1, 5)) == (None, True, False)


def test_the_lower_bound_of_a_rate_is_that_of_clopper_and_pearson() -> None:
    assert rate_shown(0, 10) == 0
    assert rate_shown(1, 20) == pytest.approx(1 - 0.95 ** (1 / 20))
    assert rate_shown(10, 10) == pytest.approx(0.05 ** (1 / 10))
