"""A TCP port that carries the bytes of a line and nothing else, as a serial device server in raw mode does."""

from __future__ import annotations

import contextlib
import socket

from .ends import READ_BYTES, Watch
from .line import Line

MOST_CLIENTS = 64
"""More connections than this are turned away: `select` cannot watch any number."""


class TcpEnd:
    """Every connection to `listener`, a bound socket, is a client of the line.

    Unplugged, it hangs up on everybody who calls: the port itself stays ours.
    """

    def __init__(self, listener: socket.socket) -> None:
        self._listener = listener
        self._line: Line | None = None
        self._watch: Watch | None = None
        self._clients: set[_TcpClient] = set()
        host, port = listener.getsockname()[:2]
        self._name = f"tcp [{host}]:{port}" if ":" in host else f"tcp {host}:{port}"
        listener.setblocking(False)

    @property
    def name(self) -> str:
        return self._name

    def plug(self, line: Line, watch: Watch) -> None:
        if self._watch is None:
            self._listener.listen()
            watch(self._listener.fileno(), self._knock)
        self._line, self._watch = line, watch

    def unplug(self) -> None:
        for client in tuple(self._clients):
            self._hang_up(client)
        self._line = None

    def close(self) -> None:
        self.unplug()
        if self._watch is not None:
            self._watch(self._listener.fileno(), None)
            self._watch = None
        self._listener.close()

    def _knock(self, now_s: float) -> None:
        del now_s
        try:
            connection, _ = self._listener.accept()
        except (BlockingIOError, ConnectionError):
            return  # who knocked has left
        if self._line is None or self._watch is None or len(self._clients) >= MOST_CLIENTS:
            connection.close()
            return
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        client = _TcpClient(self, connection)
        self._clients.add(client)
        self._line.join(client)
        self._watch(connection.fileno(), client.readable)

    def hear(self, client: _TcpClient, now_s: float) -> None:
        """Feed what `client` has sent; an end or an error of the connection is the end of the client."""
        if client not in self._clients:
            return  # unplugged between the look at the descriptor and now
        try:
            data = client.connection.recv(READ_BYTES)
        except BlockingIOError:
            return
        except OSError:
            data = b""
        if not data:
            self._hang_up(client)
        elif self._line is not None:
            self._line.feed(client, data, now_s)

    def _hang_up(self, client: _TcpClient) -> None:
        self._clients.discard(client)
        if self._watch is not None:
            self._watch(client.connection.fileno(), None)
        if self._line is not None:
            self._line.leave(client)
        client.connection.close()


class _TcpClient:
    def __init__(self, end: TcpEnd, connection: socket.socket) -> None:
        self.connection = connection
        self._end = end

    def readable(self, now_s: float) -> None:
        self._end.hear(self, now_s)

    def send(self, data: bytes) -> None:
        # A full buffer loses bytes as a UART does; a dead connection says so when it is read.
        with contextlib.suppress(OSError):
            self.connection.send(data)
