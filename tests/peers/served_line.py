"""An emulated line on a pty of this process, in a thread: for tests that need many of them, each as new."""

from __future__ import annotations

import contextlib
import socket
import threading
from collections.abc import Iterator
from pathlib import Path

from app.emulators.line.line import Line
from app.emulators.line.pty import PtyEnd
from app.emulators.line.server import LineServer
from app.emulators.line.tcp import TcpEnd


@contextlib.contextmanager
def served(line: Line, path: Path) -> Iterator[tuple[str, int]]:
    """`line` as a serial port at `path`, and as a TCP port: where that is."""
    listener = socket.create_server(("127.0.0.1", 0))
    where: tuple[str, int] = listener.getsockname()[:2]
    with LineServer(line, [PtyEnd(path), TcpEnd(listener)]) as server:
        serving = threading.Thread(target=server.run)
        serving.start()
        try:
            yield where
        finally:
            server.stop()
            serving.join()
