"""Stops, ahead of everything that waits for the link.

"ramp" is MST: the module slows down with its maximum acceleration (AP 5). TMCL has no command that
stops dead, and taking the current away would let a load fall. So "immediate" is MST with AP 5 at the
highest that the module allows, 7.6 million pps^2, which ends 50,000 pps within 7 ms, and AP 5 is
written back once the motor rests. A stop that failed is reported and never sent again by itself: the
answer may have been all that was lost, and whoever stops decides what comes next.
"""

from __future__ import annotations

import contextlib
from collections.abc import Sequence

from ...errors import BenchError, DownloadMode, LinkDown, WriteRefused, WrongState
from ...links.download import DownloadHold
from ...links.queue import Priority
from ...links.tmcl import Request
from ...registers.tmcl.commands import Opcode
from ..core.results import StopMode, StopOutcome
from ..core.session import Session
from ..core.stop_each import stop_each
from ..core.tmcl_calls import Calls
from ..core.tmcl_frames import STATUS, STOP
from ..core.tmcl_link import TmclLink
from .borrowed import BorrowedAcceleration
from .ongoing import OngoingMotion
from .state import ModuleState


class Stops:
    """Stops the motor, and sees whether it obeyed."""

    def __init__(
        self,
        session: Session,
        state: ModuleState,
        link: TmclLink,
        download: DownloadHold,
        ongoing: OngoingMotion,
        borrowed: BorrowedAcceleration,
    ) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._download = download
        self._ongoing = ongoing
        self._borrowed = borrowed

    async def stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        async def stop(axis: int) -> BenchError | None:
            del axis  # it has one
            async with self._link.calls(priority=Priority.STOP) as calls:
                return await self._stop(calls, mode)

        return await stop_each(self._session, axes, mode, stop)

    async def _stop(self, calls: Calls, mode: StopMode) -> BenchError | None:
        # In download mode a stop would be stored, so that ends first. Where it fails, the stop goes out all the same:
        # its own answer tells whether it was stored.
        if self._download.problem is not None:
            await self._leave_download(calls)
        problem = await self._stop_motor(calls, mode)
        if not isinstance(problem, DownloadMode):
            return problem
        # The module said that it has stored the stop, so it came into download mode by another master's command.
        await self._leave_download(calls)
        return await self._stop_motor(calls, mode)

    async def _leave_download(self, calls: Calls) -> None:
        with contextlib.suppress(BenchError):
            await calls.do(Request(self._link.address, Opcode.EXIT_DOWNLOAD))

    async def _stop_motor(self, calls: Calls, mode: StopMode) -> BenchError | None:
        searching = self._ongoing.driven in ("search", None)
        problem: BenchError | None = None
        if self._state.program_started:
            # A program could start the motor again. Whether it ends or not, the motor is stopped next.
            stop = Request(self._link.address, Opcode.STOP_APPLICATION)
            ended = await self._send_stop(calls, stop)
            self._state.program_started = ended is not None
            if ended is None and self._state.program.runs:
                self._state.program.commanded(stop)
        if searching:
            # A search goes on by itself after MST, so it has to end first.
            problem = await self._send_stop(calls, Request(self._link.address, Opcode.RFS, STOP))
        if not isinstance(problem, LinkDown):
            problem = await self._send_stop(calls, Request(self._link.address, Opcode.MST)) or (
                problem if self._ongoing.driven == "search" else None
            )
        if problem is not None:
            return problem
        self._ongoing.stop_commanded(calls.time_s)
        if mode == "immediate":
            problem = await self._borrowed.raise_it(calls)
        problem = await self._check_stop(calls) or problem
        with contextlib.suppress(BenchError):
            position, speed = await calls.get_many((self._state.roles.actual_position, self._state.roles.actual_speed))
            self._ongoing.expect(calls.time_s, position, speed * self._state.speed_unit_pps, None, 0)
        return problem

    async def _send_stop(self, calls: Calls, request: Request) -> BenchError | None:
        try:
            await calls.do(request)
        except BenchError as error:
            self._ongoing.mark_unknown(str(error))
            return error
        return None

    async def _check_stop(self, calls: Calls) -> BenchError | None:
        """Whether the module obeyed. Reads alone, but for a search that nobody here knew of."""
        roles = self._state.roles
        try:
            target_speed, step_direction = await calls.ask_many((roles.target_speed, roles.step_direction))
            if step_direction:
                return WrongState(
                    "the module follows its step/direction inputs, which no stop ends",
                    "stop the pulses, or write step_direction_mode (AP 254) 0",
                )
            if target_speed:
                return WriteRefused(roles.target_speed.name, 0, target_speed, "stop again, or cut the power")
            if (await calls.do(Request(self._link.address, Opcode.RFS, STATUS))).value:
                await calls.do(Request(self._link.address, Opcode.RFS, STOP))
                await calls.do(Request(self._link.address, Opcode.MST))
        except BenchError as error:
            return error
        return None
