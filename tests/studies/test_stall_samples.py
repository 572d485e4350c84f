"""Load values on a way: each once, wherever the chip's full steps begin within those of the counter."""

from __future__ import annotations

import numpy as np
import pytest

from app.studies.stallguard.runs import each_fullstep

FULL_STEP = 256
STEPS = 60


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("phase", np.arange(0, 1, 0.05).tolist())
@pytest.mark.parametrize("samples", [2.3, 2.5, 3.1])
def test_no_value_is_left_out_and_none_counts_twice(phase: float, samples: float, way: int) -> None:
    """A sample a full step at its end took the values of one twice and left the next out, by where the chip's began."""
    rng = np.random.default_rng(round(1000 * phase))
    at = np.arange(0, STEPS, 1 / samples) + rng.uniform(0, 0.02)
    values = rng.integers(0, 500, STEPS + 2)
    load = values[np.floor(at - phase).astype(int) + 1].astype(float)
    kept = each_fullstep(way * at * FULL_STEP, load, FULL_STEP)
    seen = np.unique(np.floor(at - phase).astype(int) + 1)
    assert load[kept].tolist() == values[seen].tolist()


def test_a_value_that_never_changes_is_one_a_full_step() -> None:
    at = np.arange(0, 10, 0.4)
    assert int(each_fullstep(at * FULL_STEP, np.full_like(at, 7.0), FULL_STEP).sum()) in (10, 11)
