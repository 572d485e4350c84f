"""Velocities one after another, each at once: HOLD_MODE, where v_actual is the user's (DS-TMC428 8.6, 8.12)."""

from __future__ import annotations

from collections.abc import Sequence

from ...calc.units.tmc428 import MAX_VELOCITY, pulse_rate_hz
from ...errors import WriteRefused, WrongState
from ...links.queue import Priority
from ..core.capabilities import VelocitySteps, VelocityStream
from ..core.events import MotionStarted
from ..core.register_io import RegisterIO
from ..core.register_link import RegisterLink
from .axis_roles import HOLD_MODE
from .memory import RampMemory
from .prediction import TickedBook


class RampStream(VelocityStream):
    """Opens streams to the axes of a ramp generator chip. `books` are the predictions by axis."""

    def __init__(self, link: RegisterLink, memory: RampMemory, books: Sequence[TickedBook]) -> None:
        self._link = link
        self._session = link.session
        self._memory = memory
        self._books = books

    async def stream_unit_pps(self, axis: int) -> tuple[float, int]:
        rows = self._memory.rows[self._session.axis(axis).index]
        self._session.require_connected()
        async with self._link.turn() as turn:
            io = self._link.io(turn)
            self._memory.saw(rows.dividers, await io.read(rows.dividers))
            position = await io.value(rows.x_actual)
        pulse_div = self._session.axes[axis].pulse_div
        assert pulse_div is not None  # it was seen just now
        return pulse_rate_hz(1, pulse_div, self._session.clock_hz), position

    async def open_stream(self, axis: int) -> VelocitySteps:
        rows = self._memory.rows[self._session.axis(axis).index]
        self._session.require_connected()
        guard = self._session.stop_guard([axis])
        async with self._session.queue.turn(Priority.COMMAND, guard) as turn:
            io = RegisterIO(turn)
            ramp = await self._memory.read_ramp(io, axis)
            if await io.value(rows.v_actual) != 0:
                raise WrongState(f"axis {axis} moves", "stop it first")
            position = await io.value(rows.x_actual)
            self._session.commanded(axis, "stream")
            reference = rows.with_mode(ramp.reference, HOLD_MODE)
            await io.write(rows.reference, reference)
            back = await io.read(rows.reference)
            self._memory.saw(rows.reference, back)
            if rows.mode.unpack(back) != HOLD_MODE:
                raise WriteRefused(rows.reference.name, HOLD_MODE, back, f"axis {axis} did not take HOLD_MODE")
            self._books[axis].end(io.time_s, "its velocity comes from elsewhere")
            started_at_s = io.time_s
        self._session.tell(MotionStarted(axis, started_at_s))
        unit_pps = pulse_rate_hz(1, ramp.pulse_div, self._session.clock_hz)
        return _Steps(self._link, self._memory, axis, unit_pps, position)


class _Steps(VelocitySteps):
    """One stream. A stop of the axis ends it: what comes after raises WrongState before it is sent."""

    def __init__(self, link: RegisterLink, memory: RampMemory, axis: int, unit_pps: float, position: int) -> None:
        self.position = position
        self.unit_pps = unit_pps
        self._session = link.session
        self._rows = memory.rows[axis]
        self._guard = self._session.stop_guard([axis])

    async def set(self, counts: int) -> None:
        counts = max(-MAX_VELOCITY, min(MAX_VELOCITY, counts))
        async with self._session.queue.turn(Priority.COMMAND, self._guard) as turn:
            await RegisterIO(turn).put(self._rows.v_actual, counts)

    async def close(self) -> int:
        rows = self._rows
        async with self._session.queue.turn(Priority.COMMAND, self._guard) as turn:
            io = RegisterIO(turn)
            await io.put(rows.v_actual, 0)
            back = await io.value(rows.v_actual)
            position = await io.value(rows.x_actual)
        if back != 0:
            raise WriteRefused(rows.v_actual.name, 0, back, "stop the axis, or cut the power")
        return position
