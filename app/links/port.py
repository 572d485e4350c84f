"""The narrow seam to the outside: a frame out, a frame back. Above it the code never knows the wire."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Protocol

from ..clock import ScaledClock
from ..errors import BenchError, LinkDown
from .arbiter import Arbiter
from .incidents import Incidents
from .wire_budget import WireBudget


class Answer(Enum):
    """Whether a question is answered at all."""

    ALWAYS = "always"
    MAYBE = "maybe"
    """A reset: the module may be gone before it has answered. No answer is no error."""
    NEVER = "never"


class FramePort(Protocol):
    """One chip behind a wire that answers each frame with a frame."""

    @property
    def name(self) -> str:
        """What people call this link: `emulator`, `tcp 127.0.0.1:4280`."""
        ...

    @property
    def last_exchange_s(self) -> float:
        """When the latest exchange happened, on the clock of `device_time_s` [s]."""
        ...

    @property
    def traits(self) -> PortTraits:
        """What this port can besides."""
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


@dataclass(frozen=True, slots=True)
class PortTraits:
    """What a port can besides exchanging frames: itself, typed so, or None where it cannot.

    chains : the replies of its chip belong to the frame before. batches : many exchanges on a thread of its own.
    sampling : its device samples itself on its own time. arbitrates : whoever speaks unasked disturbs nobody (CAN)
    way : it knows without a frame whether the way to its chip is open
    cuts : a datagram of 40 bits may end after its first byte, whose answer is the chip's status (DS-TMC4361 5.2)
    """

    chains: ChainPort | None = None
    batches: BatchPort | None = None
    sampling: SamplingPort | None = None
    arbitrates: bool = False
    way: WayPort | None = None
    cuts: bool = False


class WayPort(FramePort, Protocol):
    """A port that knows without a frame whether the way to its chip is open, for chips that obey every frame."""

    async def require_way(self) -> None:
        """Raises LinkDown where it is not."""
        ...


class ChainPort(FramePort, Protocol):
    """A port of a chip whose replies belong to the frame before: what is asked in a row must stay in a row."""

    async def exchange_chain(self, frames: Sequence[bytes], timeout_s: float | None = None) -> list[bytes]:
        """Send the frames one after another and return their replies; nobody else's frame comes between.

        Raises what `exchange` raises; then none of the replies counts, and any of the frames may have arrived.
        """
        ...


@dataclass(slots=True)
class Batch:
    """What became of the frames of one call of `exchange_many`, also where it failed."""

    replies: list[bytes] = field(default_factory=list)
    """Answers so far, in order."""
    answered_s: list[float] = field(default_factory=list)
    """When each of them was there, in seconds since `started_s`."""
    started_s: float = 0.0
    """When the first frame went out, on the clock of `device_time_s` [s]."""


class BatchPort(FramePort, Protocol):
    """A port that makes many exchanges in a row on its own thread: no event loop between two frames."""

    @property
    def arbiter(self) -> Arbiter:
        """Who is next on the line; the same for all ports on one line."""
        ...

    @property
    def wire(self) -> WireBudget:
        """What the line can carry and does carry."""
        ...

    @property
    def incidents(self) -> Incidents:
        """What went wrong on the line."""
        ...

    @property
    def batch(self) -> Batch:
        """The latest `exchange_many`, for the log: set before the call returns or raises."""
        ...

    async def exchange_many(
        self,
        frames: Sequence[bytes],
        preempted: Callable[[], bool],
        timeout_s: float | None = None,
        answer: Answer = Answer.ALWAYS,
    ) -> list[bytes]:
        """Send the frames one after another, return the replies; `timeout_s` [s] is for each.

        `preempted` is called on another thread before each frame but the first. As soon as it says so
        the replies so far are returned: fewer than asked, none where the line had to be put in step
        before the first frame. An unanswered frame that need not be answered gives b"".

        Raises what `exchange` raises; then none of the replies counts.
        """
        ...

    def on_down(self, listener: Callable[[LinkDown], None]) -> Callable[[], None]:
        """Hear, on the event loop's thread, that the line went away while nobody asked anything.

        Returns the function that ends it. A listener must not raise.
        """
        ...

    def on_event(self, listener: Callable[[bytes], None]) -> Callable[[], None]:
        """Hear of frames that the device sends unasked (position reached), on the event loop's thread.

        Returns the function that ends it. A listener must not raise.
        """
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
    """A port whose device can sample itself on a fixed beat, so that samples bear the chip's own time.

    Emulators can, because they catch up in exact ticks: whoever talks to the chip next first gets
    all samples that fell due before. Hardware cannot; there the sampler asks over the wire.
    """

    @property
    def time_scale(self) -> float:
        """How fast the device's time runs against the server's."""
        ...

    paused: BenchError | None
    """While there is one, no sample is taken, and `run_due_samples` raises it."""

    def start_sampling(self, frames: Sequence[bytes], period_s: float, sink: SampleSink) -> Callable[[], None]:
        """Ask `frames` every `period_s` [s] of server time; returns the function that ends it."""
        ...

    def run_due_samples(self) -> None:
        """Take every sample that is due by now. Called on a timer by the sampler.

        Raises LinkDown or LinkTimeout where the device did not answer: samples due then are lost.
        """
        ...
