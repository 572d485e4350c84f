"""The algorithm of AN-001 3.2, which needs nothing but the counter: what `Rotary` is checked against."""

from __future__ import annotations

from fractions import Fraction

from app.calc.positions.extended import Counter


class MissedWrap(ValueError):
    """Between two looks the counter went on by half its range or more: overflows may have been missed."""

    def __init__(self, before: int, now: int, low_bit: int) -> None:
        super().__init__(
            f"bits {low_bit + 1} and {low_bit} of the counter went from {before:02b} to {now:02b}:"
            " looked at too late, so the place within the turn is not known; look at least four times a round"
        )


class TurnOffset:
    """The place within a turn out of nothing but the counter (AN-001 3.2).

    `low_bit` is the lower of the two neighbouring bits that tell of an overflow: by default the highest two of the
    counter; lower ones make smaller numbers and need looks more often. What the bits above them show is not used.
    """

    def __init__(self, microsteps_per_turn: Fraction, counter: Counter, count: int, low_bit: int | None = None) -> None:
        low_bit = counter.bits - 2 if low_bit is None else low_bit
        if not 0 <= low_bit <= counter.bits - 2:
            raise ValueError(f"the lower bit is 0..{counter.bits - 2}, not {low_bit}")
        if microsteps_per_turn <= 0:
            raise ValueError(f"a turn is above 0 microsteps, not {microsteps_per_turn}")
        self.microsteps_per_turn = microsteps_per_turn
        self.low_bit = low_bit
        self.modulus = 1 << (low_bit + 2)
        self.displacement_const = Fraction(self.modulus) % microsteps_per_turn
        """DISPLACEMENT_CONST: what an overflow adds to the place within a turn [microsteps]."""
        self.offset = Fraction(0)
        """OFFSET, 0 <= offset < turn [microsteps]."""
        self._count = count % self.modulus

    def update(self, count: int) -> Fraction:
        """The place within the turn while the counter shows `count`, signed or not [microsteps].

        Raises MissedWrap where the two bits went on by two: by three or more they cannot tell.
        """
        count %= self.modulus
        before, now = self._count >> self.low_bit, count >> self.low_bit
        if (now - before) % 4 == 2:
            raise MissedWrap(before, now, self.low_bit)
        if before == 3 and now == 0:
            self.offset += self.displacement_const
        elif before == 0 and now == 3:
            self.offset -= self.displacement_const
        self.offset %= self.microsteps_per_turn
        self._count = count
        return (count + self.offset) % self.microsteps_per_turn
