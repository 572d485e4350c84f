"""Commands that a user sends by hand. What they may set in motion is known."""

from __future__ import annotations

import time

from ...errors import LinkError
from ...links.port import Answer
from ...links.queue import Priority
from ...links.tmcl import Request, has_reply
from ...registers.model import Space
from ...registers.tmcl.commands import BY_OPCODE, Opcode
from ..core.session import Session
from ..core.tmcl_console import STOPPING, UNANSWERED_S, Sender, require_no_boot_loader
from ..core.tmcl_frames import WIDE_SHIFT, spelled
from ..core.tmcl_link import TmclLink
from .ongoing import ListedMotions
from .state import ListedState

OF_AXIS = frozenset({Opcode.SAP, Opcode.AAP, Opcode.RSAP})


class ListedSender(Sender):
    """Sends any command to the module, once."""

    def __init__(self, session: Session, state: ListedState, link: TmclLink, motions: ListedMotions) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._motions = motions

    async def send(self, request: Request, frame: bytes) -> tuple[bytes, float]:
        """The raw answer, b"" where there is none and need not be, and how long it took [ms]."""
        require_no_boot_loader(request)
        self._link.check_limits(request)
        ours = request.address == self._link.address
        axes = self._moved(request) if ours else ()
        for axis in axes:  # before it goes out: whatever runs on this axis has to let go of it first
            self._session.commanded(axis, spelled(request))
        always = ours and has_reply(frame)
        guard = self._session.stop_guard(axes) if axes and request.opcode not in STOPPING else None
        began = time.perf_counter()
        async with self._session.queue.turn(Priority.COMMAND, guard, by_hand=True) as turn:
            answer = Answer.ALWAYS if always else Answer.MAYBE
            try:
                reply = await turn.exchange(frame, None if always else UNANSWERED_S, answer)
            except LinkError:
                for axis in axes:
                    self._motions.mark_unknown(axis)
                raise
            time_s = turn.last_exchange_s
        took_ms = (time.perf_counter() - began) * 1e3
        self._heed(request, axes, time_s)
        return reply, took_ms

    def _moved(self, request: Request) -> tuple[int, ...]:
        """Axes that the command may set in motion or stop; all where nobody knows which."""
        row = BY_OPCODE.get(request.opcode)
        if request.opcode in OF_AXIS:
            axis, number = request.motor & (1 << WIDE_SHIFT) - 1, request.type | request.motor >> WIDE_SHIFT << 8
            register = self._state.table.at(number, Space.AXIS, axis=axis)
            return (axis,) if register is not None and self._state.moves(register) else ()
        if row is not None and not row.moves and request.opcode not in STOPPING:
            return ()
        if row is not None and request.motor < len(self._motions.axes) and request.opcode <= Opcode.RFS:
            return (request.motor,)
        return tuple(range(len(self._motions.axes)))

    def _heed(self, request: Request, axes: tuple[int, ...], time_s: float) -> None:
        """A command by hand was sent: what is known from now on."""
        if request.opcode in OF_AXIS:
            axis, number = request.motor & (1 << WIDE_SHIFT) - 1, request.type | request.motor >> WIDE_SHIFT << 8
            self._state.forget(axis, number)  # what it holds now only a read tells
        for axis in axes:
            motion = self._motions.axes[axis]
            match request.opcode:
                case Opcode.MVP:
                    motion.drives("position", time_s, None)
                case Opcode.ROR | Opcode.ROL:
                    motion.drives("velocity", time_s, None)
                case Opcode.MST:
                    motion.stop_commanded(time_s)
                case _:
                    motion.mark_unknown(time_s)
