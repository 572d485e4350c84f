"""The registers of one chip over its link: turns, reads and writes within them, what soft limits say before a write."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...links.queue import Priority, Turn
from ...links.register_access import RegisterAccess
from ...registers.model import Register, RegisterTable
from .register_io import RegisterIO, Write, read_once_more
from .session import Session


@dataclass(frozen=True, slots=True)
class RegisterLink:
    """How the parts of a driver get at registers. `access` says how they go over this link."""

    session: Session
    access: RegisterAccess
    table: RegisterTable

    def turn(self, priority: Priority = Priority.COMMAND) -> Turn:
        """A turn of the link that no stop overtakes but one that waits."""
        return self.session.queue.turn(priority)

    def command(self, axis: int | None) -> Turn:
        """A turn for a command; one that touches an axis gives up when a stop of that axis overtakes it."""
        guard = None if axis is None else self.session.stop_guard([axis])
        return self.session.queue.turn(Priority.COMMAND, guard)

    def io(self, turn: Turn) -> RegisterIO:
        """Reads and writes over a turn."""
        return RegisterIO(turn, self.access)

    async def read_once(self, register: Register) -> int:
        """One word in a turn of its own. Asked again once after no reply: a read moves nothing."""
        return await read_once_more(self.session.queue, register.address, self.access)

    def allow(self, writes: Sequence[Write]) -> None:
        """Raises SoftLimit before anything of `writes`, which go out together, has gone out."""
        if self.session.limiter is not None:
            self.session.limiter.check_writes((write.register.address, write.word) for write in writes)
