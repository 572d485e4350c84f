"""Which setting is tried where a search asks only for those that are not worth it: the one of the best prospect."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from scipy.stats import qmc

from ...telemetry.sampling import FloatArray
from ..search import Dimension

POINTS = 512
"""So many settings, evenly spread over the space, are looked at."""

Setting = Mapping[str, float]


def best_prospect(
    dimensions: Sequence[Dimension], held: Sequence[Setting], lost: Sequence[Setting], gain: Callable[[Setting], float]
) -> dict[str, float] | None:
    """The setting with the greatest gain times the chance that it holds; None where none has a gain.

    held, lost : settings that kept their steps, one at the least, and that did not. The nearer one is to the former,
        and the farther from the latter, the better its chance: distances are by ratios, each dimension's range the same
    gain : of a setting; 0 or less where it is not worth trying
    """
    low, high = (np.log([getattr(each, end) for each in dimensions]) for end in ("low", "high"))
    names = [each.name for each in dimensions]
    points = qmc.Halton(len(names), scramble=False).random(POINTS + 1)[1:]  # the first one is the lowest corner
    settings = [dict(zip(names, row.tolist(), strict=True)) for row in np.exp(low + points * (high - low))]
    gains = np.array([gain(setting) for setting in settings])
    if not np.any(gains > 0):
        return None

    def nearest(to: Sequence[Setting]) -> FloatArray:
        if not to:
            return np.ones(len(points))
        known = (np.log([[setting[name] for name in names] for setting in to]) - low) / (high - low)
        away: FloatArray = np.min(np.linalg.norm(points[:, None] - known[None], axis=2), axis=1)
        return away

    near, far = nearest(held), nearest(lost)
    chance = far / np.maximum(near + far, 1e-12)
    return settings[int(np.argmax(np.maximum(gains, 0) * chance))]
