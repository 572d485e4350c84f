"""One encoder as motion controller and firmware see it: a counter, scaled to microsteps."""

from __future__ import annotations

import math
from collections.abc import Callable

from . import kernel as k
from .units import wrap32


class EncoderChannel:
    """`Drive.internal` or `Drive.external`. All of it may be read and set at any time."""

    def __init__(self, s: k.Cells, f: k.Floats, at: int, changed: Callable[[], None]) -> None:
        """`at` says where its cells begin in `s`; `changed` is called after each change."""
        self._s, self._f, self._at, self._changed = s, f, at, changed

    @property
    def counts(self) -> int:
        """Counter [counts], never wrapped. The internal one is 0 at the magnet's zero: not at the start."""
        if self._at == k.INTERNAL:
            return int(k.internal_counts(self._f))
        return int(k.external_counts(self._s, self._f))

    @property
    def counts_per_turn(self) -> int:
        """Counts a turn: 1024, or four times the lines."""
        return int(self._s[self._at + k.E_PER_TURN])

    @property
    def absolute(self) -> int:
        """Place in the turn, 0..counts_per_turn - 1."""
        return self.counts % self.counts_per_turn

    @property
    def position(self) -> int:
        """Scaled counter [microsteps], signed 32 bits: what TMCL AP 209 or AP 216, or X_ENC, shows. 0 at power-on."""
        return int(k.position_of(self._s, self._at, self.counts))

    @position.setter
    def position(self, value: int) -> None:
        self._s[self._at + k.E_BASE] = wrap32(value)
        self._s[self._at + k.E_BASE_COUNTS] = self.counts
        self._changed()

    @property
    def deviation(self) -> int:
        """XACTUAL - position [microsteps], signed 32 bits."""
        return wrap32(int(self._s[k.X]) - self.position)

    @property
    def limit(self) -> int:
        """Largest |deviation| allowed [microsteps], looked at in every tick; 0: never."""
        return int(self._s[self._at + k.E_LIMIT])

    @limit.setter
    def limit(self, value: int) -> None:
        if not 0 <= value <= 0x7FFFFFFF:
            raise ValueError(f"limit is {value}, allowed is 0..2147483647")
        self._s[self._at + k.E_LIMIT] = value
        self._changed()

    @property
    def stops(self) -> bool:
        """Whether more than `limit` stops the motor or is only told. True at first."""
        return bool(self._s[self._at + k.E_STOPS])

    @stops.setter
    def stops(self, value: bool) -> None:
        self._s[self._at + k.E_STOPS] = bool(value)
        self._changed()

    @property
    def exceeded(self) -> bool:
        """Latched when |deviation| > limit. With `stops` the motor is held at velocity 0 until it is set False.

        It latches again in the next tick if the deviation is still too large.
        """
        return bool(self._s[self._at + k.E_EXCEEDED])

    @exceeded.setter
    def exceeded(self, value: bool) -> None:
        self._s[self._at + k.E_EXCEEDED] = bool(value)
        self._changed()

    @property
    def clear_on_null(self) -> bool:
        """Armed: the next time the encoder passes its zero, `position` is 0 there, and this False."""
        return bool(self._s[self._at + k.E_NULL])

    @clear_on_null.setter
    def clear_on_null(self, value: bool) -> None:
        self._s[self._at + k.E_NULL] = bool(value)
        self._changed()

    def scale(self, numerator: int, denominator: int) -> None:
        """From now on a count is numerator / denominator microsteps; `position` stays what it is.

        A negative numerator turns the direction around. At power-on 51200 / 1024 for the internal encoder (256
        microsteps a full step, 200 full steps a turn) and 1 / 1, as the chip's ENC_CONST, for the external one; with
        L lines that wants scale(51200, 4 * L). Raises ValueError for a denominator below 1 or a fraction that does
        not reduce to 32 bits.
        """
        if denominator < 1:
            raise ValueError(f"denominator is {denominator}, has to be at least 1")
        common = math.gcd(numerator, denominator)
        numerator, denominator = numerator // common, denominator // common
        if max(abs(numerator), denominator) > 1 << 31:
            raise ValueError(f"{numerator} / {denominator} does not fit 32 bits")
        counts, position = self.counts, self.position
        s, at = self._s, self._at
        s[at + k.E_BASE], s[at + k.E_BASE_COUNTS] = position, counts
        s[at + k.E_NUM], s[at + k.E_DEN] = numerator, denominator
        self._changed()
