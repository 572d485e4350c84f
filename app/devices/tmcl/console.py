"""Commands that a user sends by hand. What they may set in motion is known."""

from __future__ import annotations

import time

from ...errors import BadReply, LinkError, WrongState
from ...links.download import DownloadHold
from ...links.port import Answer
from ...links.queue import Priority
from ...links.tmcl import (
    Request,
    check_reply,
    has_reply,
    sound,
)
from ...registers.model import Space
from ...registers.tmcl.commands import BY_OPCODE, CONTROL_FIRST, Opcode, Status
from ..core.changes import BY_HAND
from ..core.session import Session
from ..core.tmcl_console import STOPPING, UNANSWERED_S, Sender, require_no_boot_loader
from ..core.tmcl_frames import spelled, written_by
from ..core.tmcl_link import TmclLink
from .moving_writes import MovingWrites
from .ongoing import OngoingMotion
from .records import Records
from .state import ModuleState

ENDING_PROGRAMS = frozenset({Opcode.STOP_APPLICATION, Opcode.RESET_APPLICATION, Opcode.ENTER_DOWNLOAD})
"""Commands after which no program runs."""


class ModuleSender(Sender):
    """Sends any command to the module of `link`. `moving` hears of those that may have moved its motor."""

    def __init__(
        self,
        session: Session,
        state: ModuleState,
        link: TmclLink,
        download: DownloadHold,
        records: Records,
        ongoing: OngoingMotion,
        moving: MovingWrites,
    ) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._download = download
        self._records = records
        self._ongoing = ongoing
        self._moving = moving

    async def send(self, request: Request, frame: bytes) -> tuple[bytes, float]:
        """The raw answer, b"" where there is none and need not be, and how long it took [ms]."""
        self._require_harmless(request)
        stored = request.opcode < CONTROL_FIRST and self._download.problem is not None
        moves = request.address == self._link.address and not stored and self._may_move(request)
        if not stored:
            await self._learn(request)
        self._link.check_limits(request)
        if moves:
            # Told before it goes out: whatever runs on this axis has to let go of it first.
            self._session.commanded(0, spelled(request))
        answer = Answer.ALWAYS
        if not has_reply(frame) or request.address != self._link.address:
            answer = Answer.MAYBE
        began = time.perf_counter()
        guard = self._session.stop_guard([0]) if moves and request.opcode not in STOPPING else None
        async with self._session.queue.turn(Priority.COMMAND, guard, by_hand=True) as turn:
            try:
                reply = await turn.exchange(frame, UNANSWERED_S if answer is Answer.MAYBE else None, answer)
            except LinkError as error:
                if moves:
                    self._ongoing.mark_unknown(str(error))
                raise
        took_ms = (time.perf_counter() - began) * 1e3
        if reply:
            self._saw_exchange(request, frame, reply)
        if request.opcode in (Opcode.RUN_APPLICATION, Opcode.STEP_APPLICATION):
            self._state.program_started = True
        elif request.opcode in ENDING_PROGRAMS and reply:
            self._state.program_started = False
        if not stored and reply and request.address == self._link.address and self._obeyed(frame, reply):
            self._state.program.commanded(request)
        if moves and self._download.problem is None:
            await self._moving.commanded_by_hand(request)
        return reply, took_ms

    def _obeyed(self, frame: bytes, reply: bytes) -> bool:
        try:
            return check_reply(self._session.port.name, frame, reply).status == Status.OK
        except BadReply:
            return False

    def _require_harmless(self, request: Request) -> None:
        """Raises WrongState for a command after which the module could not be driven, or its motor not be seen."""
        require_no_boot_loader(request)
        if request.opcode == Opcode.ENTER_DOWNLOAD and request.address == self._link.address and self._ongoing.moves:
            raise WrongState(
                "the motor moves, and in download mode nobody could look at it",
                "stop it, then enter download mode",
            )

    async def _learn(self, request: Request) -> None:
        """Read what a command counts from, where soft limits have to know it."""
        if self._session.limiter is not None and request.address == self._link.address:
            await self._session.limiter.learn_for(request.opcode, request.type, request.value)

    def _saw_exchange(self, request: Request, frame: bytes, reply: bytes) -> None:
        """What was read or written by hand is known from now on."""
        place = (Space.AXIS, request.type) if request.opcode == Opcode.GAP else written_by(request)
        if place is None or not sound(reply):
            return
        try:
            answer = check_reply(self._session.port.name, frame, reply)
        except BadReply:
            return
        space, number = place
        register = self._state.table.at(number, space)
        if answer.status != Status.OK or register is None or (space is Space.AXIS and request.motor != register.axis):
            return
        if request.opcode == Opcode.GAP:
            self._state.saw(register, register.decode(answer.value))
            return
        old = self._state.last(register) if space is Space.AXIS else None
        self._records.tell_change(register, old, request.value, BY_HAND)
        if space is Space.AXIS:
            self._state.forget((register.address,))  # what it holds now only a read tells

    def _may_move(self, request: Request) -> bool:
        """Whether the command may set a motor in motion or stop it."""
        if request.opcode in STOPPING:
            return True
        if request.opcode in (Opcode.SAP, Opcode.AAP, Opcode.RSAP, Opcode.SGP, Opcode.AGP):
            axis = request.opcode in (Opcode.SAP, Opcode.AAP, Opcode.RSAP)
            space, bank = (Space.AXIS, 0) if axis else (Space.GLOBAL_0, request.motor)
            return bank == 0 and (space, request.type) in {(row.space, row.address) for row in self._state.roles.moving}
        if request.opcode == Opcode.RFS:
            return request.type != 2
        row = BY_OPCODE.get(request.opcode)
        return row is None or row.moves
