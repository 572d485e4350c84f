"""One encoder as motion controller and firmware see it: a counter, scaled to microsteps."""

from __future__ import annotations

from typing import Protocol


class EncoderChannel(Protocol):
    """`Drive.internal` or `Drive.external`. All of it may be read and set at any time."""

    counts: int
    """Counted since the start, never wrapped [counts]; not writable."""
    absolute: int
    """Place in the turn, 0..counts a turn - 1; not writable."""
    position: int
    """Scaled counter [microsteps], signed 32 bits: what TMCL AP 209 or AP 216, or X_ENC, shows. Writable."""
    deviation: int
    """XACTUAL - position [microsteps], signed 32 bits; not writable."""
    limit: int
    """Largest |deviation| allowed [microsteps]; 0: not looked at. Looked at in every tick."""
    stops: bool
    """Whether more than `limit` stops the motor (True at first) or is only told."""
    exceeded: bool
    """Latched when |deviation| > limit; with `stops` the motor is held at zero velocity until it is set False.
    It latches again in the next tick if the deviation is still too large."""
    clear_on_null: bool
    """Armed: the next time the encoder passes its zero, `position` becomes 0 and this False."""

    def scale(self, numerator: int, denominator: int) -> None:
        """From now on a count is numerator / denominator microsteps; `position` stays what it is.

        A negative numerator turns the direction around. 51200 microsteps and 1024 counts a turn: scale(51200, 1024),
        which is also the scale at power-on; external: scale(51200, 4 * lines). Raises ValueError for a denominator
        below 1.
        """
