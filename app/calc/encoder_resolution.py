"""What resolution an encoder has, by a measured move: counts a turn, how sure that is, and which usual value fits."""

from __future__ import annotations

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
