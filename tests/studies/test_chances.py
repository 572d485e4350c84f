"""The setting of the best prospect: what it gains, times the chance that it holds."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial

from hypothesis import given
from hypothesis import strategies as st

from app.studies.fastest_move.chances import best_prospect
from app.studies.search import Dimension

SPACE = (Dimension("speed", 1e4, 1e6), Dimension("acceleration", 1e5, 1e7))
GENTLE, HARD = {"speed": 1e4, "acceleration": 1e5}, {"speed": 1e6, "acceleration": 1e7}


def test_it_lies_between_what_held_and_what_did_not_and_where_nothing_is_gained_there_is_none() -> None:
    found = best_prospect(SPACE[:1], [GENTLE], [HARD], lambda each: math.log(each["speed"] / 1e4))
    assert found is not None
    assert 3e4 < found["speed"] < 9e5
    bolder = best_prospect(SPACE[:1], [GENTLE, found], [HARD], lambda each: math.log(each["speed"] / found["speed"]))
    assert bolder is not None
    assert bolder["speed"] > found["speed"]
    assert best_prospect(SPACE, [GENTLE], [HARD], lambda each: 0.0) is None


def _gain(low: float, high: float, setting: Mapping[str, float]) -> float:
    return math.log(setting["speed"] / low) if low < setting["speed"] < high else 0.0


@given(st.floats(2e4, 9e5), st.integers(0, 40))
def test_an_edge_is_closed_in_upon(edge: float, count: int) -> None:
    """A move that holds up to a speed: what lies between the fastest that held and the slowest that did not shrinks."""
    low, high, held, lost = 1e4, 1e6, [{"speed": 1e4}], [{"speed": 1e6}]
    for _ in range(count):
        found = best_prospect(SPACE[:1], held, lost, partial(_gain, low, high))
        if found is None:
            break
        low, high = (found["speed"], high) if found["speed"] <= edge else (low, found["speed"])
        (held if found["speed"] <= edge else lost).append(found)
    assert low <= edge <= high
    assert high / low < 1.05 or count < 12
