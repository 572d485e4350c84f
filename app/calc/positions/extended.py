"""Positions beyond a chip's counter: the counter wraps, the position goes on (AN-001 chapter 2).

The application note keeps 64 bits in two halves and looks for a carry between them. Here a position is
one integer without an end and each look at the counter adds the shorter way from the look before, which
is the same wherever the note's procedure is right. It says more where the note is silent: a look that
came so late that the counter may have gone round is an error, never a guess.

AN-001 2.1 step 3 sets X_TARGET "using the lower 24 bits", and speaks of the "upper eight bits" of the
actual position: left over from a chip of 24 bits. All 32 bits of the counter are meant (Table of registers, 2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

LIMIT = 1 << 63
"""A position is kept within 64 bits, sign included: at 8 Mpps that is 36,000 years away."""
SERVICE_SHARE = 0.25
"""Share of the time to the first ambiguous look after which the next is due: three may fail before one is lost."""


class TooLate(ValueError):
    """So much time went by that the counter may have gone round unseen: the position is not known any more.

    `elapsed_s` since the reading before [s], `allowed_s` what it could have been at that speed [s].
    """

    def __init__(self, elapsed_s: float, allowed_s: float) -> None:
        super().__init__(
            f"the counter was looked at after {elapsed_s:g} s; at this speed it may go round in {allowed_s:g} s:"
            " set the position anew"
        )
        self.elapsed_s = elapsed_s
        self.allowed_s = allowed_s


@dataclass(frozen=True, slots=True)
class Counter:
    """A position counter of `bits` bits, two's complement, that wraps: 24 of a TMC428, 32 of most others."""

    bits: int = 32

    def __post_init__(self) -> None:
        if not 2 <= self.bits <= 63:
            raise ValueError(f"a counter has 2..63 bits, not {self.bits}")

    @property
    def modulus(self) -> int:
        """How many positions it tells apart."""
        return 1 << self.bits

    @property
    def half(self) -> int:
        """A way of so many microsteps between two looks leaves its direction open."""
        return 1 << (self.bits - 1)

    @property
    def piece(self) -> int:
        """The longest move given to the chip at once: half of what its sign can tell (AN-001 2.1)."""
        return 1 << (self.bits - 2)

    def shows(self, position: int) -> int:
        """What the counter shows at `position`, signed [microsteps]."""
        half = 1 << (self.bits - 1)  # not by the properties: this is done at every look of everybody
        return (position + half) % (half << 1) - half

    def way(self, count: int, since: int) -> int:
        """The shorter way from count `since` to `count`, -half..half-1 [microsteps]."""
        half = 1 << (self.bits - 1)
        return (count - since + half) % (half << 1) - half

    def allowed_s(self, speed_pps: float) -> float:
        """How long it may go unlooked at while the motor turns no faster than `speed_pps` [s]; inf at rest."""
        return math.inf if speed_pps <= 0 else (self.half - 1) / speed_pps

    def service_period_s(self, speed_pps: float) -> float:
        """How often to look at it, at the least, up to that speed [s]; inf at rest."""
        return SERVICE_SHARE * self.allowed_s(speed_pps)


class ExtendedPosition:
    """Where an axis is, extended: fed with every look at its counter.

    `count` is what the counter shows at `time_s` [s], `position` where that is [microsteps]; None: the same number.
    Raises ValueError for a position that the counter does not show, or beyond 64 bits.
    """

    def __init__(self, counter: Counter, count: int, time_s: float, position: int | None = None) -> None:
        self.counter = counter
        self._count = count
        self.time_s = time_s
        """When the counter was last looked at."""
        self.lost: TooLate | None = None
        """Why the position is not known, where it is not."""
        self._position = 0
        self.set(count if position is None else position, count, time_s)

    def set(self, position: int, count: int, time_s: float) -> None:
        """The axis is at `position` while the counter shows `count`; forgets what was lost. Raises ValueError."""
        checked_position(position)
        if self.counter.shows(position) != count:
            shown = self.counter.shows(position)
            raise ValueError(f"at position {position} the counter shows {shown}, not {count}; write that first")
        self._position, self._count, self.time_s, self.lost = position, count, time_s, None

    @property
    def position(self) -> int:
        """Raises TooLate while it is not known [microsteps]."""
        if self.lost is not None:
            raise self.lost
        return self._position

    def update(self, count: int, time_s: float, speed_max_pps: float) -> int:
        """The counter shows `count` at `time_s` [s]; the position then.

        `speed_max_pps` is what the motor cannot have exceeded since the reading before, in either direction.
        Raises TooLate where that leaves the way open, and from then on until `set`; ValueError for a count
        that is none, or a time before the last one.
        """
        if self.lost is not None:
            raise self.lost
        if self.counter.shows(count) != count:
            raise ValueError(f"a counter of {self.counter.bits} bits does not show {count}")
        elapsed_s = time_s - self.time_s
        if elapsed_s < 0:
            raise ValueError(f"time went back by {-elapsed_s:g} s")
        allowed_s = self.counter.allowed_s(speed_max_pps)
        if elapsed_s > allowed_s:
            self.lost = TooLate(elapsed_s, allowed_s)
            raise self.lost
        position = self._position + self.counter.way(count, self._count)
        checked_position(position)
        self._position, self._count, self.time_s = position, count, time_s
        return position

    def latched(self, count: int) -> int:
        """The position that a snapshot register shows as `count` [microsteps].

        The snapshot is less than half the counter's range away, since whoever takes it looks often enough; the note
        copies the upper half instead, which is wrong where the counter wrapped between snapshot and look.
        """
        return self.position + self.counter.way(count, self._count)


def checked_position(position: int) -> int:
    """`position`, where it fits 64 bits. Raises ValueError."""
    if not -LIMIT <= position < LIMIT:
        raise ValueError(f"a position is {-LIMIT}..{LIMIT - 1} microsteps, not {position}")
    return position


def next_target(counter: Counter, target: int, actual: int) -> int:
    """What to write to X_TARGET on the way from `actual` to `target` (AN-001 2.1 step 3) [as the counter shows it].

    Written again at every look it keeps the chip from arriving anywhere but at `target`: what is left is
    never less than a piece.
    """
    left = checked_position(target) - actual
    return counter.shows(actual + max(-counter.piece, min(counter.piece, left)))


def pieces(counter: Counter, target: int, actual: int) -> int:
    """How many pieces the way is; 0 at the target."""
    return -(-abs(target - actual) // counter.piece)


def compare_count(counter: Counter, position: int, actual: int) -> int | None:
    """What to write to the position compare register for `position`; None while it has to be off (AN-001 2.1).

    Further than a piece away the counter would show the same number before.
    """
    return counter.shows(position) if abs(position - actual) <= counter.piece else None
