"""A client that costs next to nothing, so that the server is what is measured: raw sockets, requests kept in flight."""

from __future__ import annotations

import selectors
import socket
import time
from urllib.parse import urlsplit

CONNECTIONS = 16


def requests_per_second(url: str, path: str, seconds: float) -> float:
    """GET `path` as fast as the server answers, on kept-alive connections. Raises RuntimeError for any but a 200."""
    address = urlsplit(url)
    request = f"GET {path} HTTP/1.1\r\nHost: {address.netloc}\r\n\r\n".encode()
    done = 0
    with selectors.DefaultSelector() as selector:
        connections = [socket.create_connection((address.hostname, address.port)) for _ in range(CONNECTIONS)]
        try:
            for connection in connections:
                connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                selector.register(connection, selectors.EVENT_READ)
                connection.sendall(request)
            start_s = time.perf_counter()
            while (elapsed_s := time.perf_counter() - start_s) < seconds:
                for key, _ in selector.select(timeout=1):
                    answer = key.fileobj.recv(65_536)  # type: ignore[union-attr]
                    # One request a connection at a time and short answers: a read is a whole answer.
                    if not answer.startswith(b"HTTP/1.1 200"):
                        raise RuntimeError(f"GET {path}: {answer[:200]!r}")
                    done += 1
                    key.fileobj.sendall(request)  # type: ignore[union-attr]
        finally:
            for connection in connections:
                connection.close()
    return done / elapsed_s
