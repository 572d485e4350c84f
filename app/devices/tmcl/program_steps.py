"""A run of a module's program by single steps (command 130), told as one."""

from __future__ import annotations

from ...errors import LinkError
from ...links.queue import Priority
from ...links.tmcl import Request, check_reply
from ...registers.model import Register
from ...registers.tmcl.commands import Opcode, Status
from ..core.capabilities import ProgramSteps
from ..core.session import Session
from ..core.tmcl_calls import Calls
from ..core.tmcl_link import TmclLink
from ..core.tmcl_refusals import refusal
from .moving_writes import MovingWrites
from .ongoing import OngoingMotion
from .state import ModuleState


class Steps(ProgramSteps):
    """Begun before the first step, so that a stop of the axis since then ends it."""

    def __init__(
        self,
        session: Session,
        state: ModuleState,
        link: TmclLink,
        ongoing: OngoingMotion,
        moving: MovingWrites,
        counter: Register,
    ) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._ongoing = ongoing
        self._moving = moving
        self._counter = counter
        self._guard = session.stop_guard([0])

    async def step(self, moves: bool) -> int:
        session, state = self._session, self._state
        request = Request(self._link.address, Opcode.STEP_APPLICATION)
        frame = request.encode()
        async with session.queue.turn(Priority.COMMAND, self._guard) as turn:
            state.program_started = True  # a step that moves nothing may be one of a program that will
            try:
                reply = check_reply(session.port.name, frame, await turn.exchange(frame))
            except LinkError as error:
                self._ongoing.mark_unknown(str(error))
                raise
            if reply.status != Status.OK:
                raise refusal(request, reply)
            calls = Calls(turn, session.port.name, self._link.address, state.saw, state.lacking)
            counter = await calls.get(self._counter)
        if moves:
            await self._moving.commanded_by_hand(request)
        return counter

    async def counter(self) -> int:
        async with self._link.calls(0) as calls:
            return await calls.get(self._counter)
