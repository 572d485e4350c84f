"""Position reached events (command 138): with one, the axis is polled at once instead of when that is due next.

An event only says that it is time to poll: what became of the motion, a reading tells. So one that is lost, or that
belongs to an earlier motion, does no harm.
"""

from __future__ import annotations

import asyncio
import contextlib

from ...errors import BenchError
from ...links.tmcl import Request
from ...registers.tmcl.commands import Opcode
from ..core.background_tasks import BackgroundTasks
from ..core.results import DeviceState
from ..core.session import Session
from ..core.tmcl_calls import Calls
from ..core.tmcl_link import TmclLink
from .ongoing import OngoingMotion
from .polling import Poller

EVERY, MOTOR_BITS = 1, 1
"""Type and value of command 138: every MVP from now on, of the one motor (FM-PD42-1241 3.6.35)."""


class Arrivals:
    """Hears the events of a line that tells them, whoever asked for them.

    By itself the driver asks only where the line is a bus on which nobody is disturbed by one who speaks unasked (CAN).
    On RS485 an event may meet a question of somebody else.
    """

    def __init__(
        self, session: Session, link: TmclLink, ongoing: OngoingMotion, poller: Poller, tasks: BackgroundTasks
    ) -> None:
        self._session = session
        self._link = link
        self._ongoing = ongoing
        self._poller = poller
        self._tasks = tasks
        self._asked = False
        self._polling: asyncio.Task[None] | None = None
        self.heard = 0
        """Events so far."""
        line = session.port.traits.batches
        if line is not None:
            line.on_event(self._on_event)

    async def ask_for(self, calls: Calls) -> None:
        """Before a move: once a connection. Raises LinkError; a module that knows no such command is polled as ever."""
        if self._asked or not self._session.port.traits.arbitrates:
            return
        await calls.reply(Request(self._link.address, Opcode.REQUEST_EVENT, EVERY, 0, MOTOR_BITS))
        self._asked = True

    def on_state(self, state: DeviceState, problem: BenchError | None) -> None:
        """`Session.state_hooks`: a module that was away may have been switched off, and forgets."""
        del problem
        if state != "connected":
            self._asked = False

    def _on_event(self, frame: bytes) -> None:
        del frame
        self.heard += 1
        if self._ongoing.moves and (self._polling is None or self._polling.done()):
            self._polling = self._tasks.begin(self._poll(), f"arrival of {self._session.id}")

    async def _poll(self) -> None:
        with contextlib.suppress(BenchError):  # then the next poll, which is never far
            await self._poller.poll(at_once=True)
