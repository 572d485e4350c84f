"""Takes every reason to move from an axis that stands."""

from __future__ import annotations

from ...errors import BadReply
from ...registers.model import Register
from ..core.register_io import RegisterIO
from ..core.session import Session
from . import roles as r
from .memory import ChipMemory


class Standstill:
    """Velocity mode with VMAX 0: nothing that is cleared or written then sets the motor off."""

    def __init__(self, session: Session, memory: ChipMemory) -> None:
        self._session = session
        self._memory = memory

    async def keep(self, io: RegisterIO, axis: int) -> None:
        """Keep an axis that stands where it is. Raises BadReply where that may not have arrived."""
        if not await io.write_many(self.writes(axis)):
            raise BadReply(
                self._session.port.name, "what was to keep the axis where it is may have arrived otherwise", b""
            )
        self._memory.assume(self._memory.rows(axis).rampmode, r.FORWARD)

    def writes(self, axis: int) -> list[tuple[Register, int]]:
        """What is about to be written to that end, in the order in which nothing moves in between."""
        rows = self._memory.rows(axis)
        self._memory.overwrite(rows.vmax, 0)
        self._memory.mark_unknown(rows.rampmode)
        return [(rows.vmax, 0), (rows.rampmode, r.FORWARD)]
