"""Moves and rotation, and what is expected of them. Nothing here is ever sent twice."""

from __future__ import annotations

from collections.abc import Sequence

from ...errors import BenchError, CannotMove, OutOfRange, UsageError, WriteRefused
from ...links.tmcl import Request
from ...number_text import plain
from ...registers.tmcl.commands import Opcode
from ..core.axis_units import CHIP, SPELLINGS, to_position
from ..core.capabilities import Motion
from ..core.events import MotionStarted
from ..core.prediction import Prediction
from ..core.results import AxisMove, MoveStarted, Rotating, StopMode, StopOutcome
from ..core.session import Session
from ..core.start_gate import ready_to_start
from ..core.tmcl_link import TmclLink
from ..core.tmcl_refusals import limits
from .arrivals import Arrivals
from .departure import Departure
from .ongoing import OngoingMotion
from .state import ModuleState
from .stops import Stops

ABS = 0


class ModuleMotion(Motion):
    """Positions are the module's microsteps (AP 140 of them a full step); its one axis is number 0."""

    def __init__(
        self,
        session: Session,
        state: ModuleState,
        link: TmclLink,
        ongoing: OngoingMotion,
        departure: Departure,
        stops: Stops,
        arrivals: Arrivals,
    ) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._ongoing = ongoing
        self._departure = departure
        self._stops = stops
        self._arrivals = arrivals

    # --- moves ----------------------------------------------------------------------------------

    async def move_together(self, moves: Sequence[AxisMove]) -> list[MoveStarted]:
        """One move, of the one axis, by MVP ABS.

        A relative move counts from where the axis is, as for every family. MVP REL would count from
        the last target or from the position, by AP 127, and could not be told done from not done
        when its answer is lost.
        """
        session, state, roles = self._session, self._state, self._state.roles
        if len(moves) != 1:
            raise UsageError(f"a {session.family.title} has one axis, so a move is of one axis")
        move = moves[0]
        axis = session.axis(move.axis).index
        session.require_connected()
        async with self._link.calls(axis) as calls:
            before, warnings = await self._departure.prepare(calls)
            target = self._target(move, before.position, warnings)
            warnings += self._departure.blocked(state.wrap.way(target, before.position), before)
            if state.last(roles.max_speed) == 0:
                raise CannotMove("the motor would not move: maximum_positioning_speed (AP 4) is 0", "write AP 4", axis)
            if session.limiter is not None:
                session.limiter.require_target(axis, state.wrap.shows(target), before.position)
            await ready_to_start()
            await self._arrivals.ask_for(calls)
            request = Request(self._link.address, Opcode.MVP, ABS, axis, target)
            started_s = await self._departure.set_off(calls, request, "position", target)
            try:
                back = await calls.get(roles.target_position)
            except BenchError as error:
                warnings.append(f"it moves, but its target could not be read back: {error}")
                back = target
            prediction = await self._ongoing.predict(
                calls, started_s, before.position, before.speed == 0, target=target
            )
        if back != target:
            raise WriteRefused(roles.target_position.name, target, back, "it may go there: stop it")
        session.tell(MotionStarted(axis, started_s))
        return [
            MoveStarted(
                axis,
                before.position,
                target,
                started_s,
                prediction.duration_s if prediction is not None and prediction.ends else None,
                warnings,
            )
        ]

    def _target(self, move: AxisMove, position: int, warnings: list[str]) -> int:
        wanted = to_position(self._state.mechanics(move.axis), move.target, move.unit)
        if move.unit == "microsteps" and wanted != move.target:
            warnings.append(f"rounded to {wanted} microsteps")
        target = position + wanted if move.relative else wanted
        if move.over_the_end:
            return target
        most = self._state.wrap.half - 1
        if not -most - 1 <= target <= most:
            shown = "" if move.unit == "microsteps" else f"; {plain(move.target)} {move.unit} asked"
            raise OutOfRange("target of axis 0", target, -most - 1, most, f"microsteps{shown}")
        if abs(target - position) > most:
            raise OutOfRange("distance of axis 0", target - position, -most, most, "microsteps: go in two moves")
        return target

    # --- rotation -------------------------------------------------------------------------------

    async def rotate(self, axis: int, velocity: float, unit: str = "pps") -> Rotating:
        """By ROR, or by ROL for a negative velocity; the maximum acceleration (AP 5) ramps it both ways."""
        session, roles = self._session, self._state.roles
        axis = session.axis(axis).index
        session.require_connected()
        async with self._link.calls(axis) as calls:
            before, warnings = await self._departure.prepare(calls)
            speed = self._speed(axis, velocity, unit, warnings)
            warnings += self._departure.blocked(speed, before)
            if session.limiter is not None:
                session.limiter.require_way(axis, speed, before.position)
            request = Request(self._link.address, Opcode.ROR if speed >= 0 else Opcode.ROL, 0, axis, abs(speed))
            started_s = await self._departure.set_off(calls, request, "velocity", None)
            if speed == 0:
                self._ongoing.watch.stop_commanded(started_s)
            try:
                back = await calls.get(roles.target_speed)
            except BenchError as error:
                warnings.append(f"it turns, but its speed could not be read back: {error}")
                back = speed
            await self._ongoing.predict(calls, started_s, before.position, before.speed == 0, speed=speed)
        if abs(back - speed) > 2:  # a whole unit of the driver chip is 0.95 pps
            raise WriteRefused(roles.target_speed.name, speed, back, "it may turn at another speed: stop it")
        session.tell(MotionStarted(axis, started_s))
        return Rotating(axis, speed, speed * self._state.speed_unit_pps, warnings)

    def _speed(self, axis: int, velocity: float, unit: str, warnings: list[str]) -> int:
        """A velocity in the module's own unit. Raises OutOfRange with the limits in `unit`."""
        state, limiter = self._state, self._session.limiter
        one = self._one_speed(axis, unit)
        limit = limits(state.roles.target_speed, state.unit_mode)[1]
        exact = velocity / one
        if not abs(exact) <= limit * (1 + 1e-9):
            raise OutOfRange("velocity", velocity, -limit * one, limit * one, unit)
        speed = max(-limit, min(limit, round(exact)))
        if speed == 0 and velocity:
            raise OutOfRange("velocity", velocity, one, limit * one, f"{unit}; less than one is a standstill")
        if limiter is not None:
            limiter.require_velocity(axis, exact * state.speed_unit_pps)
            speed = limiter.rounded(axis, speed, state.speed_unit_pps)
        if speed and abs(speed / exact - 1) > 0.01:
            warnings.append(f"rounded to {plain(speed * one, 6)} {unit}")
        return speed

    def _one_speed(self, axis: int, unit: str) -> float:
        """What a speed of 1 is in `unit`. Raises UsageError."""
        if unit == CHIP:
            return 1.0
        spelled_out = SPELLINGS.get(unit, unit)
        try:
            return float(self._state.mechanics(axis).from_microsteps(self._state.speed_unit_pps, spelled_out))
        except ValueError as error:
            raise UsageError(str(error)) from error

    # --- the rest -------------------------------------------------------------------------------

    async def stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        return await self._stops.stop_axes(axes, mode)

    def speed_limit_pps(self, axis: int) -> float:
        self._session.axis(axis)
        # Of the ramp generator, whatever the module counts in.
        return self._state.scaling.speed_limit_pps(self._session.clock_hz)

    def prediction(self, axis: int) -> Prediction | None:
        self._session.axis(axis)
        return self._ongoing.book.present()
