"""Where one axis is, beyond its counter, and whether that can be trusted: fed with looks, and with what went wrong.

What a look leaves open is told, and from then on the position is a best guess: it goes on with the counter, so that
it can be shown and, by who knows better, confirmed. Only `set_actual` and `confirm` make it trusted again, or, after a
link was lost, a look that proves that nothing was missed.

The counter's own number is never written for this. `position` is the number that the user has given to the place, and
differs from what the counter counts by a whole number of microsteps, `origin`.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..calc.positions.extended import LIMIT, Counter, ExtendedPosition, TooLate, checked_position
from ..devices.core.counter import CounterReading

CLOCK_TOLERANCE = 1.02
"""How much faster than its settings say a chip may run: its clock, and the one that looks are timed with."""
SLACK_S = 0.02
"""By how much the times of two looks may be wrong against each other [s]."""
SAY = 'say where it is: PUT {"actual": n}, or {"confirm": true} where what is shown is right'


@dataclass(frozen=True, slots=True)
class PositionLost:
    """Why a position is not trusted, and the way out."""

    reason: str
    way_out: str = SAY


class Tracker:
    """One axis. Times are device time [s]; `count` and `position` belong together at `asked_s`."""

    def __init__(self, counter: Counter, count: int, asked_s: float, position: int) -> None:
        self.counter = counter
        self._extended = ExtendedPosition(counter, count, asked_s)
        self._reached = count
        self.count = count
        """What the counter showed at the latest look."""
        self.asked_s = asked_s
        """When that look was asked: the counter cannot have been read before."""
        self.origin = position - count
        self.lost: PositionLost | None = None
        """Why the position is not trusted; stays until a client says where it is."""
        self.away: PositionLost | None = None
        """Why it cannot be looked at now."""
        self._proven = position
        """Where the axis was at the latest look that came with word of resets."""
        self._rebase = False

    @property
    def extended(self) -> int:
        """The counter without its end: what the counter shows are the lowest bits of this."""
        return self._reached

    @property
    def position(self) -> int:
        """Where the axis is, as far as is known [microsteps]."""
        return self._reached + self.origin

    @property
    def trusted(self) -> bool:
        return self.lost is None and self.away is None

    # --- looks ----------------------------------------------------------------------------------

    def seen(self, count: int, asked_s: float, heard_s: float, speed_limit_pps: float) -> None:
        """The counter showed `count` at some time from `asked_s` to `heard_s` [s], by whoever asked.

        Polls from before the latest one are no news. While the axis is away, or after the counter was written, only
        `returned` counts.
        """
        if self.away is None and not self._rebase:
            self._seen(count, asked_s, heard_s, speed_limit_pps)

    def _seen(self, count: int, asked_s: float, heard_s: float, speed_limit_pps: float) -> None:
        if asked_s < self.asked_s:
            return
        heard_s = max(heard_s, asked_s)  # an emulator that stands still meanwhile sets its clock back to where it is
        before, elapsed_s = self._reached, heard_s - self.asked_s
        way = self.counter.way(count, self.count)
        speed_pps = speed_limit_pps * CLOCK_TOLERANCE
        try:
            self._reached = self._extended.update(count, heard_s, speed_pps)
        except TooLate as late:
            self.lose(f"looked at too late: {_late(late)}")
            self._reached = before + way
            self._extended.set(self._reached, count, asked_s)
        else:
            # The next look counts from when this one may have been taken at the earliest.
            self._extended.time_s = asked_s
            if abs(way) > speed_pps * (elapsed_s + SLACK_S) + 1:
                self.origin -= way  # no motor did that: the place is the same, and the counter shows another number
                self.lose(
                    f"the counter went on by {way} microsteps in {elapsed_s:.3g} s, faster than the chip can:"
                    " another client wrote it, or the chip was reset"
                )
        self.count, self.asked_s = count, asked_s
        self._check_range()

    def returned(self, look: CounterReading, heard_s: float, speed_limit_pps: float) -> None:
        """The service's own look, which also tells of resets; what was away is back with it."""
        was_away, self.away = self.away, None
        if look.reset_seen:
            # Others' looks since may be from before the reset or from behind it, and nobody can tell.
            self.origin += self._proven - self.position
            self.lose("the chip was reset, and its counter with it")
        if look.reset_seen or self._rebase:
            self._restart(look.count, look.asked_at_s)
        else:
            self._seen(look.count, look.asked_at_s, heard_s, speed_limit_pps)
        if was_away is not None and look.reset_seen is None:
            self.lose(f"{was_away.reason}; and this chip cannot tell whether it was reset meanwhile")
        self._proven = self.position

    def lost_sight(self, reason: str, way_out: str) -> None:
        """It cannot be looked at: trusted again when a look has shown that nothing was missed."""
        self.away = PositionLost(reason, way_out)

    def counter_written(self, what: str) -> None:
        """The counter is being written: where the axis was just before is not known to the microstep."""
        self.lose(f"the position counter was written ({what})")
        self._rebase = True

    # --- set by a client ------------------------------------------------------------------------

    def set_actual(self, position: int) -> None:
        """The axis is at `position` right now: at the latest look. Raises ValueError beyond 64 bits."""
        self.origin = checked_position(position) - self._reached
        self.confirm()

    def confirm(self) -> None:
        """What `position` says is right."""
        self.lost = None
        self._proven = self.position
        self._check_range()

    # --- inside ---------------------------------------------------------------------------------

    def _restart(self, count: int, asked_s: float) -> None:
        """The counter shows another number for the same place."""
        position, self._rebase = self.position, False
        self._extended.set(count, count, asked_s)
        self._reached = self.count = count
        self.asked_s, self.origin = asked_s, position - count

    def lose(self, reason: str) -> None:
        """The position is not to be trusted from now on."""
        if self.lost is None:  # the first is the cause of the others
            self.lost = PositionLost(reason)

    def _check_range(self) -> None:
        if not -LIMIT <= self.position < LIMIT:
            self.lose("the position has left 64 bits")


def _late(late: TooLate) -> str:
    half_round = f"at the chip's greatest speed the counter is half round in {late.allowed_s:.4g} s"
    return f"after {late.elapsed_s:.4g} s, and {half_round}"
