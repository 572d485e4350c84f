"""What a line asks of a module that hangs on it."""

from __future__ import annotations

from typing import Protocol

from ...clock import ScaledClock


class ModuleFaults(Protocol):
    """What may be wrong between a module and its line. A module says it; the line does it to the bytes."""

    @property
    def silence(self) -> bool:
        """The module obeys and says nothing."""
        ...

    @property
    def late_reply_s(self) -> float:
        """How much later than it should an answer comes [s]."""
        ...

    @property
    def bit_error_rate(self) -> float:
        """The probability that a bit of an answer is flipped."""
        ...

    @property
    def half_frame_rate(self) -> float:
        """The probability that an answer breaks off."""
        ...

    @property
    def unplugged(self) -> bool:
        """The module hears nothing and says nothing."""
        ...


class LineModule(Protocol):
    """A module as its line sees it: nine bytes in, nine bytes or nothing out, at the module's own time.

    `at_s` is always module time [s], that of `clock`. A module never waits and never answers with a
    part of a frame: when its bytes come out, and what becomes of them, is the line's.
    """

    @property
    def clock(self) -> ScaledClock:
        """The module's time."""
        ...

    @property
    def faults(self) -> ModuleFaults:
        """What is wrong at present; asked anew for every frame."""
        ...

    @property
    def reply_pause_s(self) -> float:
        """Telegram pause time, global parameter 75 [s]: how long the module waits before it answers."""
        ...

    def receive(self, frame: bytes, at_s: float | None = None) -> bytes | None:
        """Take nine bytes; nine bytes back, or None where none are due: another address, suppressed, 137.

        Without any of `faults`: a silent module answers here, and the line keeps the answer.
        """
        ...

    def unsolicited(self, at_s: float | None = None) -> list[tuple[float, bytes]]:
        """The events that came up until then and were not fetched yet: module time [s] and frame."""
        ...

    def catch_up(self, slice_s: float) -> bool:
        """Live on by at most `slice_s` [s]; True once the module is up to date."""
        ...
