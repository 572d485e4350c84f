"""Parameters whose write sets the motor in motion or stops it, and commands by hand that do."""

from __future__ import annotations

import contextlib

from ...errors import BenchError, LinkError
from ...links.tmcl import Request
from ...registers.model import Register
from ...registers.tmcl.commands import Opcode
from ..core.results import RegisterWritten
from ..core.session import Session
from ..core.tmcl_frames import START, writing
from ..core.tmcl_link import TmclLink
from .borrowed import BorrowedAcceleration
from .ongoing import OngoingMotion
from .records import Records
from .state import ModuleState


class MovingWrites:
    """Writes such parameters, once, and tells what drives the axis after them."""

    def __init__(
        self,
        session: Session,
        state: ModuleState,
        link: TmclLink,
        records: Records,
        ongoing: OngoingMotion,
        borrowed: BorrowedAcceleration,
    ) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._records = records
        self._ongoing = ongoing
        self._borrowed = borrowed

    def may_move(self, register: Register) -> bool:
        """Whether a write to `register` may set the motor in motion or stop it."""
        return register in self._state.roles.moving

    async def write(self, register: Register, value: int) -> RegisterWritten:
        """Write a parameter that may move the motor. Raises LinkError, WriteRefused."""
        records, what = self._records, f"writing {register.name}"
        request = writing(self._link.address, register, value)
        async with self._link.calls(register.axis) as calls:
            old = await calls.before(register)
            self._link.check_limits(request)
            self._session.commanded(0, register.name)
            try:
                await calls.move(request, what, register)
            except LinkError as error:
                self._ongoing.mark_unknown(str(error))
                records.tell(register, old, value, error)
                raise
            self._ongoing.written(register, value, calls.time_s)
            try:
                back = await calls.get(register)
                written = records.written(register, value, back, *records.judge(register, value, back))
            except BenchError as error:
                records.tell(register, old, value, error)
                raise
            records.tell(register, old, value, written)
            await self._ongoing.expect_as_set(calls)
        return written

    def wrote(self, register: Register) -> None:
        """A write to `register` that moves nothing has happened, and its turn is over."""
        roles = self._state.roles
        if register is roles.max_acceleration:
            self._borrowed.forget()
        if register in (*roles.ramp, roles.ramp_wait):
            self._ongoing.book.end(self._session.port.last_exchange_s, f"{register.name} was written")

    async def commanded_by_hand(self, request: Request) -> None:
        """A command that may move or stop the motor was answered."""
        ongoing = self._ongoing
        async with self._link.calls() as calls:
            match request.opcode:
                case Opcode.MVP:
                    ongoing.drives("position", calls.time_s, None)
                case Opcode.ROR | Opcode.ROL:
                    ongoing.drives("velocity", calls.time_s, None)
                case Opcode.MST:
                    ongoing.stop_commanded(calls.time_s)
                case Opcode.RFS:
                    ongoing.drives("search" if request.type == START else "velocity", calls.time_s, None)
                case Opcode.SAP if (register := self._state.axis_row(request.type)) is not None:
                    ongoing.written(register, request.value, calls.time_s)
                case _:
                    ongoing.driven = None
                    ongoing.watch.began("unknown", calls.time_s)
            with contextlib.suppress(BenchError):  # the command itself is done: what fails now is not its failure
                await ongoing.expect_as_set(calls)
