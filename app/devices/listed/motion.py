"""Moves, rotation and stops by MVP, ROR, ROL and MST. Nothing here is ever sent twice.

Positions are the module's counts. What its speeds count in the package does not tell: they are sent as numbers, and a
warning says so. TMCL has one stop, which both modes of a stop are.
"""

from __future__ import annotations

from collections.abc import Sequence

from ...errors import BenchError, CannotMove, LinkError, OutOfRange, UsageError, WriteRefused
from ...links.queue import Priority
from ...links.tmcl import VALUE_MAX, VALUE_MIN, Request
from ...registers.tmcl.commands import Opcode
from ..core.axis_units import CHIP, to_position
from ..core.capabilities import Motion
from ..core.events import MotionStarted
from ..core.motion_watch import Kind
from ..core.prediction import Prediction
from ..core.results import AxisMove, MoveStarted, Rotating, StopMode, StopOutcome
from ..core.session import Session
from ..core.start_gate import ready_to_start
from ..core.stop_each import stop_each
from ..core.tmcl_calls import Calls
from ..core.tmcl_link import TmclLink
from .ongoing import ListedMotions
from .state import COUNTER_BITS, ListedState

ABS = 0
PPS = "pps"
OWN_UNIT = "sent as a number: nobody here knows what the speeds of this module count in"


class ListedMotion(Motion):
    """Of every axis, by TMCL's standard commands."""

    def __init__(self, session: Session, state: ListedState, link: TmclLink, motions: ListedMotions) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._motions = motions

    # --- moves ----------------------------------------------------------------------------------

    async def move_together(self, moves: Sequence[AxisMove]) -> list[MoveStarted]:
        """MVP ABS of each axis, one right after the other: TMCL starts no two at once on every module."""
        for move in moves:
            self._session.axis(move.axis)
        if len({move.axis for move in moves}) != len(moves):
            raise UsageError("an axis is named twice")
        self._session.require_connected()
        return [await self._move(move) for move in moves]

    async def _move(self, move: AxisMove) -> MoveStarted:
        session, rows, warnings = self._session, self._state.axes[move.axis], list[str]()
        async with self._link.calls(move.axis) as calls:
            told = await calls.ask_many((rows.position, rows.max_speed, rows.max_acceleration))
            position = calls.need(rows.position, told[0])
            target = self._target(move, position, warnings)
            for row, value in ((rows.max_speed, told[1]), (rows.max_acceleration, told[2])):
                if value == 0 and target != position:
                    raise CannotMove(f"the axis would not move: {row.name} is 0", f"write {row.name}", move.axis)
            if session.limiter is not None:
                session.limiter.require_target(move.axis, target, position)
            await ready_to_start()
            request = Request(self._link.address, Opcode.MVP, ABS, move.axis, target)
            started_s = await self._set_off(calls, request, move.axis, "position", target)
            try:
                back = await calls.get(rows.target_position)
            except BenchError as error:
                warnings.append(f"it moves, but its target could not be read back: {error}")
                back = target
        if back != target:
            raise WriteRefused(rows.target_position.name, target, back, "it may go there: stop it")
        session.tell(MotionStarted(move.axis, started_s))
        return MoveStarted(move.axis, position, target, started_s, None, warnings)

    def _target(self, move: AxisMove, position: int, warnings: list[str]) -> int:
        wanted = to_position(self._state.mechanics(move.axis), move.target, move.unit)
        if move.unit != "microsteps":
            warnings.append(
                f"{move.unit} are reckoned with 256 counts a full step: nobody here knows how many there are"
            )
        elif wanted != move.target:
            warnings.append(f"rounded to {wanted} microsteps")
        target = position + wanted if move.relative else wanted
        if move.over_the_end:
            half = 1 << COUNTER_BITS - 1
            return (target + half) % (2 * half) - half
        if not VALUE_MIN <= target <= VALUE_MAX:
            raise OutOfRange(f"target of axis {move.axis}", target, VALUE_MIN, VALUE_MAX, "microsteps")
        if abs(target - position) > VALUE_MAX:
            most = VALUE_MAX
            raise OutOfRange(
                f"distance of axis {move.axis}", target - position, -most, most, "microsteps: go in two moves"
            )
        return target

    # --- rotation -------------------------------------------------------------------------------

    async def rotate(self, axis: int, velocity: float, unit: str = PPS) -> Rotating:
        """By ROR, or by ROL for a negative velocity."""
        session, rows = self._session, self._state.axes[self._session.axis(axis).index]
        if unit not in (CHIP, PPS):
            raise UsageError(f"{unit} is no unit of this module's speeds, {OWN_UNIT}; say {CHIP}")
        if not -VALUE_MAX <= velocity <= VALUE_MAX:
            raise OutOfRange("velocity", velocity, -VALUE_MAX, VALUE_MAX, OWN_UNIT)
        speed = round(velocity)
        if speed == 0 and velocity:
            raise OutOfRange("velocity", velocity, 1, VALUE_MAX, "less than one is a standstill")
        warnings = [OWN_UNIT] if unit == PPS else []
        session.require_connected()
        async with self._link.calls(axis) as calls:
            position, acceleration = await calls.ask_many((rows.position, rows.max_acceleration))
            if acceleration == 0 and speed:
                name = rows.max_acceleration.name
                raise CannotMove(f"the axis would not move: {name} is 0", f"write {name}", axis)
            if session.limiter is not None:
                session.limiter.require_velocity(axis, speed)
                session.limiter.require_way(axis, speed, position)
            request = Request(self._link.address, Opcode.ROR if speed >= 0 else Opcode.ROL, 0, axis, abs(speed))
            started_s = await self._set_off(calls, request, axis, "velocity", None)
            if speed == 0:
                self._motions.axes[axis].watch.stop_commanded(started_s)
            try:
                back = await calls.get(rows.target_speed)
            except BenchError as error:
                warnings.append(f"it turns, but its speed could not be read back: {error}")
                back = speed
        if back != speed:
            raise WriteRefused(rows.target_speed.name, speed, back, "it may turn at another speed: stop it")
        session.tell(MotionStarted(axis, started_s))
        return Rotating(axis, speed, float(speed), warnings)

    async def _set_off(self, calls: Calls, request: Request, axis: int, kind: Kind, target: int | None) -> float:
        """Send a command that moves the axis, once; when it was answered, device time [s]."""
        self._link.check_limits(request)
        asked = {"target": target} if target is not None else {"velocity": request.value}
        if request.opcode == Opcode.ROL:
            asked = {"velocity": -request.value}
        self._session.commanded(axis, "move" if kind == "position" else "rotate", **asked)
        try:
            await calls.move(request, Opcode(request.opcode).name)
        except LinkError:
            self._motions.mark_unknown(axis)
            raise
        self._motions.axes[axis].drives(kind, calls.time_s, target)
        return calls.time_s

    # --- stops ----------------------------------------------------------------------------------

    async def stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        """Ahead of everything that waits for this link. One that failed is reported and not sent again by itself."""

        async def stop(axis: int) -> BenchError | None:
            async with self._link.calls(priority=Priority.STOP) as calls:
                return await self._stop(calls, axis)

        return await stop_each(self._session, axes, mode, stop)

    async def _stop(self, calls: Calls, axis: int) -> BenchError | None:
        target_speed = self._state.axes[axis].target_speed
        try:
            await calls.do(Request(self._link.address, Opcode.MST, 0, axis))
        except BenchError as error:
            self._motions.mark_unknown(axis)
            return error
        self._motions.axes[axis].stop_commanded(calls.time_s)
        try:
            (held,) = await calls.ask_many((target_speed,))
        except BenchError as error:
            return error
        if held:
            return WriteRefused(target_speed.name, 0, held, "stop again, or cut the power")
        return None

    # --- the rest -------------------------------------------------------------------------------

    def speed_limit_pps(self, axis: int) -> float:
        self._session.axis(axis)
        return float(VALUE_MAX)

    def prediction(self, axis: int) -> Prediction | None:
        """None: what its numbers count in is not known."""
        self._session.axis(axis)
        return None
