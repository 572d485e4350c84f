"""The loop that keeps a line's time: reads clients, lets bytes out when they are due, lets modules live on.

One thread, and nothing else touches the line: other threads (the control port) come in by `call`.
"""

from __future__ import annotations

import contextlib
import ctypes
import select
import socket
import sys
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import Future
from types import TracebackType
from typing import Self, TypeVar, cast

from .ends import Client, End
from .line import Line

Result = TypeVar("Result")

KEEP_UP_EVERY_S = 0.02
"""How often the modules live on while nobody asks [s]: often and a little, so that no question waits long."""
KEEP_UP_SLICE_S = 0.05
"""Module time that is computed in one go [s]."""
PUNCTUAL_S = 200e-6
"""How long before bytes are due the loop stops sleeping and looks at the clock instead [s]: a sleeper is late by
about as much, in a virtual machine more than on a bare one."""
_PR_SET_TIMERSLACK = 29


class LineServer:
    """`with LineServer(line, [PtyEnd(path)]) as server: server.run()` serves until `stop` is called.

    Entering plugs the ends in and raises OSError where that is not possible; leaving removes them.
    """

    def __init__(self, line: Line, ends: Iterable[End]) -> None:
        self.line = line
        self.ends = tuple(ends)
        self._readers: dict[int, Callable[[float], None]] = {}
        self._calls: deque[Callable[[], None]] = deque()
        self._stopping = False
        self._plugged = False
        self._woken, self._waker = socket.socketpair()
        self._woken.setblocking(False)
        self._waker.setblocking(False)

    def __enter__(self) -> Self:
        self._watch(self._woken.fileno(), self._wake_up)
        try:
            self._follow_the_plug()
        except OSError:
            self.close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Remove the ends. Clients see the port go."""
        for end in self.ends:
            end.close()
        self._readers.clear()
        self._woken.close()
        self._waker.close()

    # --- from other threads and signal handlers -----------------------------------------------------

    def stop(self) -> None:
        """Let `run` return soon; may be called from a signal handler."""
        self._stopping = True
        self._wake()

    def call(self, function: Callable[[], Result], timeout_s: float = 10.0) -> Result:
        """Run `function` between two frames, in the thread of `run`; its result or its error comes back here."""
        future: Future[Result] = Future()

        def run() -> None:
            try:
                result = function()
                self._follow_the_plug()
            except Exception as error:
                future.set_exception(error)  # raised again where it was asked for
            else:
                future.set_result(result)

        self._calls.append(run)
        self._wake()
        return future.result(timeout_s)

    def _wake(self) -> None:
        with contextlib.suppress(BlockingIOError):  # full: it wakes up anyway
            self._waker.send(b"!")

    # --- the loop -----------------------------------------------------------------------------------

    def run(self) -> None:
        """Serve until `stop`."""
        _sleep_exactly()
        line, now, readers = self.line, self.line.clock.now, self._readers
        keep_up_s = now()
        while not self._stopping:
            due_s = line.next_due_s()
            now_s = now()
            wait_s = keep_up_s - now_s
            if due_s is not None and (until_due_s := due_s - now_s) < wait_s:
                # Within the last moment it looks again and again: so a reply is late by microseconds only.
                wait_s = until_due_s - PUNCTUAL_S
            # Not epoll: it waits in whole milliseconds, and a nine-byte frame at 115,200 baud takes 0.8 of one. Nor
            # SelectSelector, which is this call and eight microseconds of its own.
            ready = select.select(readers, (), (), max(wait_s, 0.0))[0]
            now_s = now()
            for descriptor in ready:
                if reader := readers.get(descriptor):  # else the one before has closed it
                    reader(now_s)
            for _, client, data in line.collect(now_s):
                cast("Client", client).send(data)
            if now_s >= keep_up_s:
                # While questions come, they keep the modules up to date themselves; still each gets its turn.
                keep_up_s = now() + (KEEP_UP_EVERY_S if line.keep_up(KEEP_UP_SLICE_S) else 0.0)

    def _watch(self, descriptor: int, reader: Callable[[float], None] | None) -> None:
        if reader is None:
            self._readers.pop(descriptor, None)
        else:
            self._readers[descriptor] = reader

    def _wake_up(self, now_s: float) -> None:
        del now_s
        with contextlib.suppress(BlockingIOError):
            self._woken.recv(4096)
        while self._calls:
            self._calls.popleft()()

    def _follow_the_plug(self) -> None:
        """Ends are there while the line is plugged, and only then. Raises OSError where one cannot be."""
        if self.line.plugged and not self._plugged:
            for end in self.ends:
                end.plug(self.line, self._watch)
            self._plugged = True
        elif self._plugged and not self.line.plugged:
            for end in self.ends:
                end.unplug()
            self.line.unplug()
            self._plugged = False


def _sleep_exactly() -> None:
    """Ask Linux to end this thread's sleeps on time; by default it may add 50 us to each, to save power."""
    if sys.platform == "linux":
        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(_PR_SET_TIMERSLACK, 1, 0, 0, 0)
