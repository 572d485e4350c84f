"""What resolution an encoder has, by a measured move: counts a turn, how sure that is, and which usual value fits.

And whether its deviation from the position tells of a wrong resolution: that grows in proportion to the way, the same
in both directions, which steps that are lost never do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

SLACK_MICROSTEPS = 16.0
"""How much the rotor may stand beside its field at both ends of the move together, by friction: a sixteenth of a full
step of 256."""

_LINES = [
    *(48, 50, 64, 96, 100, 120, 125, 128, 150, 180, 192, 200, 250, 256, 300, 360, 400, 500, 512, 600, 720, 800, 900),
    *(1000, 1024, 1200, 1250, 1500, 1600, 1800, 2000, 2048, 2500, 3000, 3600, 4000, 4096, 5000, 8192, 10_000),
]
USUAL_COUNTS: tuple[int, ...] = tuple(sorted({4 * lines for lines in _LINES} | {1 << bits for bits in range(8, 25)}))
"""What encoders are sold with: lines of incremental ones, four counts each, and the powers of two of absolute ones."""


@dataclass(frozen=True, slots=True)
class MeasuredEncoder:
    """Counts a turn as they were measured."""

    counts_per_turn: float
    """Below 0: it counts against the motor."""
    uncertainty: float
    """Half the width of what it may be as well [counts a turn]."""
    usual: int | None
    """The one usual resolution that lies within the uncertainty; None where there is none, or more than one."""

    @property
    def counts(self) -> int:
        """The counts a turn that one would set: the usual ones, else what was measured; 0 where it stands still."""
        return self.usual or round(abs(self.counts_per_turn))


def constant_of(word: int, *, decimal: bool) -> float:
    """Microsteps that a count is worth by a word of ENC_CONST: 15 bits, then a fraction in 1/65536 or 1/10000."""
    return (word >> 16) + (word & 0xFFFF) / (10_000 if decimal else 65_536)


def measured_encoder(
    counts: float, commanded: int, microsteps_per_turn: int, slack: float = SLACK_MICROSTEPS
) -> MeasuredEncoder:
    """Say what encoder told `counts` while the motor went `commanded` microsteps, not 0."""
    if commanded == 0 or microsteps_per_turn <= 0:
        raise ValueError("a resolution is measured over a way that is not 0, of a motor with a turn")
    turns = commanded / microsteps_per_turn
    per_turn = counts / turns
    uncertainty = 1 / abs(turns) + abs(per_turn) * slack / abs(commanded)
    fitting = [usual for usual in USUAL_COUNTS if abs(abs(per_turn) - usual) <= uncertainty]
    return MeasuredEncoder(per_turn, uncertainty, fitting[0] if len(fitting) == 1 else None)


@dataclass(frozen=True, slots=True)
class Place:
    """Where an axis was seen, and by how much its encoder differed then.

    uncertainty : by how much that may be wrong, because encoder and position were not read at one moment [microsteps]
    """

    position: int
    deviation: float
    uncertainty: float = 0.0


@dataclass(frozen=True, slots=True)
class EncoderLine:
    """Deviation over position, where it is a line.

    slope : deviation a microstep; the encoder counts 1 + slope microsteps where the motor goes one
    way : from the least position to the greatest [microsteps]
    off : how far the place that is furthest off the line is [microsteps]
    """

    slope: float
    places: int
    way: int
    off: float


SLOPE_MIN = 0.01
"""Less may be a motor under load, or an encoder off its centre."""
STANDS_STILL = 0.05
"""A slope as near to -1 is an encoder, or a shaft, that does not turn at all."""
PLACES_MIN, EACH_WAY_MIN = 8, 4
"""How many places at least, and how many of them in each direction."""
APART_TURNS = 1 / 32
"""Places nearer than that are one."""
OFF_MAX_FULLSTEPS = 0.5
"""How far a place may be off the line. Steps are lost by four full steps at a time, so that even a motor that loses
them all the way, at an even rate, is further off somewhere."""
OFF_MAX_SHARE = 0.1
"""And no more than this share of how far the deviations differ."""


def encoder_line(forward: Sequence[Place], backward: Sequence[Place], full_step: int, turn: int) -> EncoderLine | None:
    """The line on which all places lie that were come to forward and backward, over a turn at least and half a one each
    way; None where there are too few, where they lie on none, or where the encoder agrees or stands still."""
    places = [*forward, *backward]
    if len(places) < PLACES_MIN or min(len(forward), len(backward)) < EACH_WAY_MIN:
        return None
    if _way(places) < turn or min(_way(forward), _way(backward)) < turn / 2:
        return None
    if len({round(place.position / (turn * APART_TURNS)) for place in places}) < PLACES_MIN:
        return None  # between two places there is always a line
    position = sum(place.position for place in places) / len(places)
    deviation = sum(place.deviation for place in places) / len(places)
    across = sum((place.position - position) * (place.deviation - deviation) for place in places)
    slope = across / sum((place.position - position) ** 2 for place in places)
    if abs(slope) <= SLOPE_MIN or abs(slope + 1) <= STANDS_STILL:
        return None
    differ = max(place.deviation for place in places) - min(place.deviation for place in places)
    # An encoder that counts more than it should tells its own errors, and the rotor's lag, as so much greater.
    allowed = min(OFF_MAX_FULLSTEPS * full_step * max(1.0, abs(1 + slope)), OFF_MAX_SHARE * differ)
    off = [abs(place.deviation - deviation - slope * (place.position - position)) for place in places]
    if any(far > allowed + place.uncertainty for far, place in zip(off, places, strict=True)):
        return None
    return EncoderLine(slope, len(places), _way(places), max(off))


def _way(places: Sequence[Place]) -> int:
    return max(place.position for place in places) - min(place.position for place in places)
