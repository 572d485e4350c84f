"""Where a line ends on this machine: what the loop of `server.LineServer` asks of a pty or a TCP port."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from .line import Line

Watch = Callable[[int, Callable[[float], None] | None], None]
"""(descriptor, what to call with the time [s] when it can be read; None: no longer)."""

READ_BYTES = 4096


class Client(Protocol):
    """A participant on the line."""

    def send(self, data: bytes) -> None:
        """Hand over `data`; what cannot be taken at once is lost, as in a UART that nobody empties."""
        ...


class End(Protocol):
    """A port that clients open. `plug` and `unplug` come in turns, the first of them `plug`."""

    @property
    def name(self) -> str:
        """What people call it: `pty /tmp/module`, `tcp 127.0.0.1:4001`."""
        ...

    def plug(self, line: Line, watch: Watch) -> None:
        """Be there, and feed `line`. Raises OSError where that is not possible."""
        ...

    def unplug(self) -> None:
        """Be gone; every client notices."""
        ...

    def close(self) -> None:
        """Be gone for good."""
        ...
