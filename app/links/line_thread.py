"""The thread of one open line: it opens the stream, does what it is asked, and listens in between.

It ends when it is told to, at the latest after a moment even where a device blocks; then it is left
behind as a daemon and gives the descriptor back when the device lets go of it.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import select
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence

from ..errors import LinkDown, LinkError
from .incidents import Incidents
from .line_session import LineSession
from .port import Answer
from .streams import Stream

JOIN_S = 1.0
"""How long closing waits for a thread whose device blocks [s]."""
LISTEN_S = 0.02
"""How often a line without a descriptor is listened to while nobody asks [s]."""
HAS_POLL = hasattr(select, "poll")


class Job:
    """Frames to ask in a row, and what came of it. Filled by the thread, read on the loop when `done` is."""

    __slots__ = (
        "abandoned",
        "answer",
        "answered_s",
        "done",
        "ended_s",
        "error",
        "frames",
        "loop",
        "preempted",
        "replies",
        "started_s",
        "timeout_s",
    )

    def __init__(
        self, frames: Sequence[bytes], preempted: Callable[[], bool], timeout_s: float, answer: Answer
    ) -> None:
        self.frames = frames
        self.preempted = preempted
        self.timeout_s = timeout_s
        self.answer = answer
        self.loop = asyncio.get_running_loop()
        self.done: asyncio.Future[None] = self.loop.create_future()
        self.abandoned = False
        """Nobody waits for it any more: it ends after the frame on the wire."""
        self.replies: list[bytes] = []
        self.answered_s: list[float] = []
        self.started_s = 0.0
        self.ended_s = 0.0
        self.error: LinkError | None = None

    def must_end(self) -> bool:
        return self.abandoned or self.preempted()

    def tell(self) -> None:
        with contextlib.suppress(RuntimeError):  # the loop has closed: nobody is there to hear
            self.loop.call_soon_threadsafe(self._set_done)

    def _set_done(self) -> None:
        if not self.done.done():
            self.done.set_result(None)


class _Bell:
    """Wakes the thread, from any other. A pipe where the thread can wait for it and the line at once."""

    def __init__(self) -> None:
        self.fd: int | None = None
        self._write_fd = -1
        self._event = threading.Event()
        if HAS_POLL:
            self.fd, self._write_fd = os.pipe()
            os.set_blocking(self.fd, False)
            os.set_blocking(self._write_fd, False)

    def ring(self) -> None:
        if self.fd is None:
            self._event.set()
        else:
            with contextlib.suppress(BlockingIOError):  # full: it rings already
                os.write(self._write_fd, b"!")

    def quiet(self) -> None:
        self._event.clear()
        if self.fd is not None:
            with contextlib.suppress(BlockingIOError):
                os.read(self.fd, 1024)

    def wait(self, timeout_s: float | None) -> None:
        if self.fd is None:
            self._event.wait(timeout_s)
        else:
            select.select([self.fd], [], [], timeout_s)

    def close(self) -> None:
        if self.fd is not None:
            os.close(self.fd)
            os.close(self._write_fd)


class LineThread:
    """`open_stream` opens the line at a baud rate, `begin_session` begins to talk over it at that rate.

    `tell_down` is called on this thread.
    """

    def __init__(
        self,
        name: str,
        open_stream: Callable[[int], Stream],
        begin_session: Callable[[Stream, int], LineSession],
        incidents: Incidents,
        tell_down: Callable[[LinkDown], None],
        after: threading.Thread | None = None,
    ) -> None:
        self._name = name
        self._open_stream = open_stream
        self._begin_session = begin_session
        self._incidents = incidents
        self._tell_down = tell_down
        self._after = after
        """Who had the line before us; it may still hold the lock on the device."""
        self._bell = _Bell()
        self._lock = threading.Lock()
        self._jobs: deque[tuple[Job, int]] = deque()
        self._closing = False
        self._ended = False
        self._stream: Stream | None = None
        self._session: LineSession | None = None
        self._baud = 0
        self._refused = ""
        self.thread = threading.Thread(target=self._run, name=f"line {name}", daemon=True)
        self.thread.start()

    # --- from the loop --------------------------------------------------------------------------

    def put(self, job: Job, baud: int) -> None:
        """Do `job` when the line is at `baud`; opens or reopens it. Raises LinkDown after `close`."""
        with self._lock:
            if self._closing or self._ended:
                raise LinkDown(self._name, "is being closed")
            self._jobs.append((job, baud))
            self._bell.ring()

    def begin_close(self) -> None:
        """End the thread as soon as the device lets it."""
        with self._lock:
            if not self._closing:
                self._closing = True
                if self._stream is not None:
                    self._stream.abort()
                if not self._ended:
                    self._bell.ring()

    async def close(self) -> None:
        """End the thread, waiting at most `JOIN_S` for it."""
        self.begin_close()
        until_s = time.monotonic() + JOIN_S
        pause_s = 0.0005
        # Short sleeps and no thread of an executor: that one would outlive us.
        while self.thread.is_alive() and time.monotonic() < until_s:
            await asyncio.sleep(pause_s)
            pause_s = min(2 * pause_s, 0.02)

    # --- the thread -----------------------------------------------------------------------------

    def _run(self) -> None:
        if self._after is not None:
            self._after.join(JOIN_S)
            self._after = None
        try:
            while not self._closing:
                try:
                    job, baud = self._jobs.popleft()
                except IndexError:
                    self._listen()
                else:
                    self._work(job, baud)
        finally:
            self._drop()
            with self._lock:
                self._ended = True
                self._bell.close()
            for job, _ in self._jobs:
                job.error = LinkDown(self._name, "closed")
                job.tell()

    def _work(self, job: Job, baud: int) -> None:
        if job.abandoned:
            return
        job.started_s = time.monotonic()
        try:
            session = self._session
            if session is None or baud != self._baud:
                session = self._open(baud)
                job.started_s = time.monotonic()
            session.ask_all(job.frames, job.must_end, job.timeout_s, job.answer, job.replies, job.answered_s)
        except LinkError as error:
            job.error = error
        except (
            Exception
        ) as error:  # OSError, termios.error, and what drivers of adapters raise: nobody may wait for ever
            job.error = self._went_down(error)
        job.ended_s = time.monotonic()
        job.tell()

    def _open(self, baud: int) -> LineSession:
        self._drop()
        try:
            stream = self._open_stream(baud)
        except LinkDown as error:
            if str(error) != self._refused:  # once is enough: it is tried again every second
                self._refused = str(error)
                self._incidents.add("down", str(error))
            raise
        with self._lock:
            if self._closing:
                stream.abort()
        self._refused = ""
        self._incidents.add("opened", f"{self._name} at {baud} baud" if baud else self._name)
        self._baud = baud
        self._stream = stream
        self._session = self._begin_session(stream, baud)
        self._session.wanted = lambda: bool(self._jobs)
        return self._session

    def _went_down(self, error: Exception) -> LinkDown:
        self._drop()
        down = LinkDown(self._name, getattr(error, "strerror", None) or str(error) or type(error).__name__)
        if not self._closing:
            self._incidents.add("down", str(down))
        return down

    def _drop(self) -> None:
        stream, self._stream, self._session = self._stream, None, None
        if stream is not None:
            stream.close()

    def _listen(self) -> None:
        """Until something is to be done: positions reached and other people's bytes come unasked, and a cable goes."""
        stream, session, bell = self._stream, self._session, self._bell
        if stream is None or session is None:
            bell.wait(None)
            bell.quiet()
            return
        wait_s = session.silence_s if session.hears_half else None
        try:
            if bell.fd is not None and stream.fd is not None:
                poll = select.poll()
                poll.register(bell.fd, select.POLLIN)
                poll.register(stream.fd, select.POLLIN)
                ready = [fd for fd, _ in poll.poll(None if wait_s is None else wait_s * 1000)]
                if bell.fd in ready:
                    bell.quiet()
                if stream.fd in ready:
                    session.hear(stream.read(0))
                elif not ready:
                    session.hear(b"")
            else:
                bell.wait(wait_s or LISTEN_S)
                bell.quiet()
                data = stream.read(0)
                if data or session.hears_half:
                    session.hear(data)
        except LinkError:
            return  # noted as an incident; nobody waits for an answer
        except Exception as error:
            down = self._went_down(error)
            if not self._closing:
                self._tell_down(down)
