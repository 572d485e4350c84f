"""Hard limits on the connections of an HTTP server, so that strangers cannot keep a stop from getting through.

uvicorn waits for a head for ever, keeps one of any length, and accepts until there are no descriptors. Here every
connection has a deadline until its request is whole, and a size; an address has a share of the connections, and when
that is used up, the one of its connections that has waited longest without a request makes room. What is in use is not
cut off for a newcomer: past the share a newcomer may still stop motors, over descriptors that are kept for that.
Bodies that come in many pieces are read one piece at a time, with a pause for everybody else behind each, and so is
whatever comes over WebSockets.
"""

from __future__ import annotations

import asyncio
import contextlib
import errno
import logging
import os
import socket
import sys
import time
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

if sys.platform != "win32":
    import resource

from uvicorn.protocols.http.flow_control import FlowControl
from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

log = logging.getLogger("stepscope.connections")

HEAD_BYTES_MAX = 64 * 1024
"""The longest head of a request, its address included [bytes]."""
HEAD_WITHIN_S = 10.0
"""How long a connection may take until the head of its first request is there, TLS included [s]."""
BODY_WITHIN_S = 30.0
"""How long a body may take [s]."""
UNREAD_BYTES_MAX = 1 << 20
"""How much of a body, or of a message, is thrown away behind an answer that did not need it [bytes]."""
GOODBYE_S = 1.0
"""How long a WebSocket whose message was refused stays open for its client to hear why [s]."""
PIECE_BYTES = 64 * 1024
"""The most that is read of a connection at once [bytes]. asyncio would take 256 KiB."""
MESSAGES_BYTES = 1024
"""The most that is read of a WebSocket at once [bytes]: a message of 7 bytes takes 10 us, 64 KiB of them 0.1 s."""
MESSAGE_BYTES_MAX = 64 * 1024
"""The longest message over a WebSocket [bytes]; ours are far shorter."""
PIECE_EVERY_S = 5e-3
"""How long after one connection another reads the next piece of a long body [s]: 13 MB/s, all of them together."""
PIECES_FREE = 2
"""Pieces that a request has before it waits for its turn: a head, and the short body that follows it by itself."""
UNTAKEN_S = 30.0
"""How long a client may take nothing of its answer [s]."""
CONNECTIONS_MAX = 4096
DESCRIPTORS_KEPT = 256
"""For links, files and the database."""
STOPS_KEPT = 32
"""Connections beyond all limits, which may stop motors and nothing else."""
SHARE = 0.75
"""Of all connections, how many one address may have."""
BURST = 16
"""Connections accepted in a row, before those that are there are served."""
POLL_PERIOD_S = 0.5
DESCRIPTORS_WANTED = 65_536


@dataclass(frozen=True, slots=True)
class Limits:
    """Connections at once, in all and of one address."""

    total: int
    of_address: int

    @classmethod
    def of_descriptors(cls, descriptors: int) -> Limits:
        """For a process that may have that many."""
        total = min(CONNECTIONS_MAX, max(STOPS_KEPT, descriptors - DESCRIPTORS_KEPT - STOPS_KEPT))
        return cls(total, max(1, round(total * SHARE)))


def descriptor_limit() -> int:
    """How many descriptors this process may have."""
    if sys.platform == "win32":
        return DESCRIPTORS_WANTED
    soft = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
    return DESCRIPTORS_WANTED if soft == resource.RLIM_INFINITY else soft


def raise_descriptor_limit() -> None:
    """Let this process have as many descriptors as its user may give it."""
    if sys.platform == "win32":
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = DESCRIPTORS_WANTED if hard == resource.RLIM_INFINITY else min(hard, DESCRIPTORS_WANTED)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        with contextlib.suppress(OSError, ValueError):
            resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))


class Connection(socket.socket):
    """An accepted one. `due_s` is when it is closed unless something happens first; None while it is in use."""

    door: Door | None = None
    address = ""
    due_s: float | None = None
    only_stops = False
    piece_bytes = PIECE_BYTES

    def recv(self, size: int, flags: int = 0, /) -> bytes:
        return super().recv(min(size, self.piece_bytes), flags)

    def recv_into(self, buffer: Any, size: int = 0, flags: int = 0, /) -> int:  # as TLS does
        return super().recv_into(buffer, min(size or len(buffer), self.piece_bytes), flags)

    def end(self) -> None:
        """Have it closed by whoever serves it, which sees the end of what it reads."""
        self.due_s = None
        with contextlib.suppress(OSError):  # gone already
            self.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        door, self.door = self.door, None
        if door is not None:
            door.forget(self)
        super().close()


class Flow(FlowControl):
    """uvicorn's, which reads on only when it is its turn, too."""

    _wanted = True
    _its_turn = True

    def pause_reading(self) -> None:
        self._wanted = False
        super().pause_reading()

    def resume_reading(self) -> None:
        self._wanted = True
        if self._its_turn:
            super().resume_reading()

    def hold(self) -> None:
        """Read nothing until `release`."""
        self._its_turn = False
        super().pause_reading()

    def release(self) -> bool:
        """It is its turn; False where it is closed."""
        self._its_turn = True
        if self._wanted:
            super().resume_reading()
        return not self._transport.is_closing()


class Door:
    """Every connection of one server. For one event loop."""

    def __init__(self, limits: Limits, now: Callable[[], float] = time.monotonic) -> None:
        self.limits = limits
        self.refused = 0
        """Connections that were ended for others, or for taking too long."""
        self._now = now
        self._open: dict[int, Connection] = {}
        """By descriptor, the oldest first."""
        self._of_address: Counter[str] = Counter()
        self._polling = False
        self._held: dict[str, deque[Callable[[], bool]]] = {}
        """By address, in the order in which they have their turns."""

    def __len__(self) -> int:
        return len(self._open)

    def connection(self, descriptor: int) -> Connection | None:
        """The open one with that descriptor."""
        return self._open.get(descriptor)

    def enter(self, connection: Connection, address: str) -> bool:
        """Take it in; False where there is no room, not even for a stop."""
        full = self._of_address[address] >= self.limits.of_address
        if full or len(self._open) >= self.limits.total:
            waiting = (each for each in self._open.values() if each.due_s is not None)
            oldest = next((each for each in waiting if not full or each.address == address), None)
            if oldest is not None:
                self._end(oldest)
            elif len(self._open) >= self.limits.total + STOPS_KEPT:
                return False
            connection.only_stops = oldest is None or oldest.only_stops
        connection.door, connection.address = self, address
        self._open[connection.fileno()] = connection
        self._of_address[address] += 1
        self.within(connection, HEAD_WITHIN_S)
        return True

    def forget(self, connection: Connection) -> None:
        """It is being closed."""
        if self._open.pop(connection.fileno(), None) is not None:
            self._of_address[connection.address] -= 1
            if not self._of_address[connection.address]:
                del self._of_address[connection.address]

    def within(self, connection: Connection, seconds: float) -> None:
        """From now on it has that long [s]."""
        connection.due_s = self._now() + seconds
        if not self._polling:
            self._polling = True
            asyncio.get_running_loop().call_later(POLL_PERIOD_S, self._poll)

    def hold(self, address: str, release: Callable[[], bool]) -> None:
        """Call it behind a pause, and behind one of each other address; it says False where it needed no turn."""
        if not self._held:
            asyncio.get_running_loop().call_later(PIECE_EVERY_S, self._release)
        self._held.setdefault(address, deque()).append(release)

    def _release(self) -> None:
        took_turn = False
        while self._held and not took_turn:
            address = next(iter(self._held))
            waiting = self._held.pop(address)
            took_turn = waiting.popleft()()
            if waiting:
                self._held[address] = waiting  # behind all others
        if self._held:
            asyncio.get_running_loop().call_later(PIECE_EVERY_S, self._release)

    def _poll(self) -> None:
        now_s = self._now()
        for connection in list(self._open.values()):
            if connection.due_s is not None and connection.due_s <= now_s:
                self._end(connection)
        self._polling = bool(self._open)
        if self._polling:
            asyncio.get_running_loop().call_later(POLL_PERIOD_S, self._poll)

    def _end(self, connection: Connection) -> None:
        self.refused += 1
        if self.refused & self.refused - 1 == 0:  # 1, 2, 4, 8 ...: told, and no flood of lines
            log.warning("%d connections were ended: no request came in time, or too many at once", self.refused)
        connection.end()


class Listener(socket.socket):
    """A listening socket that takes in what its door lets in."""

    door: Door
    _in_a_row = 0

    @classmethod
    def over(cls, listener: socket.socket, door: Door) -> Listener:
        """Another descriptor of the same socket."""
        self = cls(listener.family, listener.type, listener.proto, os.dup(listener.fileno()))
        self.setblocking(False)
        self.door = door
        return self

    def accept(self) -> tuple[socket.socket, Any]:
        """Raises BlockingIOError when enough have come in a row, and where one was sent away: asyncio comes back."""
        if self._in_a_row == 0:
            asyncio.get_running_loop().call_soon(self._next_turn)
        self._in_a_row += 1
        if self._in_a_row > BURST:
            raise BlockingIOError(errno.EAGAIN, "the others first")
        descriptor, address = self._accept()  # type: ignore[attr-defined]  # as socket.accept does
        connection = Connection(self.family, self.type, self.proto, fileno=descriptor)
        if not self.door.enter(connection, str(address[0]) if isinstance(address, tuple) else ""):
            connection.close()
            raise BlockingIOError(errno.EAGAIN, "there is no room")
        return connection, address

    def _next_turn(self) -> None:
        self._in_a_row = 0


class LimitedHttp(HttpToolsProtocol):
    """uvicorn's HTTP with limits on size and time. `door` and `is_stop` are those of a subclass: `limited_http`."""

    door: Door
    is_stop: Callable[[str, str], bool]

    flow: Flow
    _connection: Connection | None = None
    _head_bytes = 0
    _in_head = True
    _in_body = False
    _unread_bytes = 0
    _pieces = 0
    """Of the request that comes, without those that ended a request before it."""
    _untaken: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # as in uvicorn's
        super().connection_made(transport)
        self.flow = Flow(transport)
        sock = transport.get_extra_info("socket")
        self._connection = None if sock is None else self.door.connection(sock.fileno())

    def connection_lost(self, exc: Exception | None) -> None:
        super().connection_lost(exc)
        self.resume_writing()

    def data_received(self, data: bytes) -> None:
        if self._in_head:
            self._head_bytes += len(data)
        elif self._in_body and self.cycle is not None and self.cycle.response_complete:
            self._unread_bytes += len(data)
            if self._unread_bytes > UNREAD_BYTES_MAX:
                self.transport.abort()
                return
        super().data_received(data)
        self._pieces += 1
        if self._in_body and self._pieces > PIECES_FREE and not self.transport.is_closing():
            self.flow.hold()
            self.door.hold("" if self.client is None else self.client[0], self.flow.release)
        if self._in_head and self._head_bytes > HEAD_BYTES_MAX and not self.transport.is_closing():
            self._refuse(431, b"the head of a request has at most %d bytes" % HEAD_BYTES_MAX)

    def on_message_begin(self) -> None:
        super().on_message_begin()
        self._in_head, self._in_body = True, False
        if self.cycle is None or self.cycle.response_complete:
            self._wait(HEAD_WITHIN_S)

    def on_headers_complete(self) -> None:
        self._in_head, self._in_body, self._head_bytes, self._unread_bytes = False, True, 0, 0
        if self.transport.is_closing():
            return
        super().on_headers_complete()
        self._wait(BODY_WITHIN_S)

    def _start_asgi_task(self, cycle: Any, app: Any) -> None:
        connection = self._connection
        if (
            connection is not None
            and connection.only_stops
            and not self.is_stop(cycle.scope["method"], cycle.scope["path"])
        ):
            cycle.keep_alive = False
            app = _no_room
        super()._start_asgi_task(cycle, app)

    def on_message_complete(self) -> None:
        self._in_body = False
        self._in_head = True
        self._pieces = 0
        super().on_message_complete()
        if self._connection is not None:
            self._connection.due_s = None

    def on_response_complete(self) -> None:
        super().on_response_complete()
        if self.cycle.response_complete and not self._in_body:
            self._wait(HEAD_WITHIN_S)  # uvicorn closes it sooner, and until then it may make room

    def pause_writing(self) -> None:
        super().pause_writing()
        if self._untaken is None:
            self._untaken = self.loop.call_later(UNTAKEN_S, self.transport.abort)

    def resume_writing(self) -> None:
        if self.flow is not None:
            super().resume_writing()
        if self._untaken is not None:
            self._untaken.cancel()
            self._untaken = None

    def handle_websocket_upgrade(self) -> None:
        if self._connection is not None:
            self._connection.due_s = None  # from now on pings tell whether anybody is there
            if self._connection.only_stops:
                self._refuse(503, NO_ROOM)
                return
            self._connection.piece_bytes = MESSAGES_BYTES
        super().handle_websocket_upgrade()

    def _wait(self, seconds: float) -> None:
        if self._connection is not None and self._connection.door is not None:
            self.door.within(self._connection, seconds)

    def _refuse(self, status: int, why: bytes) -> None:
        reason = {431: b"Request Header Fields Too Large", 503: b"Service Unavailable"}[status]
        head = b"HTTP/1.1 %d %s\r\ncontent-type: text/plain; charset=utf-8\r\nconnection: close\r\n" % (status, reason)
        self.transport.write(head + b"content-length: %d\r\n\r\n" % len(why) + why)
        self.transport.close()


NO_ROOM = b"this server has all the connections that it takes, of this address or in all; motors can be stopped"


async def _no_room(scope: Any, receive: Any, send: Any) -> None:
    del scope, receive
    headers = [
        (b"content-type", b"text/plain; charset=utf-8"),
        (b"content-length", b"%d" % len(NO_ROOM)),
        (b"retry-after", b"5"),
        (b"connection", b"close"),
    ]
    await send({"type": "http.response.start", "status": 503, "headers": headers})
    await send({"type": "http.response.body", "body": NO_ROOM})


def limited_http(door: Door, is_stop: Callable[[str, str], bool]) -> type[LimitedHttp]:
    """The protocol of a server whose connections come through `door`."""
    return type("LimitedHttpOfDoor", (LimitedHttp,), {"door": door, "is_stop": staticmethod(is_stop)})


class LimitedWebSocket(WebSocketsSansIOProtocol):
    """uvicorn's WebSocket, each piece read in its turn. `door` is that of a subclass: `limited_websocket`."""

    door: Door

    _its_turn = True
    _untaken: asyncio.TimerHandle | None = None
    _left_unread_bytes: int | None = None
    """What may still come behind a refused message; None as long as there was none."""

    def connection_lost(self, exc: Exception | None) -> None:
        super().connection_lost(exc)
        self._taken()

    def handle_parser_exception(self) -> None:
        """Say why, and read away what follows: a socket closed over what is unread takes back what it said last."""
        goodbye = self.conn.close_sent
        assert goodbye is not None
        self.queue.put_nowait({"type": "websocket.disconnect", "code": goodbye.code, "reason": goodbye.reason})
        self.transport.write(b"".join(self.conn.data_to_send()))
        self.close_sent = self.disconnected = True
        self._left_unread_bytes = UNREAD_BYTES_MAX
        self.close_timer = self.loop.call_later(GOODBYE_S, self.transport.abort)
        if self.transport.can_write_eof():  # with TLS the client waits for the timer
            self.transport.write_eof()
        connection = self.door.connection(self.transport.get_extra_info("socket").fileno())
        if connection is not None:
            connection.piece_bytes = PIECE_BYTES

    def shutdown(self) -> None:
        if self.transport.is_closing():  # the client's goodbye was answered: uvicorn would say another one, and fail
            self.stop_keepalive()
        else:
            super().shutdown()

    def data_received(self, data: bytes) -> None:
        if self._left_unread_bytes is not None:
            self._left_unread_bytes -= len(data)
            if self._left_unread_bytes < 0:
                self.transport.abort()
            return
        super().data_received(data)
        if self.handshake_initiated and self._left_unread_bytes is None and not self.transport.is_closing():
            self._its_turn = False
            self.transport.pause_reading()
            self.door.hold("" if self.client is None else self.client[0], self._release)

    def pause_writing(self) -> None:
        super().pause_writing()
        self.transport.pause_reading()  # answers to pings have no other bound
        if self._untaken is None:
            self._untaken = self.loop.call_later(UNTAKEN_S, self.transport.abort)

    def resume_writing(self) -> None:
        super().resume_writing()
        self._taken()
        self._read_on()

    async def receive(self) -> Any:
        message = await self.queue.get()
        if self.read_paused and self.queue.empty():
            self.read_paused = False
            self._read_on()
        return message

    def _release(self) -> bool:
        """As `Flow.release`."""
        self._its_turn = True
        self._read_on()
        return not self.transport.is_closing()

    def _read_on(self) -> None:
        if self._its_turn and not self.read_paused and self.writable.is_set():
            self.transport.resume_reading()

    def _taken(self) -> None:
        if self._untaken is not None:
            self._untaken.cancel()
            self._untaken = None


def limited_websocket(door: Door) -> type[LimitedWebSocket]:
    """The same for WebSockets."""
    return type("LimitedWebSocketOfDoor", (LimitedWebSocket,), {"door": door})
