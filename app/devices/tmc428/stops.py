"""Stops, ahead of everything that waits for the link; and setting the position of an axis that stands."""

from __future__ import annotations

import time
from collections.abc import Sequence

from ...errors import BenchError, LinkDown, LinkTimeout, OutOfRange, WriteRefused, WrongState
from ...links.queue import Priority
from ..core.capabilities import PositionSetting
from ..core.register_io import RegisterIO
from ..core.results import StopMode, StopOutcome
from ..core.session import Session
from .axis_roles import HOLD_MODE, VELOCITY_MODE
from .memory import RampMemory
from .prediction import TickedBook
from .ramp_parameters import POSITION_MAX, POSITION_MIN


class RampStops(PositionSetting):
    """Stops the axes of a ramp generator chip, and calls the place where one stands by another number."""

    def __init__(self, session: Session, memory: RampMemory, books: Sequence[TickedBook]) -> None:
        self._session = session
        self._memory = memory
        self._books = books

    # --- stops ----------------------------------------------------------------------------------

    async def stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        began = time.perf_counter()
        for axis in axes:
            self._session.stops[axis] += 1  # before anything waits: what is under way for these axes gives up
            self._session.commanded(axis, "stop", mode=mode)
        outcomes: list[StopOutcome] = []
        lost: BenchError | None = None
        async with self._session.queue.turn(Priority.STOP) as turn:
            io = RegisterIO(turn)
            sent: dict[int, bool | BenchError] = {}
            for axis in axes:  # all motors first, all checks afterwards
                how = lost if lost is not None else await self._stop(io, axis, mode)
                sent[axis] = how
                if isinstance(how, LinkDown):
                    lost = how  # the next axis would only wait for the same dead link
            for axis, how in sent.items():
                problem = how if isinstance(how, BenchError) else await self._check_stop(io, axis, how)
                took_ms = (time.perf_counter() - began) * 1e3
                outcomes.append(StopOutcome(self._session.id, axis, problem is None, took_ms, problem))
        return outcomes

    async def _stop(self, io: RegisterIO, axis: int, mode: StopMode) -> bool | BenchError:
        """Send one axis its stop: whether at once (True) or by the ramp (False), or what went wrong."""
        rows = self._memory.rows[axis]
        for attempt in (1, 2):  # a stop moves nothing, so it may be sent again
            try:
                reference = await io.read(rows.reference)
                at_once = mode == "immediate" or await io.value(rows.a_max) == 0  # else it would never slow down
                if at_once:
                    await io.write(rows.reference, rows.with_mode(reference, HOLD_MODE))
                    await io.put(rows.v_actual, 0)
                else:
                    await io.write(rows.reference, rows.with_mode(reference, VELOCITY_MODE))
                    await io.put(rows.v_target, 0)
            except LinkTimeout as error:
                if attempt == 2:
                    return error
            except BenchError as error:
                return error
            else:
                self._books[axis].end(io.time_s, "stop")
                return at_once
        raise AssertionError("unreachable")

    async def _check_stop(self, io: RegisterIO, axis: int, at_once: bool) -> BenchError | None:
        rows = self._memory.rows[axis]
        wanted_mode, register = (HOLD_MODE, rows.v_actual) if at_once else (VELOCITY_MODE, rows.v_target)
        try:
            reference = await io.read(rows.reference)
            self._memory.saw(rows.reference, reference)
            if rows.mode.unpack(reference) != wanted_mode:
                sent = rows.with_mode(reference, wanted_mode)
                return WriteRefused(rows.reference.name, sent, reference, "stop again, or cut the power")
            value = await io.value(register)
            if value != 0:
                return WriteRefused(register.name, 0, value, "stop again, or cut the power")
        except BenchError as error:
            return error
        return None

    # --- setting the position -------------------------------------------------------------------

    async def set_position(self, axis: int, position: int, /) -> int:
        """Call the place where the motor stands `position`; x_target follows. Returns what was subtracted.

        v_max is 0 meanwhile, as the sheets ask for (DS-TMC428 8.4), so nothing moves. Raises WrongState
        while the motor turns, OutOfRange outside 24 bits.
        """
        self._session.axis(axis)
        if not POSITION_MIN <= position <= POSITION_MAX:
            raise OutOfRange("position", position, POSITION_MIN, POSITION_MAX, "microsteps")
        self._session.require_connected()
        rows = self._memory.rows[axis]
        if self._session.limiter is not None:
            self._session.limiter.require_target(axis, position)
        # No guard: a stop that comes between must not leave v_max at 0, and nothing here sets the motor in motion.
        async with self._session.queue.turn(Priority.COMMAND) as turn:
            io = RegisterIO(turn)
            if await io.value(rows.v_actual) != 0:
                raise WrongState(f"axis {axis} moves", "stop it first")
            v_max = await io.read(rows.v_max)
            if self._session.limiter is not None:  # else it would not come back
                self._session.limiter.check_writes([(rows.v_max.address, 0), (rows.v_max.address, v_max)])
            await io.write(rows.v_max, 0)
            self._session.commanded(axis, "set_position", position=position)
            before = await io.value(rows.x_actual)
            await io.put(rows.x_target, position)
            await io.put(rows.x_actual, position)
            x_actual, x_target = await io.value(rows.x_actual), await io.value(rows.x_target)
            await io.write(rows.v_max, v_max)
            back = await io.read(rows.v_max)
            self._books[axis].end(io.time_s, "the position was set")
        if x_actual != position or x_target != position:
            raise WriteRefused(rows.x_actual.name, position, x_actual, f"{rows.x_target.name} is {x_target}")
        if back != v_max:
            raise WriteRefused(rows.v_max.name, v_max, back, f"write {rows.v_max.name} again, or axis {axis} stays put")
        return before - position
