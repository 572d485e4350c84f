"""Plants where nothing is to be gained: how often does a study claim an improvement all the same?

fastest move: the speeds and accelerations that may be tried end at the present ones. least current, closed loop: the
axis is set to what a first study of it chose. microstep calibration: a motor whose errors no table can hold.
StallGuard: load values that are noise, several times what a load makes of them, so that no threshold tells a stall.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.bench.collected import at_most, collected
from tests.bench.studies import closed_loop, fastest_move, least_current, microstep_calibration, stallguard
from tests.bench.table import Row

CLAIMED_MAX = 0.05
FIRST = 1000
STUDIES: dict[str, Callable[[int, Path], Awaitable[tuple[bool, str] | None]]] = {
    "fastest move": fastest_move.claimed,
    "StallGuard": stallguard.claimed,
    "microstep calibration": microstep_calibration.claimed,
    "least current": least_current.claimed,
    "closed loop": closed_loop.claimed,
}
"""Each says whether it claims an improvement of a plant, and what else; None where there is no such plant."""


@dataclass(frozen=True)
class Claimed:
    """Of one study: plants, and what it said of those that it claims to have improved."""

    name: str
    plants: int
    said: list[str]


def of_study(name: str, seeds: Sequence[int]) -> Claimed:
    """That study on plants of these seeds."""
    told = collected(f"gain {name}", STUDIES[name], seeds, share=1 / len(STUDIES))
    found = [one for one in told.values() if one is not None]
    return Claimed(name, len(found), [words for better, words in found if better])


def measure(quick: bool) -> Sequence[Row]:
    """A row for all of them; quick: a plant of each."""
    found = [of_study(name, range(FIRST, FIRST + (1 if quick else 20))) for name in STUDIES]
    plants, claims = sum(one.plants for one in found), sum(len(one.said) for one in found)
    return [
        Row(
            what=f"improvements claimed on {plants} plants where there is nothing to gain",
            measured=f"{at_most(claims, plants)}: "
            + ", ".join(f"{one.name} {len(one.said)} of {one.plants}" for one in found),
            peer=f"{plants}",
            ratio=claims / plants,
            required=f"<= {CLAIMED_MAX:g}",
            ok=claims <= CLAIMED_MAX * plants,
            notes=tuple(f"{one.name}: {words}" for one in found for words in one.said),
        )
    ]
