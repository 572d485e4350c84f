"""Moves, rotation and stops, and what is expected of them. Nothing here is ever sent twice."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass

from ...calc.positions.extended import Counter
from ...calc.ramps.sixpoint import MotionPlan
from ...clock import Clock
from ...errors import BenchError, CannotMove, LinkError, OutOfRange, UsageError, WriteRefused, WrongState
from ...links.port import FramePort
from ...links.tmcl import VALUE_MAX, VALUE_MIN, Request
from ...number_text import plain
from ...registers.model import Register
from ...registers.tmcl.commands import Opcode
from ..core.axis_units import CHIP, SPELLINGS, to_position
from ..core.config import DeviceConfig
from ..core.device import MotionStarted
from ..core.motion_watch import Kind, MotionWatch
from ..core.planned_motion import PlannedMotion
from ..core.prediction import Prediction, PredictionBook
from ..core.results import AxisMove, MotionEnd, MoveStarted, RegisterWritten, Rotating
from ..core.sixpoint_plans import move_plan, turn_plan
from . import rows
from .calls import Calls
from .console import Console
from .frames import spelled, writing
from .prediction import RAMP_WAIT_S, sixpoint
from .refusals import limits

ABS = 0
COUNTER = Counter(32)
START, STOP, STATUS = 0, 1, 2
"""Types of RFS."""
MOVING_LOOK = (rows.ACTUAL_POSITION, rows.ACTUAL_SPEED, rows.LEFT_SWITCH, rows.RIGHT_SWITCH)


@dataclass(slots=True)
class _Before:
    """The axis right before it is sent somewhere."""

    position: int
    speed: int
    left: bool
    right: bool


class Motion(Console):
    """A TMCL module that is sent somewhere."""

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> None:
        super().__init__(device_id, config, port, clock)
        self._book: PredictionBook[PlannedMotion] = PredictionBook()
        self._driven: Kind | None = None
        """What the latest command from here made of the axis; None where that is not known."""
        self._borrowed: int | None = None
        """The maximum acceleration (AP 5) that an immediate stop has raised, until it is written back."""
        self._latched = 0
        """Bits of AP 207 seen since the latest motion began: reading them clears them in the module."""
        self._watch = MotionWatch(0, self._tell_end, self._look_on)

    @property
    def driven(self) -> Kind | None:
        """What drives the axis; None where that is not known."""
        return self._driven

    # --- moves ----------------------------------------------------------------------------------

    async def move_together(self, moves: Sequence[AxisMove]) -> list[MoveStarted]:
        """One move, of the one axis, by MVP ABS.

        A relative move counts from where the axis is, as for every family. MVP REL would count from
        the last target or from the position, by AP 127, and could not be told done from not done
        when its answer is lost.
        """
        if len(moves) != 1:
            raise UsageError(f"a {self.family.title} has one axis, so a move is of one axis")
        move = moves[0]
        axis = self.axis(move.axis).index
        self.require_connected()
        async with self.calls(axis) as calls:
            before, warnings = await self._prepare(calls)
            target = self._target(move, before.position, warnings)
            warnings += self._blocked(COUNTER.way(target, before.position), before)
            if self._known.get(rows.MAX_SPEED.address) == 0:
                raise CannotMove("the motor would not move: maximum_positioning_speed (AP 4) is 0", "write AP 4", axis)
            if self.limiter is not None:
                self.limiter.require_target(axis, COUNTER.shows(target), before.position)
            request = Request(self.address, Opcode.MVP, ABS, axis, target)
            started_s = await self._set_off(calls, request, "position", target)
            try:
                back = await calls.get(rows.TARGET_POSITION)
            except BenchError as error:
                warnings.append(f"it moves, but its target could not be read back: {error}")
                back = target
            prediction = await self._foresee(calls, started_s, before, target=target)
        if back != target:
            raise WriteRefused(rows.TARGET_POSITION.name, target, back, "it may go there: stop it")
        self._tell(MotionStarted(axis, started_s))
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
        wanted = to_position(self.mechanics(move.axis), move.target, move.unit)
        if move.unit == "microsteps" and wanted != move.target:
            warnings.append(f"rounded to {wanted} microsteps")
        target = position + wanted if move.relative else wanted
        if move.over_the_end:
            return target
        if not VALUE_MIN <= target <= VALUE_MAX:
            shown = "" if move.unit == "microsteps" else f"; {plain(move.target)} {move.unit} asked"
            raise OutOfRange("target of axis 0", target, VALUE_MIN, VALUE_MAX, f"microsteps{shown}")
        if abs(target - position) > VALUE_MAX:
            raise OutOfRange(
                "distance of axis 0", target - position, -VALUE_MAX, VALUE_MAX, "microsteps: go in two moves"
            )
        return target

    # --- rotation -------------------------------------------------------------------------------

    async def rotate(self, axis: int, velocity: float, unit: str = "pps") -> Rotating:
        """By ROR, or by ROL for a negative velocity; the maximum acceleration (AP 5) ramps it both ways."""
        axis = self.axis(axis).index
        self.require_connected()
        async with self.calls(axis) as calls:
            before, warnings = await self._prepare(calls)
            speed = self._speed(axis, velocity, unit, warnings)
            warnings += self._blocked(speed, before)
            if self.limiter is not None:
                self.limiter.require_way(axis, speed, before.position)
            request = Request(self.address, Opcode.ROR if speed >= 0 else Opcode.ROL, 0, axis, abs(speed))
            started_s = await self._set_off(calls, request, "velocity", None)
            if speed == 0:
                self._watch.stop_commanded(started_s)
            try:
                back = await calls.get(rows.TARGET_SPEED)
            except BenchError as error:
                warnings.append(f"it turns, but its speed could not be read back: {error}")
                back = speed
            await self._foresee(calls, started_s, before, speed=speed)
        if abs(back - speed) > 2:  # a whole unit of the driver chip is 0.95 pps
            raise WriteRefused(rows.TARGET_SPEED.name, speed, back, "it may turn at another speed: stop it")
        self._tell(MotionStarted(axis, started_s))
        return Rotating(axis, speed, speed * self.speed_unit_pps, warnings)

    def _speed(self, axis: int, velocity: float, unit: str, warnings: list[str]) -> int:
        """A velocity in the module's own unit. Raises OutOfRange with the limits in `unit`."""
        one = self._one_speed(axis, unit)
        limit = limits(rows.TARGET_SPEED, self.unit_mode)[1]
        exact = velocity / one
        if not abs(exact) <= limit * (1 + 1e-9):
            raise OutOfRange("velocity", velocity, -limit * one, limit * one, unit)
        speed = max(-limit, min(limit, round(exact)))
        if speed == 0 and velocity:
            raise OutOfRange("velocity", velocity, one, limit * one, f"{unit}; less than one is a standstill")
        if self.limiter is not None:
            self.limiter.require_velocity(axis, exact * self.speed_unit_pps)
            speed = self.limiter.rounded(axis, speed, self.speed_unit_pps)
        if speed and abs(speed / exact - 1) > 0.01:
            warnings.append(f"rounded to {plain(speed * one, 6)} {unit}")
        return speed

    def _one_speed(self, axis: int, unit: str) -> float:
        """What a speed of 1 is in `unit`. Raises UsageError."""
        if unit == CHIP:
            return 1.0
        spelled_out = SPELLINGS.get(unit, unit)
        try:
            return float(self.mechanics(axis).from_microsteps(self.speed_unit_pps, spelled_out))
        except ValueError as error:
            raise UsageError(str(error)) from error

    # --- what both need -------------------------------------------------------------------------

    async def _prepare(self, calls: Calls) -> tuple[_Before, list[str]]:
        """Look before it goes out, and refuse what cannot go well. Only a borrowed acceleration is written."""
        missing = [row for row in rows.REMEMBERED if row.address not in self._known]
        await calls.ask_many((*rows.ALWAYS_FRESH, rows.STEP_DIRECTION, *missing))
        calls.unit_mode = self.unit_mode
        if self._known.get(rows.STEP_DIRECTION.address):
            raise WrongState(
                "the module follows its step/direction inputs, and no command moves it",
                "write step_direction_mode (AP 254) 0 first",
            )
        if self._borrowed is not None:
            await self._give_back_acceleration(calls)
        position, speed, left, right = await calls.ask_many(MOVING_LOOK)
        warnings = []
        if self._known.get(rows.OFF_TIME.address) == 0:
            warnings.append("chopper_off_time (AP 167) is 0: the driver is off and the motor will not turn")
        here, now = calls.need(rows.ACTUAL_POSITION, position), calls.need(rows.ACTUAL_SPEED, speed)
        return _Before(here, now, bool(left), bool(right)), warnings

    def _blocked(self, way: float, before: _Before) -> list[str]:
        """What a switch has against motion that way."""
        for side, active, row, sign in (
            ("left", before.left, rows.LEFT_DISABLED, -1),
            ("right", before.right, rows.RIGHT_DISABLED, 1),
        ):
            if active and way * sign > 0 and not self._known.get(row.address):
                return [f"the {side} switch is active and stops motion that way"]
        return []

    async def _set_off(self, calls: Calls, request: Request, kind: Kind, target: int | None) -> float:
        """Send the command that moves the motor, once. Returns when it was obeyed, device time [s]."""
        what = spelled(request)
        self._allow(request)
        asked = {"target": target} if target is not None else {}
        if kind == "velocity":
            asked = {"velocity": -request.value if request.opcode == Opcode.ROL else request.value}
        self.commanded(request.motor, what, **asked)
        sent_s = self.device_time_s()
        try:
            await calls.move(request, what)
        except LinkError as error:
            self._motion_uncertain(str(error))
            raise
        started_s = calls.time_s if self.chip_timed else (sent_s + calls.time_s) / 2
        self._drives(kind, started_s, target)
        return started_s

    def _drives(self, kind: Kind, started_s: float, target: int | None) -> None:
        """The axis follows `kind` from now on."""
        self._driven = kind
        self._watch.wait_s = self._known.get(rows.RAMP_WAIT.address, 0) * RAMP_WAIT_S
        self._watch.began(kind, started_s, target)

    async def _foresee(
        self, calls: Calls, started_s: float, before: _Before, target: int | None = None, speed: int = 0
    ) -> Prediction | None:
        """Begin the prediction of a motion that has begun; None where the parameters make none."""
        if before.speed == 0:
            position, v_pps = before.position, 0.0  # from rest the start is known exactly
        else:
            try:
                position, v = await calls.get_many((rows.ACTUAL_POSITION, rows.ACTUAL_SPEED))
            except BenchError:
                self._book.end(started_s, "another command")
                return None
            started_s, v_pps = calls.time_s, v * self.speed_unit_pps
        return self._expect(started_s, position, v_pps, target, speed)

    def _expect(
        self, started_s: float, position: int, v_pps: float, target: int | None, speed: int
    ) -> Prediction | None:
        """A motion from `position` at `v_pps` to a target, or to a speed where there is none."""
        plan: MotionPlan | None
        ramp = sixpoint(self._known, self.speed_unit_pps, self.acceleration_unit_pps2)
        if target is None:
            plan = turn_plan(ramp, speed * self.speed_unit_pps, v_pps)
        else:
            plan = move_plan(ramp, COUNTER.way(target, position), v_pps)
        if plan is None:
            self._book.end(started_s, "another command")
            return None
        return self._book.add(PlannedMotion(0, started_s, position, plan))

    def prediction(self, axis: int) -> Prediction | None:
        self.axis(axis)
        return self._book.present()

    # --- by a parameter, or by hand -------------------------------------------------------------

    async def _write_moving(self, register: Register, value: int) -> RegisterWritten:
        what = f"writing {register.name}"
        async with self.calls(register.axis) as calls:
            old = await self._old(calls, register)
            self._allow(writing(self.address, register, value))
            self.commanded(0, register.name)
            try:
                await calls.move(writing(self.address, register, value), what, register)
            except LinkError as error:
                self._motion_uncertain(str(error))
                self._wrote(register, old, value, error)
                raise
            self._drives(*self._kind_of_write(register, value, calls.time_s))
            try:
                back = await calls.get(register)
                written = self._written(register, value, back, *self._judge(register, value, back))
            except BenchError as error:
                self._wrote(register, old, value, error)
                raise
            self._wrote(register, old, value, written)
            await self._look_after(calls)
        return written

    def _kind_of_write(self, register: Register, value: int, time_s: float) -> tuple[Kind, float, int | None]:
        if register is rows.TARGET_POSITION:
            return "position", time_s, value
        if register is rows.TARGET_SPEED:
            return "velocity", time_s, None
        return self._driven or "unknown", time_s, None

    async def _moved_by_hand(self, request: Request) -> None:
        async with self.calls() as calls:
            match request.opcode:
                case Opcode.MVP:
                    self._drives("position", calls.time_s, None)
                case Opcode.ROR | Opcode.ROL:
                    self._drives("velocity", calls.time_s, None)
                case Opcode.MST:
                    self._driven = "velocity"
                    self._watch.stop_commanded(calls.time_s)
                case Opcode.RFS:
                    self._drives("search" if request.type == START else "velocity", calls.time_s, None)
                case Opcode.SAP if (register := self.table.at(request.type, rows.ACTUAL_SPEED.space)) is not None:
                    self._drives(*self._kind_of_write(register, request.value, calls.time_s))
                case _:
                    self._driven = None
                    self._watch.began("unknown", calls.time_s)
            with contextlib.suppress(BenchError):  # the command itself is done: what fails now is not its failure
                await self._look_after(calls)

    def _moves(self) -> bool:
        return self._watch.under_way is not None

    async def _look_after(self, calls: Calls) -> None:
        """After a command that was not one of ours: what does the axis do now, and what is to be expected?"""
        position, speed, target, target_speed = await calls.ask_many(
            (rows.ACTUAL_POSITION, rows.ACTUAL_SPEED, rows.TARGET_POSITION, rows.TARGET_SPEED)
        )
        if position is None or speed is None:
            self._book.end(calls.time_s, "another command")
            return
        v_pps = speed * self.speed_unit_pps
        if self._driven == "position" and target is not None and target != position:
            self._expect(calls.time_s, position, v_pps, target, 0)
        elif self._driven == "velocity" and target_speed is not None and (target_speed or speed):
            self._expect(calls.time_s, position, v_pps, None, target_speed)
        else:
            self._book.end(calls.time_s, "another command")

    def _motion_uncertain(self, why: str) -> None:
        now_s = self.device_time_s()
        self._driven = None
        self._book.end(now_s, why)
        self._watch.began("unknown", now_s)

    async def _after_write(self, register: Register) -> None:
        if register is rows.MAX_ACCELERATION:
            self._borrowed = None  # somebody wants it so now
        if register in (*rows.RAMP, rows.RAMP_WAIT):
            self._book.end(self.port.last_exchange_s, f"{register.name} was written")

    async def _give_back_acceleration(self, calls: Calls) -> None:
        """The acceleration that an immediate stop has raised, as it was."""
        borrowed = self._borrowed
        if borrowed is None:
            return
        await calls.put(rows.MAX_ACCELERATION, borrowed)
        back = await calls.get(rows.MAX_ACCELERATION)
        self._judge(rows.MAX_ACCELERATION, borrowed, back)
        self._borrowed = None

    # --- ends -----------------------------------------------------------------------------------

    def commanded(self, axis: int, what: str, **asked: int | str) -> None:
        super().commanded(axis, what, **asked)
        self._latched = 0  # the next motion clears the module's own flags too

    def motion_ends(self, axis: int) -> tuple[MotionEnd, ...]:
        self.axis(axis)
        return self._watch.ends

    def _tell_end(self, end: MotionEnd) -> None:
        present = self._book.present()
        if present is not None and (end.reason != "target_reached" or not present.ends):
            self._book.end(end.time_s, end.detail)
        self._tell(end)

    def _look_on(self) -> None:
        """Have looks come until the motion under way has ended."""
        raise NotImplementedError
