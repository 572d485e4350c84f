"""A client that costs next to nothing, so that the server is what is measured: raw sockets, requests kept in flight."""

from __future__ import annotations

import re
import selectors
import socket
import time
from urllib.parse import urlsplit

CONNECTIONS = 16
_LENGTH = re.compile(rb"content-length: (\d+)", re.IGNORECASE)


class _Connection:
    """One kept-alive connection with one request in flight."""

    def __init__(self, host: str, port: int, request: bytes) -> None:
        self.socket = socket.create_connection((host, port))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._request = request
        self._received = b""

    def ask(self) -> None:
        self.socket.sendall(self._request)

    def answered(self) -> bool:
        """Read what is there; True when it completes an answer. Raises RuntimeError for any but a 200."""
        self._received += self.socket.recv(65_536)
        head, end, body = self._received.partition(b"\r\n\r\n")
        if not end:
            return False
        length = _LENGTH.search(head)
        if not head.startswith(b"HTTP/1.1 200") or length is None:
            raise RuntimeError(f"{self._request!r} was answered {self._received[:200]!r}")
        if len(body) < int(length[1]):
            return False
        self._received = b""
        return True


def requests_per_second(url: str, path: str, seconds: float) -> float:
    """GET `path` as fast as the server answers. Raises RuntimeError for any answer but a 200."""
    address = urlsplit(url)
    host, port = address.hostname or "", address.port or 80
    request = f"GET {path} HTTP/1.1\r\nHost: {address.netloc}\r\n\r\n".encode()
    connections = [_Connection(host, port, request) for _ in range(CONNECTIONS)]
    done = 0
    with selectors.DefaultSelector() as selector:
        for connection in connections:
            selector.register(connection.socket, selectors.EVENT_READ, connection)
            connection.ask()
        start_s = time.perf_counter()
        while (elapsed_s := time.perf_counter() - start_s) < seconds:
            for key, _ in selector.select(timeout=1):
                if key.data.answered():
                    done += 1
                    key.data.ask()
    for connection in connections:
        connection.socket.close()
    return done / elapsed_s
