"""The narrow seam to the outside: a frame out, a frame back. Above it the code never knows the wire."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol

from app.clock import ScaledClock


class FramePort(Protocol):
    """One chip at the far end of a wire that answers each frame with a frame."""

    @property
    def name(self) -> str:
        """What people call this link: `emulator`, `tcp 127.0.0.1:4280`."""
        ...

    @property
    def last_exchange_s(self) -> float:
        """When the latest exchange happened, on the clock of `device_time_s` [s]."""
        ...

    def device_time_s(self) -> float:
        """The device's own time [s] where it has one (emulators), else the server's."""
        ...

    async def exchange(self, frame: bytes, timeout_s: float | None = None) -> bytes:
        """Send `frame`, return the reply; `timeout_s` [s] replaces the port's own. One at a time: `LinkQueue`.

        Raises LinkDown, LinkTimeout or BadReply; nothing else, and never retries. A port that is not
        open opens itself.
        """
        ...

    async def aclose(self) -> None:
        """Close; a second call does nothing. The next exchange opens the port again."""
        ...


class Wire(Protocol):
    """What an emulator shows to a port or a server: bytes in, bytes out, at its own clock's time."""

    @property
    def model(self) -> str:
        """The chip's model name, as in the catalog."""
        ...

    @property
    def clock(self) -> ScaledClock:
        """The chip's time; its scale runs the chip faster or slower than the server."""
        ...

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        """Answer one frame at chip time `at_s` [s], by default now; never before the latest time used.

        Raises ValueError for a frame of a wrong length, ConnectionError while unplugged and
        TimeoutError while silent.
        """
        ...


SampleSink = Callable[[float, bytes], None]
"""Takes the chip's time [s] and the joined replies to the frames of one sample."""


class SamplingPort(FramePort, Protocol):
    """A port whose far end can ask itself on a fixed beat, so that samples bear the chip's own time.

    Emulators can, because they catch up in exact ticks: whoever talks to the chip next first gets
    all samples that fell due before. Hardware cannot; there the sampler asks over the wire.
    """

    def start_sampling(self, frames: Sequence[bytes], period_s: float, sink: SampleSink) -> Callable[[], None]:
        """Ask `frames` every `period_s` [s] of server time; returns the function that ends it."""
        ...

    def run_due_samples(self) -> None:
        """Take every sample that is due by now. Called on a timer by the sampler.

        Raises LinkDown or LinkTimeout where the far end did not answer: samples due then are lost.
        """
        ...
