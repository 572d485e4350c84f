"""TMCL over CAN, through python-can: seven bytes in a message instead of nine on a wire.

On the bus a question has the module's receive identifier and seven bytes: command, type, motor, value.
An answer has the module's send identifier and seven bytes: the module's address, status, command, value. The bus
has its own check of bits, so there is no checksum; here both get the two missing bytes back, and
everything above knows nine-byte frames only. The version as a string needs all eight bytes of a
message, and is asked for with eight; a command of the program memory comes back as its seven.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..clock import Clock
from ..errors import LinkDown, UsageError
from ..registers.tmcl.commands import Opcode
from .can_bus import bus_name, check_bus, open_bus, require_python_can
from .line_thread import Job
from .port import Answer
from .serial_line import Line, LinePort, shared_line
from .streams import Closing, Stream
from .tmcl import FRAME_BYTES, checksum, has_plain_reply

HOST = 2
"""What stands where a serial answer has the host's address; CAN has none."""
PLAIN_BYTES = 7
SLICE_S = 0.05
SEND_TIMEOUT_S = 0.5
TIMEOUT_S = 0.1
"""Wait for an answer [s]. A message takes a millisecond at 125 kbit/s, a module some more."""


@dataclass(frozen=True, slots=True)
class Route:
    """Identifiers of one module: where it listens, and how it answers."""

    send_id: int
    receive_id: int


class CanStream:
    """`Stream` of nine-byte frames over a CAN bus; `routes` tells the identifiers by module address."""

    def __init__(self, bus: Any, message: Any, routes: Callable[[], dict[int, Route]]) -> None:
        self._bus = bus
        self._message = message
        self._routes = routes
        self._closing = False
        self._special: int | None = None
        """The command asked last, where its answer has neither status nor command: 134, 136 type 0."""

    @property
    def fd(self) -> int | None:
        return None

    def clear(self) -> bool:
        return False  # looking is reading, which keeps what it finds

    def send(self, data: bytes) -> None:
        self.write(data)

    def write(self, data: bytes) -> None:
        route = self._routes().get(data[0])
        if route is None:
            return  # nobody has that address, so nobody will answer
        self._special = None if has_plain_reply(data) else data[1]
        body = data[1:8] + (b"\0" if self._special == Opcode.GET_VERSION else b"")
        try:
            self._bus.send(
                self._message(arbitration_id=route.send_id, data=body, is_extended_id=False), timeout=SEND_TIMEOUT_S
            )
        except Exception as error:  # CanError, and whatever the driver of an adapter raises
            raise ConnectionError(f"the bus takes nothing: {error}") from error

    def read(self, timeout_s: float) -> bytes:
        until_s = time.monotonic() + timeout_s
        while True:
            left_s = until_s - time.monotonic()
            try:
                message = self._bus.recv(min(max(0.0, left_s), SLICE_S))
            except Exception as error:
                raise ConnectionError(f"the bus has gone: {error}") from error
            frame = b"" if message is None else self._frame(message)
            if frame or (left_s <= 0 and (message is None or left_s < -SLICE_S)):  # others may never stop talking
                return frame
            if self._closing:
                raise Closing("closed")

    def _frame(self, message: Any) -> bytes:
        """Nine bytes; b"" for what no module of ours said: others may use the bus."""
        data = bytes(message.data)
        if message.is_extended_id or message.is_error_frame or message.is_remote_frame:
            return b""
        for address, route in self._routes().items():
            if message.arbitration_id != route.receive_id:
                continue
            plain = len(data) == PLAIN_BYTES and data[0] == route.send_id & 0xFF
            # An error has the usual form, and names the command where a stored command has its motor.
            usual = plain and data[2] in (self._special, Opcode.REQUEST_EVENT)
            if self._special is not None and not usual and len(data) in (PLAIN_BYTES, PLAIN_BYTES + 1):
                return bytes((HOST,)) + data.ljust(8)
            if plain:
                body = bytes((HOST, address)) + data[1:]
                return body + bytes((checksum(body),))
        return b""

    def abort(self) -> None:
        self._closing = True

    def close(self) -> None:
        with contextlib.suppress(Exception):  # an adapter that has gone need not close well
            self._bus.shutdown()


class CanLine(Line):
    """One bus of python-can."""

    def __init__(self, interface: str, channel: str, bitrate: int) -> None:
        self.interface, self.channel, self.bitrate = interface, channel, bitrate
        self.routes: dict[int, Route] = {}
        """By address, of the modules in use; replaced and never changed, for the thread looks at it."""
        super().__init__(bus_name(interface, channel), self._open)

    def put(self, port: LinePort, job: Job) -> None:
        """Raises LinkDown where two modules cannot be told apart."""
        if isinstance(port, CanPort) and self.routes.get(port.address) != port.route:
            routes = {other.address: other.route for other in self.users if isinstance(other, CanPort)}
            other = routes.setdefault(port.address, port.route)
            if other != port.route:
                raise LinkDown(port.name, f"a module with send_id {other.send_id} cannot be told from this one")
            self.routes = routes
        super().put(port, job)

    def _open(self, _: int) -> Stream:
        bus = open_bus(self.interface, self.channel, self.bitrate)
        import can

        return CanStream(bus, can.Message, lambda: self.routes)


class CanPort(LinePort):
    """One module on a bus. Its identifiers say who is meant: frames may bear any address, and so do the answers."""

    def __init__(self, line: CanLine, route: Route, timeout_s: float | None, clock: Clock | None) -> None:
        super().__init__(line, address=route.send_id & 0xFF, timeout_s=timeout_s or TIMEOUT_S, clock=clock)
        self.route = route
        self.traits = replace(self.traits, arbitrates=True)

    @property
    def name(self) -> str:
        return f"{self.line.name}, module {self.route.send_id}"

    def address_of(self, frame: bytes) -> int:
        del frame
        return self.address

    async def exchange_many(
        self,
        frames: Sequence[bytes],
        preempted: Callable[[], bool],
        timeout_s: float | None = None,
        answer: Answer = Answer.ALWAYS,
    ) -> list[bytes]:
        """As `BatchPort` says. Raises ValueError for a frame of another length than 9."""
        own = [_readdressed(frame, 0, self.address) for frame in frames]
        replies = await super().exchange_many(own, preempted, timeout_s, answer)
        return [
            _readdressed(reply, 1, frame[0]) if reply and has_plain_reply(frame) else reply
            for frame, reply in zip(frames, replies, strict=False)
        ]


def _readdressed(frame: bytes, at: int, address: int) -> bytes:
    if len(frame) != FRAME_BYTES or frame[at] == address:
        return frame
    body = frame[:at] + bytes((address,)) + frame[at + 1 : 8]
    return body + bytes((checksum(body),))


def can_port(
    interface: str,
    channel: str,
    *,
    bitrate: int,
    send_id: int,
    receive_id: int,
    timeout_s: float | None = None,
    clock: Clock | None = None,
) -> CanPort:
    """A module on a bus of python-can, not yet open.

    Raises UsageError where python-can is not installed, and for an interface or a channel that cannot be.
    """
    require_python_can()
    check_bus(interface, channel)
    line = shared_line(bus_name(interface, channel), lambda: CanLine(interface, channel, bitrate))
    if line.bitrate != bitrate and not line.is_open:
        line.bitrate = bitrate
    if line.bitrate != bitrate:
        raise UsageError(f"{line.name} is open at {line.bitrate} bit/s; all modules on a bus use the same")
    return CanPort(line, Route(send_id, receive_id), timeout_s, clock)
