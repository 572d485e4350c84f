"""Stops, ahead of everything that waits for the link.

"ramp" is MST: the module slows down with its maximum acceleration (AP 5). TMCL has no command that
stops dead, and taking the current away would let a load fall. So "immediate" is MST with AP 5 at the
highest that the module allows, 7.6 million pps^2, which ends 50,000 pps within 7 ms, and AP 5 is
written back once the motor rests. A stop that failed is reported and never sent again by itself: the
answer may have been all that was lost, and whoever stops decides what comes next.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Sequence

from ...errors import BenchError, DownloadMode, LinkDown, UnknownParameter, WriteRefused, WrongState
from ...links.queue import Priority
from ...links.tmcl import Request
from ...registers.tmcl.commands import Opcode
from ..core.results import StopMode, StopOutcome
from . import rows
from .calls import Calls
from .motion import STATUS, STOP, Motion
from .refusals import limits

SETTLE_S = 0.02
"""How often the motor is looked at after an immediate stop, until AP 5 goes back [s]."""
SETTLE_MAX_S = 5.0


class Stops(Motion):
    """A TMCL module that can be stopped."""

    async def _stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        began = time.perf_counter()
        outcomes = []
        for axis in axes:
            self.stops[axis] += 1  # before anything waits: what is under way for this axis gives up
            self.commanded(axis, "stop", mode=mode)
            async with self.calls(priority=Priority.STOP) as calls:
                problem = await self._stop(calls, mode)
            outcomes.append(StopOutcome(self.id, axis, problem is None, (time.perf_counter() - began) * 1e3, problem))
        return outcomes

    # --- setting the position -------------------------------------------------------------------

    async def position_from_encoder(self, axis: int) -> int:
        """Call the place where the motor stands what its built-in encoder shows (AP 209); the difference.

        The axis is stopped by MST first: in positioning the module would drive on to its target from its new place.
        Raises WrongState while it moves, and where the firmware has no such encoder.
        """
        axis = self.axis(axis).index
        self.require_connected()
        async with self.calls(axis) as calls:
            position, encoder, speed = await calls.ask_many((rows.ACTUAL_POSITION, rows.ENCODER, rows.ACTUAL_SPEED))
            if encoder is None:
                raise WrongState(f"this module has no {rows.ENCODER.name} ({rows.ENCODER.alias})")
            if speed or (await calls.do(Request(self.address, Opcode.RFS, STATUS))).value:
                raise WrongState(f"axis {axis} moves", "stop it first")
            if self.limiter is not None:
                self.limiter.require_target(axis, encoder)
            await calls.do(Request(self.address, Opcode.MST))
            self._driven = "velocity"
            self.commanded(axis, "set_position", position=encoder)
            self._book.end(calls.time_s, "the position was set")
            await calls.do(Request(self.address, Opcode.SAP, rows.ACTUAL_POSITION.address, 0, encoder))
            back = await calls.get(rows.ACTUAL_POSITION)
        if back != encoder:
            raise WriteRefused(rows.ACTUAL_POSITION.name, encoder, back, f"it was {position}")
        return calls.need(rows.ACTUAL_POSITION, position) - encoder

    # --- stops ----------------------------------------------------------------------------------

    async def _stop(self, calls: Calls, mode: StopMode) -> BenchError | None:
        # In download mode a stop would be stored, so that ends first. Where it fails, the stop goes out all the same:
        # its own answer tells whether it was stored.
        if self.download.problem is not None:
            await self._leave_download(calls)
        problem = await self._stop_motor(calls, mode)
        if not isinstance(problem, DownloadMode):
            return problem
        # The module said that it has stored the stop, so it came into download mode by somebody else's hand.
        await self._leave_download(calls)
        return await self._stop_motor(calls, mode)

    async def _leave_download(self, calls: Calls) -> None:
        with contextlib.suppress(BenchError):
            await calls.do(Request(self.address, Opcode.EXIT_DOWNLOAD))

    async def _stop_motor(self, calls: Calls, mode: StopMode) -> BenchError | None:
        searching = self._driven in ("search", None)
        problem: BenchError | None = None
        if searching:
            # A search goes on by itself after MST, so it has to end first.
            problem = await self._send_stop(calls, Request(self.address, Opcode.RFS, STOP))
        if not isinstance(problem, LinkDown):
            problem = await self._send_stop(calls, Request(self.address, Opcode.MST)) or (
                problem if self._driven == "search" else None
            )
        if problem is not None:
            return problem
        stopped_s = calls.time_s
        self._driven = "velocity"
        self._watch.stop_commanded(stopped_s)
        if mode == "immediate":
            problem = await self._stop_hard(calls)
        problem = await self._check_stop(calls) or problem
        with contextlib.suppress(BenchError):
            position, speed = await calls.get_many((rows.ACTUAL_POSITION, rows.ACTUAL_SPEED))
            self._expect(calls.time_s, position, speed * self.speed_unit_pps, None, 0)
        return problem

    async def _send_stop(self, calls: Calls, request: Request) -> BenchError | None:
        try:
            await calls.do(request)
        except BenchError as error:
            self._motion_uncertain(str(error))
            return error
        return None

    async def _stop_hard(self, calls: Calls) -> BenchError | None:
        """The motor slows down already: let it do so as fast as it can."""
        try:
            if self._borrowed is None:
                now = await calls.get(rows.MAX_ACCELERATION)
                self._borrowed = now
            await calls.put(rows.MAX_ACCELERATION, limits(rows.MAX_ACCELERATION, self.unit_mode)[1])
        except UnknownParameter:
            return None  # there is but one way to slow down, and the motor is on it
        except BenchError as error:
            return error
        finally:
            if self._borrowed is not None:
                self._begin(self._settle(), "after a stop of")
        return None

    async def _settle(self) -> None:
        """Write AP 5 back once the motor rests; what fails here the next command or look does again."""
        left_s = SETTLE_MAX_S
        while self._borrowed is not None and left_s > 0:
            await self.clock.sleep(SETTLE_S)
            left_s -= SETTLE_S
            with contextlib.suppress(BenchError):
                async with self.calls() as calls:
                    # Where no speed is told, the time that any stop takes has to do.
                    if (await calls.ask_many((rows.ACTUAL_SPEED,)))[0] == 0 or left_s <= 0:
                        await self._give_back_acceleration(calls)

    async def _check_stop(self, calls: Calls) -> BenchError | None:
        """Whether the module obeyed. Reads alone, but for a search that nobody here knew of."""
        try:
            target_speed, step_direction = await calls.ask_many((rows.TARGET_SPEED, rows.STEP_DIRECTION))
            if step_direction:
                return WrongState(
                    "the module follows its step/direction inputs, which no stop ends",
                    "stop the pulses, or write step_direction_mode (AP 254) 0",
                )
            if target_speed:
                return WriteRefused(rows.TARGET_SPEED.name, 0, target_speed, "stop again, or cut the power")
            if (await calls.do(Request(self.address, Opcode.RFS, STATUS))).value:
                await calls.do(Request(self.address, Opcode.RFS, STOP))
                await calls.do(Request(self.address, Opcode.MST))
        except BenchError as error:
            return error
        return None

    async def refresh(self) -> None:
        await super().refresh()
        if self._borrowed is not None and self._known.get(rows.ACTUAL_SPEED.address) == 0:
            async with self.calls() as calls:
                await self._give_back_acceleration(calls)
