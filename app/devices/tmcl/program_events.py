"""What a module's program is seen to do, as marks on the time axis: begun, stepped, halted, ended."""

from __future__ import annotations

from ...links.tmcl import Request
from ...registers.tmcl.commands import Opcode
from ..core.results import ProgramEvent
from ..core.session import Session

RUNNING = 1
"""Of the parameter that tells the state of the application."""
_DONE = {
    Opcode.STOP_APPLICATION: "program stopped",
    Opcode.STEP_APPLICATION: "program: one command",
    Opcode.RESET_APPLICATION: "program reset",
}


class ProgramEvents:
    """Of one module. `runs` is what was commanded or seen last."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.runs = False

    def commanded(self, request: Request) -> None:
        """The module has confirmed a command that starts, steps or stops its program; others change nothing."""
        if request.opcode == Opcode.RUN_APPLICATION:
            self.runs = True
            address = request.value if request.type else None
            self.tell("program goes on" if address is None else f"program begins at {address}", address)
        elif request.opcode in _DONE:
            self.runs = False
            self.tell(_DONE[Opcode(request.opcode)])

    def saw(self, status: int, counter: int | None) -> None:
        """The module has told the state of its application, and where its program is."""
        if (status == RUNNING) == self.runs:
            return
        self.runs = status == RUNNING
        where = "" if counter is None else f" at {counter}"
        self.tell(f"program {'runs' if self.runs else 'ended'}{where}", counter)

    def tell(self, text: str, address: int | None = None) -> None:
        """Mark it with the time of the latest answer."""
        self._session.tell(ProgramEvent(0, self._session.port.last_exchange_s, address, text))
