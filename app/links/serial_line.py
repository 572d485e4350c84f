"""TMCL modules on a line: `/dev/ttyACM0`, `COM3`, `socket://host:port`, `rfc2217://host:port`, `spy:///dev/ttyUSB0`.

A line is one thing however many modules are on it. Ports of the same URL share it: its thread, its
arbiter, its incidents. It opens at the first question and closes with its last port.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import threading
import time
import weakref
from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeVar, cast

from ..clock import Clock, WallClock
from ..errors import LinkDown
from .arbiter import Arbiter
from .download import Downloads
from .incidents import Incidents
from .line_session import LineSession
from .line_thread import Job, LineThread
from .port import Answer, Batch, PortTraits
from .serial_address import device_of
from .streams import Stream, open_stream
from .tmcl import FRAME_BYTES
from .tmcl_session import TmclSession
from .wire_budget import BITS_PER_BYTE, WireBudget

BAUD = 9600
"""What a module has from the factory (FM-PD42-1241 3.1; global parameter 65)."""
BAUDS = (9600, 14400, 19200, 28800, 38400, 57600, 76800, 115200, 230400, 250000, 500000, 1000000)
"""What global parameter 65 can be set to."""
ADDRESS = 1
CALL_BYTES = 2 * FRAME_BYTES
MODULE_S = 0.005
"""What a module takes to answer [s]."""
RESERVE_S = 0.245
"""For adapters that collect bytes (16 ms), for a busy machine, and for modules told to pause first (GP 75) [s]."""
SOCKET_TIMEOUT_S = 1.0


_T = TypeVar("_T")
_L = TypeVar("_L", bound="Line")
_Listener = TypeVar("_Listener")


def whole_timeout_s(baud: int | None, timeout_s: float | None, call_bytes: int = CALL_BYTES) -> float:
    """How long to wait for an answer in all [s]: question and answer on the wire, and `timeout_s` beyond that.

    None is the module's own time and a reserve; a second over a socket, where the wire takes no time.
    """
    if baud is None:
        return SOCKET_TIMEOUT_S if timeout_s is None else timeout_s
    return call_bytes * BITS_PER_BYTE / baud + (MODULE_S + RESERVE_S if timeout_s is None else timeout_s)


class Line:
    """What the ports of one physical line share. For one event loop."""

    def __init__(self, name: str, open_at: Callable[[int], Stream], device: str = "") -> None:
        self.name = name
        self.device = device
        """The file that it opens; empty where there is none of its own."""
        self.arbiter = Arbiter()
        self.incidents = Incidents()
        self.downloads = Downloads()
        """Which of its TMCL modules are in download mode."""
        self.users: set[LinePort] = set()
        """Ports that have the line open."""
        self.ports: weakref.WeakSet[LinePort] = weakref.WeakSet()
        """All ports there are on it."""
        self._open_at = open_at
        self._thread: LineThread | None = None
        self._before: threading.Thread | None = None
        self._wires: dict[int | None, WireBudget] = {}

    @property
    def baud(self) -> int | None:
        """The baud rate it is open at; None where it is closed, or has none."""
        return next((port.baud for port in self.users), None)

    @property
    def is_open(self) -> bool:
        """Whether a port uses it."""
        return bool(self.users)

    def wire(self, baud: int | None, call_bytes: int) -> WireBudget:
        """The budget at that baud rate, where question and answer have `call_bytes`."""
        return self._wires.setdefault(baud, WireBudget(baud, call_bytes))

    def session(self, stream: Stream, byte_s: float, tell_event: Callable[[bytes], None]) -> LineSession:
        """How the open line is talked over, on its thread; `byte_s` is the time of a byte [s]."""
        return TmclSession(self.name, stream, self.incidents, tell_event, byte_s, self.downloads.stores)

    def put(self, port: LinePort, job: Job) -> None:
        """Raises LinkDown where others have the line open at another baud rate."""
        for other in self.users:
            if other.baud != port.baud:
                raise LinkDown(port.name, f"the line is open at {other.baud} baud for {other.name}; use the same")
        if self._thread is None:
            loop = job.loop
            tell_event = partial(_call, loop, self._tell_event)
            self._thread = LineThread(
                self.name,
                self._open_at,
                lambda stream, baud: self.session(stream, BITS_PER_BYTE / baud if baud else 0.0, tell_event),
                self.incidents,
                partial(_call, loop, self._tell_down),
                after=self._before,
            )
        self.users.add(port)
        self._thread.put(job, port.baud or 0)

    async def leave(self, port: LinePort) -> None:
        """The last one closes the line."""
        self.users.discard(port)
        if not self.users and self._thread is not None:
            thread, self._thread = self._thread, None
            self._before = thread.thread
            await thread.close()
            if self._before is thread.thread and not thread.thread.is_alive():
                self._before = None  # nobody to wait for, and nothing that keeps us alive

    def _tell_event(self, frame: bytes) -> None:
        for port in tuple(self.users):
            port.tell_event(frame)

    def _tell_down(self, error: LinkDown) -> None:
        for port in tuple(self.users):
            port.tell_down(error)


def _call(loop: asyncio.AbstractEventLoop, listener: Callable[[_T], None], what: _T) -> None:
    with contextlib.suppress(RuntimeError):  # the loop has closed
        loop.call_soon_threadsafe(listener, what)


class LinePort:
    """`BatchPort` of one module on a `Line`. `baud` None where there is none; `timeout_s` as in `whole_timeout_s`."""

    call_bytes = CALL_BYTES
    """Of a question and its answer."""

    def __init__(
        self,
        line: Line,
        *,
        address: int = ADDRESS,
        baud: int | None = None,
        timeout_s: float | None = None,
        clock: Clock | None = None,
    ) -> None:
        self.line = line
        self.address = address
        self.baud = baud
        self.timeout_s = whole_timeout_s(baud, timeout_s, self.call_bytes)
        self.arbiter = line.arbiter
        self.incidents = line.incidents
        self.wire = line.wire(baud, self.call_bytes)
        self.traits = PortTraits(batches=self)
        self.batch = Batch()
        self._clock = clock or WallClock()
        self._last_exchange_s = self._clock.now()
        self._event_listeners: list[Callable[[bytes], None]] = []
        self._down_listeners: list[Callable[[LinkDown], None]] = []
        line.ports.add(self)

    @property
    def name(self) -> str:
        return f"{self.line.name}, module {self.address}"

    @property
    def last_exchange_s(self) -> float:
        return self._last_exchange_s

    def device_time_s(self) -> float:
        return self._clock.now()

    async def exchange(self, frame: bytes, timeout_s: float | None = None, answer: Answer = Answer.ALWAYS) -> bytes:
        """Send a frame, return its answer. Raises ValueError for what `check` refuses, else as `FramePort` says."""
        return (await self.exchange_many((frame,), _never, timeout_s, answer))[0]

    async def exchange_many(
        self,
        frames: Sequence[bytes],
        preempted: Callable[[], bool],
        timeout_s: float | None = None,
        answer: Answer = Answer.ALWAYS,
    ) -> list[bytes]:
        """As `BatchPort` says. Raises ValueError for a frame that `check` refuses."""
        self.check(frames)
        job = Job(frames, preempted, self.timeout_s if timeout_s is None else timeout_s, answer)
        self.batch = Batch()
        self.line.put(self, job)
        try:
            await job.done
        except asyncio.CancelledError:
            job.abandoned = True
            raise
        self._take(job)
        error, job.error = job.error, None
        if error is not None:
            try:
                raise error
            finally:
                del error  # else the error holds this frame and the frame the error, and both the line
        return job.replies

    def address_of(self, frame: bytes) -> int:
        """The address of the module that a frame through this port reaches."""
        return frame[0]

    def check(self, frames: Sequence[bytes]) -> None:
        """Raises ValueError for a frame of another length than 9."""
        for frame in frames:
            if len(frame) != FRAME_BYTES:
                raise ValueError(f"a TMCL frame has {FRAME_BYTES} bytes, not {len(frame)}")

    def on_event(self, listener: Callable[[bytes], None]) -> Callable[[], None]:
        """Hear of the module's own frames (position reached: status 128), on the event loop's thread.

        Returns the function that ends it. A listener must not raise.
        """
        return _add(self._event_listeners, listener)

    def on_down(self, listener: Callable[[LinkDown], None]) -> Callable[[], None]:
        """Hear, while nobody asks, that the line has gone (a pulled cable). Otherwise as `on_event`."""
        return _add(self._down_listeners, listener)

    def tell_event(self, frame: bytes) -> None:
        """For the line."""
        if frame[1] == self.address:
            for listener in tuple(self._event_listeners):
                listener(frame)

    def tell_down(self, error: LinkDown) -> None:
        """For the line."""
        for listener in tuple(self._down_listeners):
            listener(error)

    async def aclose(self) -> None:
        await self.line.leave(self)

    def _take(self, job: Job) -> None:
        """From the thread's clock to ours."""
        offset_s = self._clock.now() - time.monotonic()
        started_s = job.started_s
        answered_s = [at_s - started_s for at_s in job.answered_s]
        self.batch = Batch(job.replies, answered_s, started_s + offset_s)
        if answered_s:
            before_s = answered_s[-2] if len(answered_s) > 1 else 0.0
            self._last_exchange_s = started_s + offset_s + (before_s + answered_s[-1]) / 2
            self.wire.count(len(answered_s), job.ended_s - started_s)


def _never() -> bool:
    return False


def _add(listeners: list[_Listener], listener: _Listener) -> Callable[[], None]:
    listeners.append(listener)

    def end() -> None:
        if listener in listeners:
            listeners.remove(listener)

    return end


_lines: weakref.WeakValueDictionary[str, Line] = weakref.WeakValueDictionary()
"""Every line there is, by what it is called. Of the process and not of a bench: so are the ports of a machine."""


def shared_line(name: str, make: Callable[[], _L]) -> _L:
    """The line of that name, which says what kind it is; made if there is none."""
    line = _lines.get(name)
    if line is None:
        line = _lines[name] = make()
    return cast("_L", line)


def line_of(url: str) -> Line:
    """The line behind a device name or a URL of pyserial."""
    name = f"tcp {url.removeprefix(SOCKET)}" if url.startswith(SOCKET) else f"serial {url}"
    return shared_line(name, lambda: Line(name, partial(open_device, name, url), device_of(url)))


SOCKET = "socket://"


def open_device(name: str, url: str, baud: int) -> Stream:
    """Open what `url` names for the line called `name`. Raises LinkDown, also where another line has the same file."""
    device = device_of(url)
    if device:
        real = os.path.realpath(device)
        for other in list(_lines.values()):
            if other.name != name and other.is_open and other.device and os.path.realpath(other.device) == real:
                raise LinkDown(name, f"open already as {other.name}; use one name for all modules on a line")
    return open_stream(name, url, baud or BAUD)


def serial_port(
    url: str,
    *,
    baud: int = BAUD,
    address: int = ADDRESS,
    timeout_s: float | None = None,
    clock: Clock | None = None,
) -> LinePort:
    """A module at `address` on the line behind a device name or a URL of pyserial; `socket://` has no baud rate."""
    return LinePort(
        line_of(url),
        address=address,
        baud=None if url.startswith(SOCKET) else baud,
        timeout_s=timeout_s,
        clock=clock,
    )
