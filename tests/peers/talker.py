"""A peer that talks without pause, whatever it is asked."""

from __future__ import annotations

import contextlib
import random
import socket
import threading
import time
from collections.abc import Iterator

PIECE_BYTES = 4096


@contextlib.contextmanager
def talker(bytes_per_s: float = 2e6) -> Iterator[int]:
    """Its port on this machine. It talks in threads of its own, to everybody who connects."""
    noise = random.Random(1).randbytes(PIECE_BYTES)
    ended = threading.Event()
    talking: list[threading.Thread] = []

    def talk(connection: socket.socket) -> None:
        due_s = time.monotonic()
        with connection, contextlib.suppress(OSError):
            connection.settimeout(0.2)
            while not ended.is_set():
                with contextlib.suppress(TimeoutError):
                    connection.sendall(noise)
                due_s = max(due_s + PIECE_BYTES / bytes_per_s, time.monotonic() - 0.1)
                ended.wait(max(0.0, due_s - time.monotonic()))

    def accept() -> None:
        while True:
            try:
                connection, _ = listener.accept()
            except OSError:
                return
            talking.append(threading.Thread(target=talk, args=(connection,), daemon=True))
            talking[-1].start()

    with socket.create_server(("127.0.0.1", 0)) as listener:
        threading.Thread(target=accept, daemon=True).start()
        try:
            yield listener.getsockname()[1]
        finally:
            ended.set()
            listener.shutdown(socket.SHUT_RDWR)
            for thread in talking:
                thread.join(5)
