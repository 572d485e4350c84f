"""Where the index of an encoder was met on ways there and back, and whether it comes again at the same place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...number_text import counted, times
from ..record import Finding
from .faults import Way

SAME_FULLSTEPS = 1.0
"""As far apart the places may be of an index that comes once a turn: what friction and a late look add is far less."""


@dataclass(frozen=True, slots=True)
class IndexMet:
    """A way, and where the encoder was as its index was met on it [microsteps, as the encoder is set]."""

    way: Way
    latched: Sequence[int]

    @property
    def forward(self) -> bool:
        """Whether the motor went to greater positions."""
        return bool(self.way.position[-1] > self.way.position[0])

    @property
    def places(self) -> list[float]:
        """The motor's position there [microsteps]."""
        order = np.argsort(self.way.encoder, kind="stable")
        encoder, position = self.way.encoder[order], self.way.position[order]
        return [float(np.interp(each, encoder, position)) for each in self.latched]


def index_findings(ways: Sequence[IndexMet], turn: int, full_step: int) -> list[Finding]:
    """What the ways tell of the index, and of its place, which is the encoder's offset. `turn`, `full_step` : of the
    motor [microsteps]"""
    turns = sum(float(np.ptp(each.way.position)) for each in ways) / turn
    farthest = max(float(np.ptp(each.way.position)) for each in ways) / turn
    by_way = [[place for each in ways if each.forward == forward for place in each.places] for forward in (True, False)]
    met = [place for places in by_way for place in places]
    if not met:
        if farthest < 1 - full_step / turn:
            text = f"none on the {counted(farthest, 'turn', 3)} that were looked at: it may lie beside them"
            return [Finding(name="index", text=text, sure="cannot be told")]
        text = f"none seen in {counted(turns, 'turn', 3)}: none is connected, or its pin serves something else"
        return [Finding(name="index", text=text)]
    first = met[0]
    # Of a turn, around the first one seen: places just below and above a whole turn are near each other.
    folded = [[first + (place - first + turn / 2) % turn - turn / 2 for place in places] for places in by_way]
    again = [max(places) - min(places) for places in folded if len(places) > 1]
    seen = f"seen {times(len(met))} in {counted(turns, 'turn', 3)}"
    if not again:
        text = f"{seen}: nothing tells whether it comes again at the same place"
        return [Finding(name="index", text=text, sure="cannot be told")]
    apart = max(again)
    if apart > SAME_FULLSTEPS * full_step:
        text = f"{seen}, at places that are no whole turns apart: it is not on this shaft, or its line is disturbed"
        return [Finding(name="index", text=text, value=apart, unit="microsteps")]
    means = [float(np.mean(places)) if places else None for places in folded]
    told = [
        f"{way} at {round(mean % turn):,}" for way, mean in zip(("up", "down"), means, strict=True) if mean is not None
    ]
    middle = float(np.mean([mean for mean in means if mean is not None])) % turn
    return [
        Finding(
            name="index",
            text=f"{seen}, whole turns apart, and again at the same place within so much",
            value=apart,
            unit="microsteps",
        ),
        Finding(
            name="offset",
            text=f"of the index, from a whole turn of the position counter: {', '.join(told)}",
            value=middle,
            unit="microsteps",
        ),
    ]
