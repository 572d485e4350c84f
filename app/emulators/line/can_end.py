"""A CAN bus as an end of a line: messages of python-can for the modules, theirs for the bus."""

from __future__ import annotations

import contextlib
import socket
import threading
from collections import deque
from typing import Any

from ...errors import LinkDown
from ...links.can_bus import bus_name, open_bus
from .can_message import CanMessage
from .ends import Watch
from .line import Line

SLICE_S = 0.05
"""How long the thread that listens is blind for its end [s]."""
WAITING_MAX = 4096
"""Messages that nobody has taken yet; more are lost, as in a controller whose buffer is full."""
JOIN_S = 2.0


class CanEnd:
    """A bus of `interface` and `channel` at `bitrate` [bit/s].

    Buses of python-can have no descriptor that `select` could watch, not all of them: a thread listens, and wakes the
    line's loop.
    """

    def __init__(self, interface: str, channel: str, bitrate: int) -> None:
        self._interface, self._channel, self._bitrate = interface, channel, bitrate
        self._line: Line | None = None
        self._watch: Watch | None = None
        self._ear: _Ear | None = None

    @property
    def name(self) -> str:
        return bus_name(self._interface, self._channel)

    def plug(self, line: Line, watch: Watch) -> None:
        """Raises OSError where the bus cannot be had."""
        try:
            bus = open_bus(self._interface, self._channel, self._bitrate)
        except LinkDown as error:
            raise OSError(str(error)) from error
        self._line, self._watch, self._ear = line, watch, _Ear(bus)
        line.join(self)
        watch(self._ear.fileno(), self._hear)

    def unplug(self) -> None:
        line, watch, ear = self._line, self._watch, self._ear
        self._line = self._watch = self._ear = None
        if line is not None and watch is not None and ear is not None:
            line.leave(self)
            watch(ear.fileno(), None)
            ear.close()

    def close(self) -> None:
        self.unplug()

    def send(self, data: bytes) -> None:
        """Say what the line delivers. A bus that takes nothing (full, or nobody acknowledges) loses it."""
        if self._ear is not None:
            self._ear.say(CanMessage.unpacked(data))

    def _hear(self, now_s: float) -> None:
        if self._ear is not None and self._line is not None:
            for message in self._ear.take():
                self._line.hear_message(self, message, now_s)


class _Ear:
    """A thread that reads `bus` until `close`."""

    def __init__(self, bus: Any) -> None:
        import can

        self._bus = bus
        self._message = can.Message
        self._heard: deque[CanMessage] = deque(maxlen=WAITING_MAX)
        self._ended = threading.Event()
        self._woken, self._waker = socket.socketpair()
        self._woken.setblocking(False)
        self._waker.setblocking(False)
        self._thread = threading.Thread(target=self._listen, name="can", daemon=True)
        self._thread.start()

    def fileno(self) -> int:
        """What can be read as soon as something was heard."""
        return self._woken.fileno()

    def take(self) -> list[CanMessage]:
        """What was heard since the last time."""
        with contextlib.suppress(BlockingIOError):
            self._woken.recv(WAITING_MAX)
        taken = []
        while self._heard:
            taken.append(self._heard.popleft())
        return taken

    def say(self, message: CanMessage) -> None:
        with contextlib.suppress(Exception):  # whatever an adapter's driver raises: the message is lost
            self._bus.send(
                self._message(arbitration_id=message.identifier, data=message.data, is_extended_id=False), timeout=0.0
            )

    def close(self) -> None:
        self._ended.set()
        self._thread.join(JOIN_S)
        with contextlib.suppress(Exception):  # an adapter that has gone need not close well
            self._bus.shutdown()
        self._woken.close()
        self._waker.close()

    def _listen(self) -> None:
        while not self._ended.is_set():
            try:
                message = self._bus.recv(SLICE_S)
            except Exception:  # the bus has gone, and with it all that could be heard
                return
            if message is None or message.is_extended_id or message.is_error_frame or message.is_remote_frame:
                continue
            self._heard.append(CanMessage(message.arbitration_id, bytes(message.data)))
            with contextlib.suppress(BlockingIOError):  # full: it wakes up anyway
                self._waker.send(b"!")
