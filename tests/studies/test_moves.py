"""Figures of a move that was measured."""

from __future__ import annotations

import numpy as np
import pytest

from app.procedures.procedure import Failed
from app.studies.moves import Sampled, figures_of


def test_a_move_of_which_hardly_a_sample_came_has_no_figures_and_says_so() -> None:
    """A machine that is busy, or a slow link: seen as one sample behind the command."""
    times, rows = np.array([-0.1, 0.0]), np.zeros(2)
    found = Sampled(0.0, times, rows, rows, 0, 0.0, np.empty((2, 0)))
    with pytest.raises(Failed, match="hardly a sample came"):
        figures_of(found, 1000, 0.0, 256, 64.0)
