"""Turning at VACTUAL, and stopping it. Nothing that sets off is ever sent twice; a stop is, where it may not have come.

The velocity jumps: a driver has no ramp. Its steps from outside it follows whatever is written here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...errors import BadReply, BenchError, CannotMove, LinkDown, OutOfRange, WrongState
from ...links.queue import Priority
from ...number_text import plain
from ...registers.model import Register, to_raw
from ..core.axis_units import velocity_unit_in
from ..core.capabilities import Motion
from ..core.events import MotionStarted
from ..core.prediction import Prediction
from ..core.register_io import RegisterIO, Write
from ..core.register_link import RegisterLink
from ..core.results import AxisMove, MoveStarted, Rotating, StopMode, StopOutcome
from ..core.session import Session
from ..core.stop_each import stop_each
from .memory import DriverMemory
from .reader import Reader
from .roles import part

STEPPED = "it is stepped from outside (STEP), which no register ends"
HOW_TO_STOP = "stop what gives the steps, or switch the bridges off: CHOPCONF.toff 0"


@dataclass(frozen=True, slots=True)
class DriverMotion(Motion):
    """Turns the motor at a velocity, where the driver can; moves it nowhere."""

    session: Session
    link: RegisterLink
    memory: DriverMemory
    reader: Reader

    async def move_together(self, moves: Sequence[AxisMove]) -> list[MoveStarted]:
        title = self.session.family.title
        turns = "; it can rotate" if self.memory.rows.vactual is not None else ""
        raise WrongState(
            f"a {title} counts no position and has no ramp, so it cannot be sent anywhere",
            f"move it by whatever steps it{turns}",
        )

    async def rotate(self, axis: int, velocity: float, unit: str = "pps") -> Rotating:
        axis = self.session.axis(axis).index
        row = self._velocity_row()
        self.session.require_connected()
        async with self.link.command(axis) as turn:
            io = self.link.io(turn)
            await self.reader.read(io, (*self.memory.rows.remembered, self.memory.rows.inputs))
            chopconf = self.memory.word(self.memory.rows.chopconf)
            if chopconf is not None and not part(self.memory.rows.chopconf, "toff").unpack(chopconf):
                raise CannotMove("the driver is off: CHOPCONF.toff is 0", "start it up, or write toff", axis)
            speed, warnings = self._speed(row, velocity, unit)
            unit_pps = self.memory.velocity_unit_pps
            write = Write(row, to_raw(speed, row.width))
            self.link.allow((write,))
            self.session.commanded(axis, "rotate", velocity=speed)
            self.memory.sent(row, write.word)
            if not await io.write(row, write.word):
                raise BadReply(self.session.port.name, "the velocity may have arrived otherwise: stop the axis", b"")
            started_s = io.time_s
        self.session.tell(MotionStarted(axis, started_s))
        if speed:
            warnings.append("the velocity jumps: a driver has no ramp, and a motor loses steps where it cannot follow")
        return Rotating(axis, speed, speed * unit_pps, warnings)

    def _velocity_row(self) -> Register:
        row = self.memory.rows.vactual
        if row is None:
            raise WrongState(
                f"a {self.session.family.title} has no velocity of its own", "turn it by whatever steps it"
            )
        return row

    def _speed(self, row: Register, velocity: float, unit: str) -> tuple[int, list[str]]:
        """VACTUAL with its sign, and what to say of it. Raises OutOfRange with the limits in `unit`, SoftLimit."""
        unit_pps = self.memory.velocity_unit_pps
        one = velocity_unit_in(unit, self.memory.mechanics, unit_pps)
        exact, limit = velocity / one, row.maximum * one
        # Rounded up by a hair: a limit has to fit although a client sent it with fewer digits.
        if not abs(exact) <= row.maximum * (1 + 1e-6):
            raise OutOfRange("velocity", velocity, -limit, limit, f"{unit}; {row.maximum} is the chip's limit")
        speed = max(-row.maximum, min(row.maximum, round(exact)))
        if speed == 0 and velocity:
            raise OutOfRange("velocity", velocity, one, limit, f"{unit}; less than one chip unit is a standstill")
        limiter = self.session.limiter
        if limiter is not None:
            limiter.require_velocity(0, exact * unit_pps)
            speed = limiter.rounded(0, speed, unit_pps)
        if speed and abs(speed / exact - 1) > 0.01:
            return speed, [f"rounded to {speed} chip units, {plain(speed * one, 6)} {unit}"]
        return speed, []

    # --- stops ----------------------------------------------------------------------------------

    async def stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        """Write VACTUAL 0; "ramp" and "immediate" are one, for there is no ramp."""

        async def stop(axis: int) -> BenchError | None:
            del axis  # there is one
            async with self.session.queue.turn(Priority.STOP) as turn:
                return await self._stop(self.link.io(turn))

        return await stop_each(self.session, axes, mode, stop)

    async def _stop(self, io: RegisterIO) -> BenchError | None:
        problem: BenchError | None = None
        for _ in (1, 2):  # a stop moves nothing, so it may be sent again
            try:
                problem = await self._send_stop(io)
            except LinkDown as error:
                return error
            except BenchError as error:
                problem = error
            if problem is None or isinstance(problem, WrongState):
                return problem
        return problem

    async def _send_stop(self, io: RegisterIO) -> BenchError | None:
        row = self.memory.rows.vactual
        stood = self.memory.velocity == 0
        if row is not None:
            self.memory.sent(row, 0)
            if not await io.write(row, 0):
                return BadReply(self.session.port.name, "the stop may have arrived otherwise", b"")
        if stood:  # then what it does now nothing here has told it
            reading = await self.reader.read(io, (self.memory.rows.tstep, self.memory.rows.inputs))
            if self.reader.speed_pps(reading.held):
                return WrongState(STEPPED, HOW_TO_STOP)
        return None

    def speed_limit_pps(self, axis: int) -> float:
        self.session.axis(axis)
        return (1 << 23) * self.memory.velocity_unit_pps

    def prediction(self, axis: int) -> Prediction | None:
        self.session.axis(axis)
        return None
