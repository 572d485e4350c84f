"""What drivers tell of an axis's position counter, which wraps: for whoever follows the position beyond it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class CounterReading:
    """The answer to one question for the counter."""

    count: int
    """What the counter showed, signed [microsteps]."""
    asked_at_s: float
    """When the question went out, device time [s]: the counter was read no earlier, and before the answer was there."""
    reset_seen: bool | None
    """Whether the chip was reset since the look before; at the first look of a connection whether it says that it was
    since that was last acknowledged. None where the chip cannot tell. Asked after the counter, so that no count
    from after a reset goes without it."""


@dataclass(frozen=True, slots=True)
class PositionSeen:
    """A driver has read an axis's position counter, for whatever purpose: of a block of samples the latest row.

    Told without delay, so that the server's now is an upper bound of when the counter was read.
    """

    axis: int
    count: int
    """What the counter showed, signed [microsteps]."""
    asked_at_s: float
    """When the question went out, device time [s]."""
    encoder_count: int | None = None
    """What the encoder's counter showed with it, in microsteps of the same scale; None where it was not read along."""


@dataclass(frozen=True, slots=True)
class CounterWritten:
    """The position counter was written, or will be: it shows another number for the same place."""

    axis: int
    what: str
    """The command, as `MotionCommanded` names it."""
